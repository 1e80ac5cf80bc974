"""What all tests share: they test the package that is installed, and say which one that is."""

import os
import signal
import tempfile
from pathlib import Path

import pytest

import vehicledyn
from vehicledyn.codegen.toolchain.compiler import CompilationError, find_compiler

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # Whoever starts the tests in the background has them ignore Ctrl-C, which some are about.
    signal.signal(signal.SIGINT, signal.default_int_handler)


if "VEHICLEDYN_CACHE" not in os.environ:
    # Kernels stay out of the user's cache; processes that run tests side by side share them.
    _kernels = tempfile.TemporaryDirectory(prefix="vehicledyn-tests-")
    os.environ["VEHICLEDYN_CACHE"] = _kernels.name

os.environ["PYTHONSAFEPATH"] = "1"  # programs started by tests import the installed package too
os.environ["MPLBACKEND"] = "agg"


STRATA = ("pages", "validation", "regression", "hostile")
"""Folders whose tests are all long: plain 'pytest' leaves them out, '.ci/run' runs them."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    folder = Path(__file__).parent
    for item in items:
        if item.path.relative_to(folder).parts[0] in STRATA:
            item.add_marker("long")
        known = item._fixtureinfo.name2fixturedefs.values()
        own = item.get_closest_marker("xdist_group") is None
        if own and any(found.scope == "module" for fixtures in known for found in fixtures):
            # What the tests of a module share is made once, in one process.
            item.add_marker(pytest.mark.xdist_group(str(item.path)))


def pytest_report_header():
    return f"vehicledyn: {vehicledyn.__version__} in {Path(vehicledyn.__file__).parent}"


@pytest.fixture(scope="session")
def needs_compiler():
    try:
        find_compiler()
    except CompilationError as error:
        pytest.skip(str(error))
