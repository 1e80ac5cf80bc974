"""Runs report bodies whose angles come near to where two of their turns are one."""

import h5py
import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.analyses.simulation.partitions.singular_turns import SingularTurns, Watched
from vehicledyn.files.scenario import load_scenario

BRICK = """\
title: A brick that turns over
bodies:
  brick:
    parent: ground
    joints: [{kind: JOINT}]
    mass: 2 kg
    inertia: [0.01 kg*m^2, 0.02 kg*m^2, 0.03 kg*m^2, 0, 0, 0]
"""
RUN = """\
title: It turns over
model: brick.yaml
initial: {brick.pitch_rate: RATE rad/s, brick.yaw_rate: 0.01 rad/s}
duration: 1 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 50 ms}
"""


def ran(folder, rate, joint="free"):
    (folder / "brick.yaml").write_text(BRICK.replace("JOINT", joint))
    (folder / "run.yaml").write_text(RUN.replace("RATE", str(rate)))
    outcome = run_scenario(
        load_scenario(folder / "run.yaml"), output=folder / "r.h5", backend="interpreted",
        progress=lambda *_: None,
    )  # fmt: skip
    told = [m for m in outcome.messages if "accuracy is lost there" in m]
    with h5py.File(folder / "r.h5") as file:
        return told, file


def test_a_pitch_of_ninety_degrees_is_reported(tmp_path):
    """It falls between two samples: π/2 at 1.9 rad/s is reached at 0.8267 s.

    Angular momentum turns the pitch back 0.45 degrees before: 0.03 · 0.01 / (0.02 · 1.9).
    """
    told, _ = ran(tmp_path, 1.9)
    (text,) = told
    assert text.startswith("body 'brick': its angle brick.pitch ")
    assert float(text.partition("at t = ")[2].split()[0]) == pytest.approx(
        0.5 * np.pi / 1.9, abs=0.03
    )
    with h5py.File(tmp_path / "r.h5") as file:
        names = [n.decode() if isinstance(n, bytes) else str(n) for n in file["events/name"][()]]
        assert "brick.singular_angles" in names
        assert any("accuracy is lost there" in str(n) for n in _texts(file))


def _texts(file):
    """All texts of the attributes and data sets of a file."""
    found = [str(v) for v in file.attrs.values()]

    def look(_, item):
        found.extend(str(v) for v in item.attrs.values())
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "OS":
            found.append(str(item[()]))

    file.visititems(look)
    return found


def test_other_motions_are_not_remarked(tmp_path):
    assert ran(tmp_path, 1.5)[0] == []


def test_another_sequence_keeps_away(tmp_path):
    """With the pitch as the first turn the same motion is harmless."""
    assert ran(tmp_path, 1.9, "free, sequence: [2, 3, 1]")[0] == []


def watched(is_proper=False):
    return SingularTurns([Watched("brick", "brick.pitch", (0, 1), is_proper)])


@pytest.mark.parametrize("pieces", [1, 3, 11])
@pytest.mark.parametrize(("is_proper", "place"), [(False, 0.5 * np.pi), (True, np.pi)])
def test_what_is_passed_between_samples_is_found(pieces, is_proper, place):
    """However the samples come, also at the seam of two portions."""
    times = np.linspace(0.0, 2.0, 12)
    angles = place - 1.3 + 1.1 * times
    turns = watched(is_proper)
    for part in np.array_split(np.arange(12), pieces):
        turns.take(
            times[part], np.column_stack([0.0 * angles, angles])[part], np.zeros((len(part), 0))
        )
    (item,) = turns.came_near()
    assert item.nearest < 1e-12
    assert item.time == pytest.approx(1.3 / 1.1, abs=1e-3)
    assert "passes" in turns.remarks()[0]


def test_coming_near_counts_and_dependent_angles_are_seen():
    times = np.linspace(0.0, 1.0, 101)
    angles = 0.5 * np.pi - 0.01 - (times - 0.5) ** 2
    turns = watched()
    turns.take(times, np.zeros((101, 1)), angles[:, None])
    (item,) = turns.came_near()
    assert item.nearest == pytest.approx(np.sin(0.01), rel=1e-9)
    assert item.time == 0.5
    assert "comes within 0.57" in turns.remarks()[0]
