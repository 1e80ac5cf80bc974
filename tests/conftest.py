"""What all tests share: they test the package that is installed, and say which one that is."""

import functools
import gc
import os
import re
import signal
import tempfile
from pathlib import Path

import pytest

import vehicledyn
from vehicledyn.base.errors import MissingPartError
from vehicledyn.codegen.toolchain.compiler import CompilationError, find_compiler

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # Whoever starts the tests in the background has them ignore Ctrl-C, which some are about.
    signal.signal(signal.SIGINT, signal.default_int_handler)


if "VEHICLEDYN_CACHE" not in os.environ:
    # Kernels stay out of the user's cache; processes that run tests side by side share them.
    _kernels = tempfile.TemporaryDirectory(prefix="vehicledyn-tests-")
    os.environ["VEHICLEDYN_CACHE"] = _kernels.name

if "VEHICLEDYN_TEST_SERVERS" not in os.environ:
    # The same holds for the process that runs the program for tests, see programs.
    _servers = tempfile.TemporaryDirectory(prefix="vehicledyn-servers-")
    os.environ["VEHICLEDYN_TEST_SERVERS"] = _servers.name
    os.environ["VEHICLEDYN_TEST_OWNER"] = str(os.getpid())

gc.disable()  # until all tests are collected: modules are no garbage

os.environ["PYTHONSAFEPATH"] = "1"  # programs started by tests import the installed package too
os.environ["MPLBACKEND"] = "agg"
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")  # tests run side by side


STRATA = ("pages", "validation", "regression", "hostile")
"""Folders whose tests are all long: plain 'pytest' leaves them out, '.ci/run' runs them."""


def pytest_ignore_collect(collection_path, config):
    """Import no module, unless it is named, none of whose tests '-m' would leave."""
    if collection_path.suffix != ".py" or str(collection_path) in _named(config):
        return None
    wanted, path = config.option.markexpr, collection_path.relative_to(Path(__file__).parent)
    if path.parts[0] in STRATA:
        return wanted == "not long" or None
    return (wanted == "long" and not marks_long(collection_path)) or None


@functools.cache
def marks_long(path):
    """Return whether a module's text marks tests as long."""
    return "mark.long" in path.read_text("utf-8")


def _named(config):
    return {str(config.invocation_params.dir / word.partition("::")[0]) for word in config.args}


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    folder = Path(__file__).parent
    for item in items:
        if item.path.relative_to(folder).parts[0] in STRATA:
            item.add_marker("long")
        elif item.get_closest_marker("long") and not marks_long(item.path):
            raise pytest.UsageError(f"{item.nodeid}: 'mark.long' must stand in its module")


def pytest_collection_finish():
    """Search no longer for garbage among modules and tests, and seldom among what tests make."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)  # as the program does
    gc.enable()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Run in one process what shares something that takes long to make.

    Most modules of brief tests derive some systems for all of theirs; long tests go one by one.
    """
    from xdist.scheduler import LoadScopeScheduling

    brief = config.option.markexpr == "not long"

    class Scheduling(LoadScopeScheduling):
        def _split_scope(self, nodeid):
            path = nodeid.partition("::")[0]
            return shared_in(config.rootpath / path) or (path if brief else nodeid)

    return Scheduling(config, log)


@functools.cache
def shared_in(path):
    """Return a name for what the tests of a module share, empty if that is nothing."""
    source = path.read_text(encoding="utf-8") if path.is_file() else ""
    group = re.search(r'xdist_group\("(\w+)"\)', source)
    if group:
        return group[1]
    return str(path) if re.search(_SHARES, source, re.MULTILINE) else ""


_SHARES = r'scope="module"|^@(functools\.)?(lru_)?cache\b'


def pytest_report_header():
    return f"vehicledyn: {vehicledyn.__version__} in {Path(vehicledyn.__file__).parent}"


@functools.cache
def no_compiler():
    """Return why nothing can be compiled here, empty where it can."""
    try:
        find_compiler()
    except CompilationError as error:
        return str(error)
    return ""


@pytest.fixture(scope="session")
def needs_compiler():
    if no_compiler():
        pytest.skip(no_compiler())


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item):
    """Skip, where nothing can be compiled, what stops because it has to be."""
    try:
        return (yield)
    except MissingPartError as error:
        if no_compiler() and no_compiler() in str(error):
            pytest.skip(str(error))
        raise
