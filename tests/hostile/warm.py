"""Imports and fills, once, whatever every start of the program would, before children are forked.

Commands on whole input run in the parent: validators, option parsers and fonts are built there.
"""

import contextlib
import functools
import io
import os
import sys
import tempfile
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))  # for warm_server

PENDULUM = "scenarios/systems/double_pendulum.yaml"
REHEARSED = [
    ["validate", "scenarios/iltis_ramp_steer.yaml"],
    ["validate", "systems/simple_wheelset.yaml"],
    ["validate", "study.yaml"],
    ["eig", PENDULUM, "-o", "modes.h5"],
    ["equilibrium", PENDULUM],
    ["track", "track.yaml"],
    ["profiles", "s1002.csv", "60E1", "--shift", "-1:1:1", "--amplitude", "2:3:1"],
    ["run", PENDULUM, "-o", "run.h5", "--set", "duration=10 ms", "--backend", "interpreted",
     "--set", "output.interval=5 ms", "--no-plots", "-q"],
    ["sweep", "study.yaml", "-o", "study.h5", "--workers", "1", "--backend", "interpreted", "-q"],
    ["info", "run.h5"], ["plot", "run.h5"], ["plot", "run.h5", "--format", "png"],
    ["report", "run.h5"], ["animate", "run.h5"], ["compare", "run.h5", "run.h5"],
]  # fmt: skip


@functools.cache
def up():
    """Import all modules of the program and its lazy packages, and rehearse its commands."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    os.environ["MPLBACKEND"] = "agg"
    import warm_server

    warm_server.load()
    _rehearse()
    warm_server.freeze()


def _rehearse():
    import harness
    import table_cases
    import yaml_cases

    files = yaml_cases.around({
        "study.yaml": yaml_cases.STUDY.encode(),
        "track.yaml": table_cases.LAYOUT.encode(),
        "s1002.csv": table_cases.profiles()["s1002.csv"].encode(),
    })  # fmt: skip
    _read(files)
    started = Path.cwd()
    with tempfile.TemporaryDirectory(prefix="hostile-warm-") as name:
        harness.write(files, Path(name))
        os.chdir(name)
        try:
            for command in REHEARSED:
                _call(harness.call, command)
        finally:
            os.chdir(started)


def _read(files):
    """Read whole files by the names that commands know them by, so that they are kept."""
    from vehicledyn.base.yaml import parse_yaml

    for name, content in files.items():
        if name.endswith(".yaml"):
            for place in ("", "scenarios/systems/../../"):
                parse_yaml(content.decode(), f"{place}{name}")


def _call(call, command):
    text = io.StringIO()
    with contextlib.redirect_stdout(text), contextlib.redirect_stderr(text):
        code = call(command)
    if code:
        raise RuntimeError(f"{command}: exit code {code}: {text.getvalue()}")
