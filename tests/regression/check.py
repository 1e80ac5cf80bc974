#!/usr/bin/env python3
"""Run every scenario as a user would and compare its result with the stored reference.

``check.py [FOLDER]``: results and JUnit reports go to the folder. Two scenarios go at a time.

Tolerance: 1e-7 of a channel's range and 1e-8 in SI on top, for channels that stay at zero.
Compilers, their options and the interpreter differ by rounding only, below 1e-11 of the range
(measured with gcc -O1, -O3 -ffast-math and CasADi); what a change of a model, a law or a method
does is far above.
"""

import os
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from programs import call  # noqa: E402

TOLERANCE = ("--interpolate", "--relative", "1e-7", "--absolute", "1e-8")
_printing = threading.Lock()


def main(folder):
    """Check all scenarios; return whether all agree."""
    os.environ.setdefault("VEHICLEDYN_TEST_SERVERS", tempfile.mkdtemp())
    os.environ.setdefault("VEHICLEDYN_TEST_OWNER", str(os.getpid()))
    os.environ.update(PYTHONSAFEPATH="1", MPLBACKEND="agg")  # as tests do, which share the server
    compiles = "CasADi interprets" not in call(["vehicledyn", "doctor"], ROOT).stdout
    brief = brief_durations()
    paths = [p for folder in ("", "systems") for p in (ROOT / "scenarios" / folder).glob("*.yaml")]
    paths.sort(key=lambda path: (path.stem not in brief, path))  # those that take longest first
    with ThreadPoolExecutor(2) as pool:
        agreed = list(pool.map(lambda path: check(path, folder, brief, compiles), paths))
    return all(agreed)


def brief_durations():
    """Return how long a run of each scenario is that is too long to be run whole."""
    lines = (ROOT / "tests" / "regression" / "brief.txt").read_text().splitlines()
    named = (line.partition(" ") for line in lines if not line.startswith("#"))
    return {name: duration for name, _, duration in named}


def check(path, folder, brief, compiles):
    """Run a scenario and compare its result; print both, return whether they agree."""
    path = path.relative_to(ROOT)
    name = str(path.relative_to("scenarios").with_suffix(""))
    if name in brief and not compiles:
        report(f"{name}: left out, as it takes long without a compiler")
        return True
    result = (folder / name).with_suffix(".h5")
    result.parent.mkdir(parents=True, exist_ok=True)
    changes = ["--set", f"duration={brief[name]}"] if name in brief else []
    began = time.monotonic()
    run = call(["vehicledyn", "run", path, "--no-plots", "--quiet", "-o", result, *changes], ROOT)
    report(f"{run.stdout}{run.stderr}{name}: {time.monotonic() - began:.1f} s")
    if run.returncode:
        return False
    reference = f"tests/regression/references/{name}.h5"
    junit = result.with_suffix(".xml")
    compared = call(
        ["vehicledyn", "compare", result, reference, *TOLERANCE, "--junit", junit], ROOT
    )
    report(compared.stdout + compared.stderr)
    return compared.returncode == 0


def report(text):
    with _printing:
        print(text.rstrip("\n"), flush=True)  # noqa: T201


if __name__ == "__main__":
    wanted = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp()).absolute()
    sys.exit(0 if main(wanted) else 1)
