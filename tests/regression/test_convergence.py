"""Every scenario with a fixed step is converged: half the step moves no channel by 1 %.

``benchmarks/convergence.py`` shows the same of whole scenarios, at half and a quarter.
"""

import importlib
import sys
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from vehicledyn.codegen.toolchain.compiler import CompilationError, find_compiler

ROOT = Path(__file__).parents[2]
SCENARIOS = ROOT / "scenarios"
FIXED = ("rk4", "rkc", "symplectic_euler")
PARTS = {
    "bas2000_curve": "3.5 s",
    "bogie_hunting": "1 s",
    "car_and_caravan": "3 s",
    "iltis_slalom": "8 s",
    "iltis_standstill": "2 s",
    "manchester_irregular_track": "2 s",
    "off_road_truck_rough": "2.5 s",
    "off_road_truck_sand": "1 s",
    "off_road_truck_slope": "1.5 s",
    "s1002_uic60_geometry": "1.7 s",
    "tractor_semitrailer": "8 s",
    "tram2000_curve": "1.8 s",
    "wheelset_limit_cycle": "1 s",
    "curving_wheelset": "1.1 s",
}
"""How long scenarios run here that take long: past the first place where they are sensitive."""


def chosen():
    """The scenarios with a fixed step."""
    files = [*sorted(SCENARIOS.glob("*.yaml")), *sorted((SCENARIOS / "systems").glob("*.yaml"))]
    return [f for f in files if YAML(typ="safe").load(f)["solver"]["kind"] in FIXED]


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


@pytest.mark.parametrize("path", chosen(), ids=lambda path: path.stem)
def test_half_the_step_moves_no_channel(path, convergence):
    changes = [f"duration={PARTS[path.stem]}"] if path.stem in PARTS else []
    scenario = convergence.ready(path, changes)
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
