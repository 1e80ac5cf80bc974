"""Elastic contact: Hertz where profiles are circles, patches beside a jump, loads carried."""

import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.rail.geometry.contact_geometry import (
    MountedWheel,
    Pose,
    place_rail,
    touching_points,
)
from vehicledyn.rail.geometry.elastic_geometry import patches, settled
from vehicledyn.rail.geometry.hertz import effective_modulus, hertz
from vehicledyn.rail.geometry.wheelset_geometry import WheelsetOnTrack, find_jumps, stand
from vehicledyn.rail.profiles.named_profiles import circle, cone, named_profile

STEEL = effective_modulus(210e9, 0.28, 210e9, 0.28)
S1002 = MountedWheel(named_profile("S1002", "wheel"), 0.46, 0.75)
RAIL = place_rail(named_profile("60E1", "rail"), np.arctan(1 / 40), 1.435, 0.014)


def pose_of(standing, depth=0.0):
    return Pose(standing.lateral, standing.height - depth, standing.roll, standing.yaw)


@pytest.mark.parametrize("approach", [2e-5, 8e-5])
def test_cylinder_on_a_round_rail_is_hertzian(approach):
    wheel = MountedWheel(cone(0.0, "wheel"), 0.46, 0.75)
    rail = place_rail(circle(0.3, "rail"), 0.0, 1.435, 0.014)
    (patch,) = patches(wheel, rail, Pose(0.004, 0.46 - approach, 0.0, 0.0), STEEL)
    expected = hertz(0.5 / 0.46, 0.5 / 0.3, STEEL)
    assert patch.approach == pytest.approx(approach, rel=1e-4)
    assert patch.curvature_y == pytest.approx(0.5 / 0.3, rel=2e-3)
    assert patch.force == pytest.approx(expected.force(approach), rel=2e-3)
    assert patch.semi_axis_y == pytest.approx(expected.ellipse_at(approach).semi_axis_y, rel=2e-3)
    assert patch.y == pytest.approx(rail.origin[0], abs=1e-6)
    assert patch.place == pytest.approx(rail.origin[0] - 0.754, abs=1e-6)


def test_small_loads_touch_where_rigid_bodies_do():
    for lateral in (0.002, 0.004, 0.0056, 0.0075):
        standing = stand(WheelsetOnTrack(S1002, S1002, RAIL, RAIL), lateral)
        _, (patch, *rest) = settled(S1002, RAIL, pose_of(standing), 50.0, STEEL)
        assert rest == []
        assert patch.place == pytest.approx(standing.left.place[0], abs=1e-4)
        assert np.tan(patch.angle) == pytest.approx(standing.left.slope[0], rel=5e-3)
        assert patch.radius == pytest.approx(0.46 + S1002.table.height(patch.place), abs=1e-12)


def test_both_points_carry_at_a_jump():
    wheelset = WheelsetOnTrack(S1002, S1002, RAIL, RAIL)
    jump = find_jumps(wheelset, [stand(wheelset, y) for y in (0.0049, 0.0051)])[0]
    standing = stand(wheelset, jump.lateral)
    _, found = settled(S1002, RAIL, pose_of(standing), 1e4, STEEL)
    assert len(found) == 2
    assert sorted(p.place for p in found) == pytest.approx(sorted(jump.places), abs=1e-3)
    assert min(p.force for p in found) > 500.0


def test_load_is_carried_and_grows_with_depth():
    standing = stand(WheelsetOnTrack(S1002, S1002, RAIL, RAIL), 0.003)
    heights = []
    for load in (1e3, 1e4, 1e5):
        height, found = settled(S1002, RAIL, pose_of(standing), load, STEEL)
        heights.append(height)
        assert sum(p.force * np.cos(p.angle) for p in found) == pytest.approx(load, rel=1e-6)
    assert (np.diff(heights) < 0.0).all()


def test_force_is_continuous_across_a_jump():
    """The wheel slides over the place where rigid contact leaps, at constant depth."""
    forces = []
    for lateral in np.linspace(0.0001, 0.0004, 61):
        touch = touching_points(S1002, RAIL, Pose(lateral, 0.46, 0.0, 0.0))
        pose = Pose(lateral, 0.46 - touch.gap[0] - 2e-5, 0.0, 0.0)
        forces.append(sum(p.force for p in patches(S1002, RAIL, pose, STEEL)))
    assert np.abs(np.diff(forces)).max() < 0.15 * max(forces)


def test_lifted_wheel_has_no_contact():
    standing = stand(WheelsetOnTrack(S1002, S1002, RAIL, RAIL), 0.003)
    assert patches(S1002, RAIL, pose_of(standing, -1e-6), STEEL) == ()
    assert patches(S1002, RAIL, Pose(0.2, 0.46, 0.0, 0.0), STEEL) == ()


def test_impossible_loads_are_refused():
    pose = Pose(0.0, 0.46, 0.0, 0.0)
    with pytest.raises(InputError, match="over 1 mm"):
        settled(S1002, RAIL, pose, 1e9, STEEL)
    with pytest.raises(InputError, match="not above its rail"):
        settled(S1002, RAIL, pose._replace(lateral=0.2), 1e4, STEEL)
