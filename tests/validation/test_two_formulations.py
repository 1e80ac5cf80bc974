"""Minimal coordinates and multipliers: shipped mechanisms and suspensions move alike with both."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.prepare import nominal_point, prepare
from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.base.registry import find
from vehicledyn.files.scenario import load_model

pytestmark = pytest.mark.validation

SYSTEMS = Path(__file__).parents[2] / "systems"
STEP, DURATION = 5e-4, 0.3
AGREEMENT = 1e-6
"""Largest difference of a channel, as a part of its range; that of the method with this step."""
LEFT_OUT = ("constraints.", "energy.", "power.")


def moved(folder, name, method):
    """Return the channels of a run with one of the formulations, by name."""
    shutil.copytree(SYSTEMS, folder, dirs_exist_ok=True)
    path = folder / f"{name}.yaml"
    text = path.read_text(encoding="utf-8")
    path.write_text(f"constraint_method: {method}\n{text}", encoding="utf-8")
    silent = {"progress": lambda *_: None}
    prepared = prepare(load_model(str(path)), backend="interpreted", **silent)
    assert prepared.equations.structure["constraint_method"] == method
    start, found = nominal_point(prepared, 0.0), []
    simulate_monitored(
        prepared.subject.system,
        prepared.kernel,
        find("solver", "rk4")(step=STEP),
        start=0.0,
        stop=DURATION,
        state=start.state,
        unknowns=start.unknowns,
        interval=0.01,
        sink=lambda *parts: found.append(parts[3]),
        happened=lambda *_: None,
        **silent,
    )
    names = [channel.name for channel in prepared.equations.channels]
    return dict(zip(names, np.concatenate(found).T, strict=True))


@pytest.mark.parametrize(
    "name", ["slider_crank", "four_bar", "four_bar_chain", "double_wishbone_suspension"]
)
def test_both_formulations_move_alike(tmp_path, name):
    """Coordinates, forces of cuts and joints and all that parts report, and both keep the loops."""
    one, two = (moved(tmp_path / way, name, way) for way in ("partitioning", "multipliers"))
    shared = [key for key in one if key in two and not key.startswith(LEFT_OUT)]
    assert len(shared) > 5
    assert any(np.ptp(one[key]) > 1e-3 for key in shared if re.search("angle|place|_z|\\.z", key))
    for key in shared:
        scale = max(float(np.ptp(one[key])), 1e-3 * float(np.abs(one[key]).max()), 1e-6)
        assert np.abs(two[key] - one[key]).max() < AGREEMENT * scale, key
    for found in (one, two):
        assert found["constraints.position_error"].max() < 1e-9
