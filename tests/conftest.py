"""What all tests share: they test the package that is installed, and say which one that is."""

import os
import signal
from pathlib import Path

import pytest

import vehicledyn

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # Whoever starts the tests in the background has them ignore Ctrl-C, which some are about.
    signal.signal(signal.SIGINT, signal.default_int_handler)


os.environ["PYTHONSAFEPATH"] = "1"  # programs started by tests import the installed package too
os.environ["MPLBACKEND"] = "agg"


STRATA = ("validation", "regression", "hostile")
"""Folders whose tests are all long: plain 'pytest' leaves them out, '.ci/run' runs them."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    folder = Path(__file__).parent
    for item in items:
        if item.path.relative_to(folder).parts[0] in STRATA:
            item.add_marker("long")


def pytest_report_header():
    return f"vehicledyn: {vehicledyn.__version__} in {Path(vehicledyn.__file__).parent}"
