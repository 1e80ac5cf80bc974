"""The campaign of the accuracy watch, on few light scenarios: nothing missed, no false alarm."""

import importlib.util
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.long

SCRIPT = Path(__file__).parents[3] / "benchmarks" / "accuracy_watch.py"
LIGHT = ("systems/quarter_car", "systems/double_spring_mass", "systems/jeep_suspension")


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("accuracy_watch", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    sys.modules["accuracy_watch"] = module
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(SCRIPT.parent)
        spec.loader.exec_module(module)
    return module


def test_random_steps_of_light_scenarios(script, needs_compiler):
    found = script.campaign(30, seed=3, names=LIGHT)
    classes = [script.class_of(finding) for finding in found]
    assert {"bad", "good"} <= set(classes)
    for finding, kind in zip(found, classes, strict=True):
        if kind != "grey":
            assert (finding.verdict == "accurate") == (kind == "good"), finding


def test_random_steps_of_masses_on_forces_that_jump(script, needs_compiler, tmp_path):
    names = script.jumping_systems(tmp_path, 3, seed=2)
    found = script.campaign(5, seed=5, names=names, coarse=20.0)
    bad = [finding for finding in found if script.class_of(finding) == "bad"]
    assert len(bad) > 1
    assert all(finding.verdict != "accurate" for finding in bad)
