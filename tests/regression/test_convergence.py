"""Every scenario is converged: half its step moves no channel by 1 %.

Where a tolerance chooses the step, a tenth of it does the same. ``benchmarks/convergence.py`` shows
by how much channels move, at half and a quarter.
"""

import importlib
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


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_half_the_step_moves_no_channel(path, convergence):
    scenario = convergence.ready(path)
    own, half = (convergence.record(*scenario, parts) for parts in (1, 2))
    moved = convergence.differences(own, half)
    too_far = {name: part for name, (part, _) in moved.items() if part > convergence.BAND}
    assert not too_far


def test_too_large_a_step_is_found(convergence):
    path = SCENARIOS / "systems" / "quarter_car.yaml"
    scenario = convergence.ready(path, ["solver.step=20 ms", "output.interval=20 ms"])
    runs = [convergence.record(*scenario, parts) for parts in (1, 2)]
    name, part, _ = convergence.worst(convergence.differences(*runs))
    assert part > convergence.BAND, name
