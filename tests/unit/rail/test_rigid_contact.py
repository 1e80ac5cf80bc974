"""Rigid contact by constraint: geometry against a search of profiles, forces against statics."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from outlines import ArcOutline, ConeOutline
from rigid_examples import (
    STRAIGHT,
    Circle,
    channels,
    on_rails,
    rigid_wheels,
    wheelset_body,
    wheelset_on,
)

from vehicledyn.multibody.recursion.numeric_kinematics import raw_skeleton
from vehicledyn.rail.geometry.contact_geometry import MountedWheel, place_rail
from vehicledyn.rail.geometry.wheelset_geometry import WheelsetOnTrack, stand
from vehicledyn.rail.profiles.named_profiles import named_profile
from vehicledyn.symbolic import ops

SHAPES = {
    "cone": ("cone:1/20", ConeOutline(0.05)),
    "ball": ("arc:500 mm", ArcOutline(0.5, (0.0, -0.5))),
}


def round_wheelset(profile, *, inclination=1 / 40, curvature=0.0):
    """Return a wheelset of a profile on rails of one arc."""
    rail = place_rail(named_profile("arc:300 mm", "rail"), np.arctan(inclination), 1.435, 0.001)
    wheel = MountedWheel(named_profile(profile, "wheel"), 0.46, rail.origin[0])
    return WheelsetOnTrack(wheel, wheel, rail, rail, curvature)


@pytest.mark.parametrize(
    ("shape", "lateral", "yaw"),
    [("cone", 0.0, 0.0), ("cone", -0.0045, 0.02), ("ball", 0.003, 0.0), ("ball", 0.002, -0.03)],
)
def test_contact_is_where_a_search_of_the_profiles_finds_it(shape, lateral, yaw):
    profile, outline = SHAPES[shape]
    wheelset = round_wheelset(profile)
    standing = stand(wheelset, lateral, yaw)
    starts = (standing.left.place[0] + 1e-3, standing.right.place[0] - 1e-3)
    body = wheelset_body(lateral=lateral, yaw=yaw, height=standing.height)
    found = channels(*on_rails(rigid_wheels(wheelset, outline, starts), body))
    assert found["z"] == pytest.approx(standing.height, abs=2e-9)
    assert found["roll"] == pytest.approx(standing.roll, abs=1e-8)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        touch = getattr(standing, side)
        assert found[f"wheels.{side}.place"] == pytest.approx(touch.place[0], abs=2e-6)
        assert found[f"wheels.{side}.contact_1.lateral_place"] == pytest.approx(
            sign * touch.y[0], abs=2e-6
        )
        assert np.tan(found[f"wheels.{side}.contact_1.angle"]) == pytest.approx(
            touch.slope[0], abs=1e-5
        )


def test_contact_on_a_curve():
    """Seen along a circle of 20 m the rails bend below the wheels; yaw makes that matter."""
    wheelset = round_wheelset("cone:1/5", inclination=1 / 5, curvature=1.0 / 20.0)
    standing = stand(wheelset, 0.002, 0.1)
    starts = (standing.left.place[0], standing.right.place[0])
    body = wheelset_body(lateral=0.002, yaw=0.1, height=standing.height)
    track = replace(STRAIGHT, line=Circle(20.0))
    part = rigid_wheels(wheelset, ConeOutline(0.2), starts, track=track)
    found = channels(*on_rails(part, body))
    assert found["wheels.track_position"] == pytest.approx(0.0, abs=1e-12)
    assert found["wheels.lateral_shift"] == pytest.approx(0.002, abs=1e-12)
    assert found["z"] == pytest.approx(standing.height, abs=2e-9)
    assert found["roll"] == pytest.approx(standing.roll, abs=1e-8)
    straight = stand(replace(wheelset, curvature=0.0), 0.002, 0.1)
    for side in ("left", "right"):
        place = getattr(standing, side).place[0]
        assert abs(getattr(straight, side).place[0] - place) > 2e-5
        assert found[f"wheels.{side}.place"] == pytest.approx(place, abs=2e-6)


def test_normal_forces_carry_the_weight_and_the_creep_forces():
    """Both rails together balance weight and inertia, whatever creep does."""
    wheelset, outline = round_wheelset("cone:1/20"), SHAPES["cone"][1]
    standing = stand(wheelset, 0.003, 0.005)
    starts = (standing.left.place[0], standing.right.place[0])
    body = wheelset_body(lateral=0.003, yaw=0.005, height=standing.height, speed=20.0)
    equations, kernel, state, unknowns = on_rails(rigid_wheels(wheelset, outline, starts), body)
    found = channels(equations, kernel, state, unknowns)
    rates = dict(
        zip([v.name for v in equations.states], kernel.rates(0.0, state, unknowns), strict=True)
    )
    across = found["wheels.left.Y"] + found["wheels.right.Y"]
    assert across == pytest.approx(-1500.0 * rates["y_rate"], rel=1e-9)
    along = [found[f"wheels.{side}.contact_1.longitudinal_force"] for side in ("left", "right")]
    assert abs(along[0]) > 1000.0
    for side in ("left", "right"):
        normal = found[f"wheels.{side}.contact_1.normal_force"]
        creep = np.hypot(
            *(found[f"wheels.{side}.contact_1.{k}_force"] for k in ("longitudinal", "lateral"))
        )
        assert creep <= 0.3 * normal * (1.0 + 1e-9)
        assert found[f"wheels.{side}.vertical_force"] == pytest.approx(
            normal * np.cos(found[f"wheels.{side}.contact_1.angle"]), rel=1e-9
        )


@dataclass(frozen=True)
class Waves:
    """Both rails go up and down alike along the track."""

    height: float
    length: float

    def at(self, side, s):
        return 0.0, self.height * ops.sin(2.0 * math.pi * s / self.length)


def test_wheelset_follows_waves_of_the_rails():
    """Both wheels bear the weight and the inertia of the same motion, m (g + z'' v² + z' v̇)."""
    wheelset, outline = round_wheelset("cone:1/20"), SHAPES["cone"][1]
    standing = stand(wheelset, 0.0)
    starts = (standing.left.place[0], standing.right.place[0])
    waves = Waves(2e-3, 3.0)
    track = replace(STRAIGHT, shifts=(waves,))
    body = wheelset_body(height=standing.height, speed=20.0, ahead=0.7)
    ready = on_rails(rigid_wheels(wheelset, outline, starts, track=track), body)
    found = channels(*ready)
    number = 2.0 * math.pi / waves.length
    phase = number * 0.7
    assert found["z"] - standing.height == pytest.approx(waves.height * math.sin(phase), abs=2e-9)
    equations, kernel, state, unknowns = ready
    names = [variable.name for variable in equations.states]
    gain = kernel.rates(0.0, state, unknowns)[names.index("x_rate")]
    rise = waves.height * number * math.cos(phase)
    lift = rise * gain - waves.height * math.sin(phase) * (number * 20.0) ** 2
    load = found["wheels.left.Q"] + found["wheels.right.Q"]
    assert load == pytest.approx(1500.0 * (9.81 + lift), rel=1e-6)


def test_coordinates_of_contacts_are_not_drawn():
    wheelset = round_wheelset("cone:1/20")
    part = rigid_wheels(wheelset, SHAPES["cone"][1], (0.0, 0.0))
    skeleton = raw_skeleton(wheelset_on(part, wheelset_body(height=0.46)))
    assert [item["name"] for item in skeleton["bodies"]] == ["wheelset"]
