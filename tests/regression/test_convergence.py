"""Every scenario is converged: half its step moves no channel by 1 % but those that its file names.

Where a tolerance chooses the step, a tenth of it does the same. ``benchmarks/convergence.py`` shows
by how much channels move, at half and a quarter.
"""

import importlib
import re
import sys
from pathlib import Path

import pytest

from vehicledyn.codegen.toolchain.compiler import CompilationError, find_compiler

ROOT = Path(__file__).parents[2]
SCENARIOS = ROOT / "scenarios"
PATHS = [*sorted(SCENARIOS.glob("*.yaml")), *sorted((SCENARIOS / "systems").glob("*.yaml"))]


@pytest.fixture(scope="module")
def convergence():
    """The script; interpreted scenarios would take minutes."""
    try:
        find_compiler()
    except CompilationError as error:
        pytest.skip(str(error))
    sys.path.insert(0, str(ROOT / "benchmarks"))
    try:
        return importlib.import_module("convergence")
    finally:
        sys.path.pop(0)


def unsettled(path):
    """Return the words in which a scenario's comments say what does not converge, and why."""
    lines = path.read_text(encoding="utf-8").splitlines()
    comments = " ".join(line.lstrip("# ") for line in lines if line.startswith("#"))
    return re.findall(r"[\w.]*\w", comments) if "not converge" in comments else []


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_half_the_step_moves_no_channel(path, convergence):
    scenario = convergence.ready(path)
    own, half = (convergence.record(*scenario, parts) for parts in (1, 2))
    moved = convergence.differences(own, half)
    too_far = {name: part for name, (part, _) in moved.items() if part > convergence.BAND}
    assert set(too_far) == set(moved).intersection(unsettled(path)), too_far


def test_too_large_a_step_is_found(convergence):
    path = SCENARIOS / "systems" / "quarter_car.yaml"
    scenario = convergence.ready(path, ["solver.step=20 ms", "output.interval=20 ms"])
    runs = [convergence.record(*scenario, parts) for parts in (1, 2)]
    name, part, _ = convergence.worst(convergence.differences(*runs))
    assert part > convergence.BAND, name
