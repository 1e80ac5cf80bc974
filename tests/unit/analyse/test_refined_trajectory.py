"""Meshes of trajectories cut where their intervals miss."""

import numpy as np
import pytest

from vehicledyn.analyse.optimal_control.problem import RAMP, Control
from vehicledyn.analyse.optimal_control.trajectory import DEGREE, Trajectory, radau_points
from vehicledyn.studies.manoeuvre_optimisation.run import _parts


def test_a_refined_mesh_holds_the_same_motion():
    """A cubic stays what it is, and a straight control too, in one, two and four parts."""
    mesh = np.array([0.0, 0.3, 0.6, 1.0])
    inner = mesh[:-1, None] + np.diff(mesh)[:, None] * radau_points()

    def cubic(t):
        return 1.0 - 2.0 * t + 3.0 * t**3

    control = Control("u", "N", RAMP, (), -9.0, 9.0, 9.0)
    values = 2.0 * mesh[:, None] - 1.0
    given = Trajectory(
        2.0, mesh, cubic(mesh[:1]), cubic(inner)[..., None], inner[..., None] ** 2, 0.0, inner,
        values, np.zeros((4, 1)), np.zeros((3, 1)), np.zeros((3, DEGREE, 1)),
    )  # fmt: skip
    found = given.refined((control,), np.array([1, 2, 4]))
    assert found.mesh == pytest.approx([0.0, 0.3, 0.45, 0.6, 0.7, 0.8, 0.9, 1.0])
    part = found.times / 2.0
    assert found.all_states[:, 0] == pytest.approx(cubic(part), abs=1e-13)
    assert found.unknowns.ravel() == pytest.approx(part[1:] ** 2, abs=1e-13)
    assert found.all_distances == pytest.approx(part, abs=1e-13)
    assert found.values[:, 0] == pytest.approx(2.0 * found.mesh - 1.0, abs=1e-13)


def test_intervals_are_cut_into_more_parts_the_further_they_miss():
    errors = np.array([0.2, 1.0, 1.1, 4.0, 5.0, 1e9, np.inf, np.nan])
    assert _parts(errors, 1.0).tolist() == [1, 1, 2, 2, 3, 4, 4, 4]
