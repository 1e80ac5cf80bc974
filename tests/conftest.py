"""What all tests share: they test the package that is installed, and say which one that is."""

import os
from pathlib import Path

import vehicledyn

os.environ["PYTHONSAFEPATH"] = "1"  # programs started by tests import the installed package too
os.environ["MPLBACKEND"] = "agg"


def pytest_report_header():
    return f"vehicledyn: {vehicledyn.__version__} in {Path(vehicledyn.__file__).parent}"
