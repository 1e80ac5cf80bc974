"""Conjugate cams: both rollers touch all the time; constant breadth; forces; refusals."""

from pathlib import Path

import numpy as np
import pytest
from cams_examples import TURN, cam, rise_and_fall

import vehicledyn as vd
from vehicledyn.analyses.cams.second_cam import pushing
from vehicledyn.cams.checks import checked
from vehicledyn.cams.forces import CamLoad, forces_of
from vehicledyn.cams.geometry import turned
from vehicledyn.cams.opposite import opposite_of

SLIDE = {
    "motion": rise_and_fall("cycloidal", "20 mm"),
    "base_radius": "40 mm",
    "follower": {"kind": "roller", "radius": "12 mm", "offset": "3 mm"},
    "conjugate": {
        "follower": {"kind": "roller", "radius": "15 mm", "offset": "-2 mm"},
        "distance": "130 mm",
    },
}
ROCKER = {"kind": "rocker_roller", "radius": "10 mm", "pivot": "100 mm", "arm": "80 mm"}
ROCKING = {
    "motion": rise_and_fall("polynomial_345", "15 deg", "swing"),
    "base_radius": "40 mm",
    "follower": ROCKER,
    "conjugate": {
        "follower": {**ROCKER, "arm": "90 mm", "radius": "12 mm", "side": "below"},
        "angle": "90 deg",
    },
}


def second_centre(pair, theta):
    """Return where the second roller is, in ground axes, from where the first is, by hand."""
    c = pair.moving(theta).coordinate
    if not pair.touch.rocks:
        return np.array([0.002 * np.ones_like(c), c - 0.130])
    below = 0.5 * np.pi - c
    return np.array([0.1 - 0.09 * np.cos(below), -0.09 * np.sin(below)])


@pytest.mark.parametrize("fields", [SLIDE, ROCKING], ids=["slide", "rocker"])
def test_the_second_roller_touches_the_second_profile_at_every_angle(fields):
    pair = cam(**fields)
    second = opposite_of(pair)
    fine = np.linspace(0.0, TURN, 40_001)
    profile = second.in_axes_of_first(second.geometry(fine)).profile
    radius = second.touch.roller
    for theta in np.linspace(0.1, 6.2, 23):
        centre = turned(np.array([-theta]), second_centre(pair, np.array([theta])))
        away = np.hypot(*(profile - centre))
        assert away.min() == pytest.approx(radius, abs=5e-9)


def test_a_circle_has_constant_breadth():
    """A harmonic lift of a flat face is an eccentric circle; faces 2 R apart share it."""
    laws = [{"kind": "harmonic", "over": "180 deg", "lift": lift} for lift in ("20 mm", "-20 mm")]
    pair = cam(
        motion=laws,
        base_radius="30 mm",
        follower={"kind": "flat"},
        conjugate={"follower": {"kind": "flat"}, "distance": "80 mm"},
    )
    second = opposite_of(pair)
    theta = np.linspace(0.0, TURN, 181)
    profile = second.in_axes_of_first(second.geometry(theta)).profile
    centre = np.array([[0.0], [-0.01]])
    assert np.hypot(*(profile - centre)) == pytest.approx(0.04, abs=1e-12)


def test_one_of_the_cams_pushes_and_the_virtual_work_is_that_of_the_load():
    pair = cam(**SLIDE)
    load = CamLoad.model_validate({"speed": "600 rpm", "mass": "2 kg"})
    object.__setattr__(pair, "load", load)
    theta = np.linspace(0.0, TURN, 361)
    geometry = pair.geometry(theta)
    first, second = pushing(pair, geometry)
    assert (first >= 0.0).all() and (second >= 0.0).all() and (first * second == 0.0).all()
    lever = opposite_of(pair).geometry(theta).lever
    needed = 2.0 * (20.0 * np.pi) ** 2 * geometry.motion.second
    assert first * geometry.lever - second * lever == pytest.approx(needed, abs=1e-9)
    assert forces_of(pair, load, geometry).normal.min() < 0.0


def test_a_system_has_both_contacts(tmp_path):
    """The first holds by constraint; the second one's gap stays at zero."""
    fields = "\n".join(f"      {line}" for line in _written().splitlines())
    text = f"""
title: A yoke on two cams
gravity: [0, 0, 0]
bodies:
  shaft: {{joints: [R3 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}}
  yoke: {{joints: [T2 lift], mass: 2 kg}}
elements:
  push: {{kind: cam_joint, cam_body: shaft, follower_body: yoke, axis: 3,
    point: [3 mm, 0, 0], cam: &pair
{fields}
    }}
  pull: {{kind: cam_contact, cam_body: shaft, follower_body: yoke, axis: 3, touches: second,
    point: [2 mm, -130 mm, 0], stiffness: 1e3, exponent: 1, cam: *pair}}
drives:
  shaft: {{coordinate: shaft.angle, law: {{kind: constant_rate, rate: 10 rad/s}}}}
"""
    start = "initial: {yoke.lift: 50 mm}\n"
    path = tmp_path / "yoke.yaml"
    path.write_text(text)
    with pytest.raises(vd.NumericalError, match=r"'push\.constraint' has no direction"):
        vd.simulate(path, duration="0.1 s", backend="interpreted")
    path.write_text(text + start)
    found = vd.simulate(
        path, duration="0.62 s", solver={"kind": "rk4", "step": "1 ms"},
        output={"interval": "10 ms"}, backend="interpreted",
    )  # fmt: skip
    assert np.abs(found["pull.gap"].values).max() < 1e-11
    assert np.ptp(found["yoke.lift"].values) == pytest.approx(0.02, rel=1e-4)


def _written():
    laws = ", ".join(
        "{" + ", ".join(f"{k}: {v}" for k, v in law.items()) + "}" for law in SLIDE["motion"]
    )
    return (
        f"{{motion: [{laws}], base_radius: 40 mm,\n"
        "follower: {kind: roller, radius: 12 mm, offset: 3 mm},\n"
        "conjugate: {follower: {kind: roller, radius: 15 mm, offset: -2 mm}, distance: 130 mm}}"
    )


@pytest.mark.parametrize(
    ("fields", "change", "words"),
    [
        (SLIDE, {"angle": "1 rad"}, "give the distance of a slide or the angle of a rocker"),
        (SLIDE, {"distance": "60 mm"}, "the second follower does not reach its cam"),
        (SLIDE, {"distance": "72 mm"}, "take a larger distance"),
        (SLIDE, {"distance": None, "angle": "1 rad"}, "leave it out and give the distance"),
        (SLIDE, {"follower": ROCKER}, "must slide as the follower does"),
        (ROCKING, {"follower": ROCKER}, "side: must be the other one"),
        (ROCKING, {"follower": {**ROCKER, "pivot": "90 mm"}}, "pivot: must be that"),
        (ROCKING, {"angle": "40 deg"}, "does not reach"),
    ],
)
def test_refused(fields, change, words):
    pair = {k: v for k, v in (fields["conjugate"] | change).items() if v is not None}
    try:
        given = cam(**(fields | {"conjugate": pair}))
    except ValueError as error:
        assert words in str(error)
        return
    _, found = checked(given, Path())
    assert any(words in fault.words for fault in found), found
