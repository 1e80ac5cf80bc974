"""Followers and outlines: closed forms, an independent envelope, gaps as expressions."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from cams_examples import TURN, cam, rise_and_fall

from vehicledyn.base.registry import kinds
from vehicledyn.cams.checks import checked, enough_base, faults
from vehicledyn.cams.forces import CamLoad, forces_of, lift_off_speed
from vehicledyn.cams.gap import axial_gap, line_gap, point_gap
from vehicledyn.symbolic import ops

ANGLES = np.linspace(0.01, 6.27, 83)
ROLLER = {"kind": "roller", "radius": "10 mm", "offset": "8 mm"}
ROCKER = {"kind": "rocker_roller", "radius": "10 mm", "pivot": "80 mm", "arm": "70 mm"}
ECCENTRIC = {"kind": "eccentric_circle", "radius": "40 mm", "eccentricity": "10 mm"}
FOLLOWERS = {
    "roller": ROLLER,
    "knife_edge": {"kind": "knife_edge", "offset": "-5 mm"},
    "flat": {"kind": "flat", "tilt": "5 deg"},
    "rocker_roller": {**ROCKER, "side": "below"},
    "rocker_knife_edge": {"kind": "rocker_knife_edge", "pivot": "80 mm", "arm": "70 mm"},
    "rocker_flat": {"kind": "rocker_flat", "pivot": "80 mm", "offset": "5 mm"},
    "axial_roller": {"kind": "axial_roller", "distance": "40 mm", "radius": "6 mm"},
}


def arcs():
    """Return a convex cam of a base circle, two flanks and a nose, tangent to each other."""
    base, nose, lift, flank = 0.020, 0.008, 0.022, 0.060
    y = ((flank - base) ** 2 - (flank - nose) ** 2 + lift**2) / (2.0 * lift)
    x = math.sqrt((flank - base) ** 2 - y**2)
    first, last = math.atan2(-y, x), math.atan2(lift - y, x)
    chain = [
        (flank, last - first),
        (nose, math.pi - 2 * last),
        (flank, last - first),
        (base, math.pi + 2 * first),
    ]
    start = [base * math.cos(first), base * math.sin(first)]
    edges = [{"radius": r, "turn": turn} for r, turn in chain]
    return {"kind": "arcs", "start": start, "normal": first, "arcs": edges}


def tangent_cam():
    """Return a cam of two arcs and two straight flanks."""
    base, nose, lift = 0.020, 0.008, 0.025
    tilt = math.asin((base - nose) / lift)
    length = math.sqrt(lift**2 - (base - nose) ** 2)
    edges = [
        {"length": length},
        {"radius": nose, "turn": math.pi - 2 * tilt},
        {"length": length},
        {"radius": base, "turn": math.pi + 2 * tilt},
    ]
    start = [base * math.cos(tilt), base * math.sin(tilt)]
    return {"kind": "arcs", "start": start, "normal": tilt, "arcs": edges}


def measured(folder):
    """Write the eccentric circle as measured points and return the outline."""
    a = np.linspace(0.0, TURN, 400, endpoint=False)
    r = -10.0 * np.sin(a) + np.sqrt(40.0**2 - (10.0 * np.cos(a)) ** 2)
    rows = [f"{np.degrees(x):.15g},{y:.15g}" for x, y in zip(a, r, strict=True)]
    folder.joinpath("points.csv").write_text("\n".join(["a [deg],r [mm]", *rows]))
    return {"kind": "points", "file": str(folder / "points.csv")}


def outlines(folder):
    return {"eccentric_circle": ECCENTRIC, "arcs": arcs(), "points": measured(folder)}


def of_follower(kind):
    """Return a cam by a motion law for a follower."""
    rocks = kind.startswith("rocker")
    laws = rise_and_fall("cycloidal", "10 deg" if rocks else "12 mm", "swing" if rocks else "lift")
    return cam(motion=laws, base_radius="40 mm", follower=FOLLOWERS[kind])


def in_cam(geometry, vectors):
    c, s = np.cos(geometry.motion.theta), np.sin(geometry.motion.theta)
    return np.array([c * vectors[0] + s * vectors[1], c * vectors[1] - s * vectors[0]])


def measured_gap(found, geometry, away):
    """Return gap and normal of a follower that is moved away along its normal."""
    normal = geometry.normal if found.touch.shape == "axial" else in_cam(geometry, geometry.normal)
    names = [ops.symbol(n) for n in ("x", "y", "nx", "ny")]
    if found.touch.shape == "line":
        gap = line_gap(found, *names)
        points = geometry.profile + away * normal
        given = [*points, *normal]
    else:
        gap = point_gap(found, *names[:2]) if found.touch.shape == "point" else None
        points = geometry.pitch + away * normal
        if gap is None:
            gap = axial_gap(found, -names[0] / found.touch.distance, names[1])
            gap = type(gap)(gap.distance, (-gap.normal[0], gap.normal[1]))
        given = [*points, *normal]
    function = ops.numeric(names, ops.column([gap.distance, *gap.normal, gap.along]))
    rows = np.array([function(*row)[:, 0] for row in np.array(given).T])
    return rows[:, 0], rows[:, 1:3].T, normal


@pytest.mark.parametrize("kind", kinds("cam_follower"))
def test_gaps_of_motion_laws_vanish_on_the_cam_and_grow_along_its_normal(kind):
    found = of_follower(kind)
    geometry = found.geometry(ANGLES)
    gap, own, normal = measured_gap(found, geometry, 0.0)
    assert np.abs(gap).max() < 1e-15
    assert np.abs(own - normal).max() < 1e-12
    gap, _, _ = measured_gap(found, geometry, 1e-6)
    assert gap == pytest.approx(np.full(ANGLES.size, 1e-6), abs=2e-11)


@pytest.mark.parametrize("kind", kinds("cam_outline"))
@pytest.mark.parametrize("follower", ["roller", "flat", "rocker_roller", "rocker_flat"])
def test_outlines_move_followers_and_their_gaps_vanish(kind, follower, tmp_path):
    found = cam(outline=outlines(tmp_path)[kind], follower=FOLLOWERS[follower])
    geometry = found.geometry(ANGLES)
    gap, _, _ = measured_gap(found, geometry, 0.0)
    assert np.abs(gap).max() < 1e-12
    step = 1e-5
    before, after = (found.moving(ANGLES + sign * step) for sign in (-1, 1))
    slope = (after.coordinate - before.coordinate) / (2 * step)
    assert slope == pytest.approx(geometry.motion.slope, abs=1e-9)
    bend = (after.slope - before.slope) / (2 * step)
    smooth = np.abs(bend - geometry.motion.second) < 1e-6 * max(1.0, np.abs(bend).max())
    assert smooth.sum() >= ANGLES.size - 4  # where arcs join the acceleration jumps


@pytest.mark.parametrize("follower", [k for k in FOLLOWERS if k not in ("axial_roller",)])
def test_profiles_are_envelopes(follower):
    """Nothing of the profile is inside the follower at any angle: an independent search."""
    found = of_follower(follower)
    fine = found.geometry(np.linspace(0.0, TURN, 20_001))
    for theta in ANGLES[::9]:
        geometry = found.geometry(np.array([theta]))
        c, s = math.cos(theta), math.sin(theta)
        x, y = c * fine.profile[0] - s * fine.profile[1], s * fine.profile[0] + c * fine.profile[1]
        if geometry.along is None:
            centre = found.touch.centre(geometry.motion.coordinate).place[:, 0]
            nearest = np.hypot(x - centre[0], y - centre[1]).min() - found.touch.roller
        else:
            line = found.touch.line(geometry.motion.coordinate)
            nearest = (line.distance - x * np.cos(line.angle) - y * np.sin(line.angle)).min()
        # an edge touches at one point, beside which the samples lie
        assert -1e-9 < nearest < (1e-6 if "knife" not in follower else 2e-5)


def test_an_eccentric_circle_is_its_closed_form():
    flat = cam(outline=ECCENTRIC, follower={"kind": "flat"})
    motion = flat.moving(ANGLES)
    assert motion.coordinate - flat.start == pytest.approx(0.01 * (1 - np.cos(ANGLES)), abs=1e-16)
    assert motion.second == pytest.approx(0.01 * np.cos(ANGLES), abs=1e-15)
    top = {**ECCENTRIC, "direction": "90 deg"}
    roller = cam(outline=top, follower={"kind": "roller", "radius": "10 mm"})
    height = 0.01 * np.cos(ANGLES) + np.sqrt(0.05**2 - (0.01 * np.sin(ANGLES)) ** 2)
    assert roller.moving(ANGLES).coordinate == pytest.approx(height, abs=1e-15)
    assert roller.geometry(ANGLES).profile_radius == pytest.approx(np.full(83, 0.04), abs=1e-14)


def test_the_least_height_lies_between_the_samples():
    """An offset roller on an eccentric circle, where line and centres lie in one line."""
    follower = {"kind": "roller", "radius": "7 mm", "offset": "5 mm"}
    circle = {**ECCENTRIC, "radius": "35 mm", "eccentricity": "12 mm", "direction": "31 deg"}
    found = cam(outline=circle, follower=follower)
    assert found.start == pytest.approx(math.sqrt((0.042 - 0.012) ** 2 - 0.005**2), abs=1e-15)


def test_a_tangent_cam_has_straight_flanks():
    found = cam(outline=tangent_cam(), follower={"kind": "roller", "radius": "10 mm"})
    geometry = found.geometry(np.linspace(0.0, TURN, 721))
    straight = ~np.isfinite(geometry.pitch_radius) | (np.abs(geometry.pitch_radius) > 1e6)
    assert 20 < straight.sum() < 300
    x, y = geometry.profile
    assert np.hypot(x, y).min() == pytest.approx(0.020, abs=1e-12)
    assert np.hypot(x, y).max() == pytest.approx(0.033, abs=1e-6)


def test_a_cam_that_hardly_lifts_has_a_lift_off_speed():
    """No infinity may get into the search between falls and rises."""
    outline = {**ECCENTRIC, "eccentricity": "1e-11 mm"}
    found = cam(outline=outline, follower={"kind": "roller", "radius": "9 mm"})
    assert lift_off_speed(found, CamLoad(speed=60.0, mass=1.0))[0] == 0.0  # without a spring


def test_lift_off_speed_and_force_of_the_flat_follower():
    """Closed form of the eccentric disc, ω² = (F0 + 2 k e) / (m e)."""
    found = cam(outline=ECCENTRIC, follower={"kind": "flat"})
    load = CamLoad(speed=120.0, mass=0.5, stiffness=2000.0, preload=20.0)
    assert lift_off_speed(found, load)[0] == pytest.approx(math.sqrt(60.0 / 0.005), rel=1e-12)
    force = forces_of(found, load, found.geometry(ANGLES)).normal
    exact = 20 + 20 * (1 - np.cos(ANGLES)) + 0.5 * 120**2 * 0.01 * np.cos(ANGLES)
    assert force == pytest.approx(exact, rel=1e-12, abs=1e-12)


def test_forces_do_the_work_of_the_shaft():
    """The work of the torque over a turn is none; N acts along the pressure angle."""
    found = of_follower("roller")
    load = CamLoad(speed=150.0, mass=0.4, stiffness=9000.0, preload=150.0)
    geometry = found.geometry(np.linspace(0.0, TURN, 7201))
    normal, torque = forces_of(found, load, geometry)
    assert np.trapezoid(torque, geometry.motion.theta) == pytest.approx(0.0, abs=1e-7)
    spring = 150.0 + 9000.0 * (geometry.motion.coordinate - found.start)
    needed = spring + 0.4 * 150.0**2 * geometry.motion.second
    assert normal * np.cos(geometry.pressure_angle) == pytest.approx(needed, rel=1e-12)


@pytest.mark.parametrize(
    ("fields", "place", "words"),
    [
        (
            {
                "base_radius": "2 mm",
                "motion": rise_and_fall("cycloidal", "12 mm", angles=(40, 0, 40)),
            },
            "base_radius",
            "the roller undercuts the cam between",
        ),
        ({"base_radius": "5 mm", "follower": {"kind": "flat"}}, "base_radius", "the flat face un"),
        (
            {"follower": {**ROCKER, "arm": "170 mm"}},
            "follower",
            "the arm of 170 mm is longer than its cam allows.*between 30 and 130 mm",
        ),
        (
            {"follower": {**ROLLER, "offset": "60 mm"}},
            "follower",
            "the offset of 60 mm passes the base circle",
        ),
        (
            {"follower": {"kind": "flat", "face": ["5 mm", "5 mm"]}},
            "follower",
            "from -.* mm along the face, which goes from -5 to 5 mm",
        ),
        (
            {"motion": rise_and_fall("uniform", "12 mm")},
            "motion",
            "the velocity jumps at 120 deg, 180 deg, 280 deg, 0 deg|360 deg",
        ),
        ({"motion": rise_and_fall("cycloidal", "5 deg", "swing")}, "motion", "needs a lift"),
    ],
)
def test_cams_that_cannot_be_are_named_with_a_remedy(fields, place, words):
    laws = rise_and_fall("cycloidal", "12 mm")
    if fields.get("follower", {}).get("kind") == "rocker_roller":
        laws = rise_and_fall("cycloidal", "10 deg", "swing")
    given = {"motion": laws, "base_radius": "40 mm", "follower": ROLLER, **fields}
    _, found = checked(cam(**given), Path())
    assert [fault.place[0] for fault in found] == [place]
    assert re.search(words, found[0].words)


def test_the_base_radius_that_is_proposed_has_no_undercut():
    laws = rise_and_fall("cycloidal", "12 mm", angles=(60, 0, 60))
    small = cam(motion=laws, base_radius="5 mm", follower={"kind": "roller", "radius": "10 mm"})
    enough = enough_base(small)
    assert list(faults(small))
    for factor, is_cut in ((1.0, False), (0.98, True)):
        other = cam(motion=laws, base_radius=factor * enough, follower=small.follower)
        assert bool(list(faults(other))) == is_cut


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"radius": 0.008, "turn": 2.0}, "its arcs turn by"),
        ({"radius": 0.009, "turn": math.pi - 2 * math.asin(0.48)}, "it ends .* mm from its start"),
    ],
)
def test_outlines_that_do_not_close_are_refused(change, words):
    outline = tangent_cam()
    outline["arcs"][1] = change
    _, found = checked(cam(outline=outline, follower={"kind": "flat"}), Path())
    assert re.search(f"does not close: {words}", found[0].words)
