"""Contact geometry: silhouettes against whole surfaces, closed forms, jumps, symmetry, gauge."""

import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.rail.geometry.contact_geometry import (
    MountedWheel,
    Pose,
    place_rail,
    silhouette,
    touching_points,
    wheel_standing,
)
from vehicledyn.rail.geometry.gauge_fit import check_fit
from vehicledyn.rail.geometry.wheelset_geometry import (
    WheelsetOnTrack,
    find_jumps,
    mirrored,
    stand,
    stand_level,
)
from vehicledyn.rail.profiles.named_profiles import circle, cone, named_profile

S1002 = MountedWheel(named_profile("S1002", "wheel"), 0.46, 0.75)
RAIL = place_rail(named_profile("60E1", "rail"), np.arctan(1 / 40), 1.435, 0.014)
STANDARD = WheelsetOnTrack(S1002, S1002, RAIL, RAIL)


def surface_gap(pose, places, turns):
    """Lowest vertical gap of all points of a wheel's surface, from its definition."""
    c_roll, s_roll = np.cos(pose.roll), np.sin(pose.roll)
    c_yaw, s_yaw = np.cos(pose.yaw), np.sin(pose.yaw)
    yaw = np.array([[c_yaw, -s_yaw, 0.0], [s_yaw, c_yaw, 0.0], [0.0, 0.0, 1.0]])
    roll = np.array([[1.0, 0.0, 0.0], [0.0, c_roll, -s_roll], [0.0, s_roll, c_roll]])
    radius = 0.46 + S1002.table.height(places)[:, None]
    local = np.stack(
        np.broadcast_arrays(radius * np.sin(turns), 0.75 + places[:, None], -radius * np.cos(turns))
    )
    x, y, z = np.einsum("ij,jkl->ikl", yaw @ roll, local)
    across = y + pose.lateral - 0.5 * pose.curvature * x**2
    gap = z + pose.height - RAIL.surface.height(across)
    k = np.unravel_index(np.nanargmin(gap), gap.shape)
    return gap[k], places[k[0]], x[k]


@pytest.mark.parametrize(
    "pose",
    [
        Pose(0.0, 0.46, 0.0, 0.0),
        Pose(0.003, 0.46, 1e-3, 0.01),
        Pose(0.005, 0.46, -2e-3, -0.03),
        Pose(0.0065, 0.46, 4e-3, 0.024),
        Pose(0.004, 0.46, 0.0, 0.02, 0.05),
        Pose(0.0062, 0.46, 1e-3, -0.03, -0.05),
    ],
)
def test_lowest_gap_is_that_of_the_whole_surface(pose):
    """Every point of the wheel is looked at, the silhouette is not used."""
    touch = touching_points(S1002, RAIL, pose)
    place, x = touch.place[0], touch.x[0]
    near = place + np.linspace(-4e-4, 4e-4, 161)
    gap, at_place, at_x = surface_gap(pose, near, np.linspace(-0.12, 0.12, 961))
    assert touch.gap[0] == pytest.approx(gap, abs=2e-8)
    assert touch.gap[0] <= gap + 1e-12
    assert place == pytest.approx(at_place, abs=1e-5)
    assert x == pytest.approx(at_x, abs=1e-4)
    wide, _, _ = surface_gap(pose, np.linspace(-0.062, 0.058, 1201), np.linspace(-0.15, 0.15, 301))
    assert touch.gap[0] <= wide + 1e-12


def test_curved_rail_turns_away_below_a_wheel_ahead():
    """The y of a silhouette counts from the bent rail; its curvature changes the contact."""
    pose = Pose(0.006, 0.46, 0.0, 0.03)
    straight, bent = (
        touching_points(S1002, RAIL, pose._replace(curvature=value)) for value in (0.0, 0.05)
    )
    assert abs(straight.gap[0] - bent.gap[0]) > 1e-6
    place = np.array([-0.03])
    height, slope, _ = S1002.table.values(place)
    seen = silhouette(S1002, pose._replace(curvature=0.05), place, height, slope)
    plain = silhouette(S1002, pose, place, height, slope)
    assert plain.x[0] == pytest.approx(
        -0.72 * np.sin(0.03) - (0.46 + height[0]) * slope[0] * np.sin(0.03), rel=1e-3
    )
    assert seen.y[0] != plain.y[0]


@pytest.mark.parametrize("slope", [0.025, 0.05, 0.1])
def test_cone_on_round_rails(slope):
    """Closed form: a contact where the cone's slope turned by the roll is that of the arc.

    Left and right are solved as two tangency conditions with the roll as the third unknown.
    """
    wheel = MountedWheel(cone(slope, "wheel"), 0.46, 0.75)
    rail = place_rail(circle(0.3, "rail"), 0.0, 1.435, 0.014)
    standing = stand(WheelsetOnTrack(wheel, wheel, rail, rail), 0.004)
    tilt = np.arctan(slope)
    for touch, turned in ((standing.left, standing.roll), (standing.right, -standing.roll)):
        angle = np.arctan(touch.slope[0])
        assert angle == pytest.approx(tilt + turned, abs=1e-9)
        across = touch.y[0] - rail.origin[0]
        assert across == pytest.approx(-0.3 * np.sin(angle), abs=1e-9)
        assert touch.z[0] == pytest.approx(-0.3 * (1.0 - np.cos(angle)), abs=1e-11)


def test_conicity_of_a_cone_on_round_rails():
    """Small shifts: Δr/(2y) = γ (l + R γ)/(l - r γ), as Wickens gives it, R of the rail.

    l is half the distance of the contacts, r the rolling radius, angles small.
    """
    slope, shift = 0.02, 1e-4
    wheel = MountedWheel(cone(slope, "wheel"), 0.46, 0.75)
    rail = place_rail(circle(0.3, "rail"), 0.0, 1.435, 0.014)
    wheelset = WheelsetOnTrack(wheel, wheel, rail, rail)
    middle, standing = stand(wheelset, 0.0), stand(wheelset, shift)
    half = middle.left.y[0]
    radius = 0.46 - slope * middle.left.place[0]
    difference = -slope * (standing.left.place[0] - standing.right.place[0])
    expected = slope * (half + 0.3 * slope) / (half - radius * slope)
    assert difference / (2.0 * shift) == pytest.approx(expected, rel=1e-3)
    assert expected > 1.015 * slope


def test_both_wheels_touch_and_nothing_overlaps():
    for lateral in np.linspace(-0.008, 0.008, 9):
        standing = stand(STANDARD, lateral)
        for touch in (standing.left, standing.right):
            assert touch.gap[0] == pytest.approx(0.0, abs=1e-11)
            assert (np.diff(touch.gap) >= 0.0).all()


def test_jumps_are_contacts_at_two_points():
    standing = [stand(STANDARD, 1e-3 * k) for k in range(8)]
    jumps = find_jumps(STANDARD, standing)
    assert [jump.side for jump in jumps] == ["left"] * 3
    for jump in jumps[:2]:
        at_jump = stand(STANDARD, jump.lateral)
        assert at_jump.left.gap[1] == pytest.approx(0.0, abs=2e-7)
        assert sorted(at_jump.left.place[:2]) == pytest.approx(sorted(jump.places), abs=5e-5)
        for beside, place in zip((-5e-6, 5e-6), jump.places, strict=True):
            found = stand(STANDARD, jump.lateral + beside).left.place[0]
            assert found == pytest.approx(place, abs=1e-4)


def test_jumps_are_found_between_distant_shifts():
    """From no shift to 2 mm the contact leaps and moves on as far again."""
    (jump,) = find_jumps(STANDARD, [stand(STANDARD, 0.0), stand(STANDARD, 0.002)])
    assert jump.lateral == pytest.approx(2.26e-4, abs=2e-6)
    one = MountedWheel(cone(0.05, "wheel"), 0.46, 0.75)
    plain = WheelsetOnTrack(one, one, RAIL, RAIL)
    assert find_jumps(plain, [stand(plain, -0.004), stand(plain, 0.004)]) == []


def test_place_on_the_profile_of_an_inclined_rail():
    """The contact lies on the upright profile, turned and moved to where the rail is."""
    standing = stand(STANDARD, 0.0045)
    place = RAIL.on_profile(standing.left.y[:1], standing.left.z[:1])
    height = RAIL.profile.height(place)
    c, s = np.cos(RAIL.inclination), np.sin(RAIL.inclination)
    assert RAIL.origin[0] + c * place - s * height == pytest.approx(standing.left.y[0], abs=1e-10)
    assert RAIL.origin[1] + s * place + c * height == pytest.approx(standing.left.z[0], abs=1e-10)


def test_mirror_images():
    to_left, to_right = stand(STANDARD, 0.0035, 0.01), stand(STANDARD, -0.0035, -0.01)
    image = mirrored(to_right)
    for name in ("lateral", "yaw", "roll", "height"):
        assert getattr(image, name) == pytest.approx(getattr(to_left, name), abs=1e-11)
    for side in ("left", "right"):
        for name in ("place", "x", "y", "z"):
            one, other = (getattr(getattr(s, side), name)[0] for s in (image, to_left))
            assert one == pytest.approx(other, abs=1e-9)


def test_yaw_moves_flange_contact_forward():
    """Yawed to the left, into the left rail, the left flange touches ahead of the axle.

    The left wheel is drawn back by the yaw, by its distance from the middle: counted from there.
    """
    yaw = 0.01
    touch = stand(STANDARD, 0.0068, -yaw).left
    behind = 0.75 * np.sin(yaw)
    assert touch.x[0] - behind < -5e-3
    other = stand(STANDARD, 0.0068, yaw).left
    assert other.x[0] + behind > 5e-3


def test_level_wheelset_does_not_roll():
    standing = stand_level(STANDARD, 0.005)
    assert standing.roll == 0.0
    assert standing.left.gap[0] == standing.right.gap[0] == 0.0


@pytest.mark.parametrize("inclination", [0.0, 1 / 200, 1 / 60, 1 / 40, 1 / 20, 1 / 10])
def test_gauge_is_where_it_is_asked_for(inclination):
    angle = np.arctan(inclination)
    profile = named_profile("60E1", "rail")
    rail = place_rail(profile, angle, 1.435, 0.014)
    assert rail.surface.height(np.linspace(0.72, 0.78, 60001)).max() == pytest.approx(0.0, abs=1e-9)
    y = np.linspace(profile.begin, 0.0, 400001)
    z = profile.height(y)
    across = rail.origin[0] + np.cos(angle) * y - np.sin(angle) * z
    up = rail.origin[1] + np.sin(angle) * y + np.cos(angle) * z
    assert across[up >= -0.014].min() == pytest.approx(0.7175, abs=2e-7)


@pytest.mark.parametrize(
    ("gauge", "told"),
    [
        (1.40, "the flanges are 1424.9 mm apart: in the middle of the track the left flange"),
        (1.52, "no longer on the crown of its own"),
        (1.60, "does not fit the wheelset"),
    ],
)
def test_gauge_that_does_not_fit(gauge, told):
    rail = place_rail(named_profile("60E1", "rail"), np.arctan(1 / 40), gauge, 0.014)
    with pytest.raises(InputError, match=told):
        check_fit(WheelsetOnTrack(S1002, S1002, rail, rail), gauge)
    check_fit(STANDARD, 1.435)


def test_wheel_of_its_own_stands_as_in_a_wheelset():
    standing = stand(STANDARD, 0.0045, 0.004)
    pose = Pose(standing.lateral, 0.3, standing.roll, standing.yaw)
    for own, side in ((pose, "left"), (pose.mirrored(), "right")):
        height, touch = wheel_standing(S1002, RAIL, own)
        assert height == pytest.approx(standing.height, abs=1e-11)
        for name in ("place", "gap", "y", "z"):
            expected = getattr(getattr(standing, side), name)
            assert getattr(touch, name) == pytest.approx(expected, abs=1e-10)
    with pytest.raises(InputError, match="not above its rail"):
        wheel_standing(S1002, RAIL, pose._replace(lateral=0.3))


def test_wheel_beside_its_rail():
    with pytest.raises(InputError, match=r"at a lateral shift of 120\.000 mm the left wheel"):
        stand(STANDARD, 0.12)


def test_inclined_rail_keeps_jumps_of_its_curvature():
    """A turned rail has the slopes of its arcs turned, also beside the places where they meet."""
    profile = named_profile("60E1", "rail")
    angle = np.arctan(1 / 20)
    rail = place_rail(profile, angle, 1.435, 0.014)
    y = np.concatenate([side * np.linspace(0.0100, 0.0105, 101) for side in (-1, 1)])
    height, slope, _ = profile.values(y)
    c, s = np.cos(angle), np.sin(angle)
    found = rail.surface.values(c * y - s * height + rail.origin[0])[1]
    assert found == pytest.approx((s + c * slope) / (c - s * slope), abs=1e-9)
