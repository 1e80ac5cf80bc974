"""Wheels on curved track: creepages in closed form, mirror images, moving rails."""

from dataclasses import replace

import casadi
import pytest

import vehicledyn.rail.creep  # noqa: F401
from vehicledyn.base.registry import find
from vehicledyn.rail.contact.elastic_contact import ElasticContact
from vehicledyn.rail.contact.rail_contact import RailWheels
from vehicledyn.rail.contact.wheel_on_rail import ElasticWheels
from vehicledyn.rail.profiles.named_profiles import named_profile
from vehicledyn.rail.track.running import RailPlace, Running
from vehicledyn.rail.track.track import Track, TrackFrame
from vehicledyn.symbolic import ops, rotations

RADIUS, HALF, SPEED = 0.46, 0.75, 20.0
SIDES = ("left", "right")


def wheels(profile, rail):
    track = Track(1.435, 0.014, 0.0, rail)
    chosen = RailWheels(
        "wheels", "wheelset", SIDES, named_profile(profile, "wheel"), radius=RADIUS,
        tape_circle=HALF, radius_number=RADIUS, track=track,
        creep=find("creep", "linear")(friction=0.3),
    )  # fmt: skip
    contact = ElasticContact.of(*chosen.geometry())
    return ElasticWheels(
        "wheels", chosen, contact, effective_modulus=1.14e11, shear_modulus=8.2e10,
        poissons_ratio=0.28, damping=2.0,
    )  # fmt: skip


def number(expression):
    return float(casadi.Function("number", [], [expression])()["o0"])


def motion(curvature, *, shift=0.0, yaw=0.0, height=RADIUS - 8e-5):
    """Return a wheelset that rolls along a curve with the spin of its tape circles."""
    rotation = rotations.turn(3, yaw)
    nothing = {side: RailPlace(0.0, 0.0) for side in SIDES}
    return Running(
        0.0, SPEED, TrackFrame(ops.vector(0.0, 0.0, 0.0), rotations.identity(), 1.0,
                               ops.vector(0.0, 0.0, curvature)),
        ops.vector(0.0, shift, height), rotation[:, 1], ops.vector(SPEED, 0.0, 0.0),
        rotation @ ops.vector(0.0, SPEED / RADIUS, 0.0)
        + ops.vector(0.0, 0.0, curvature * SPEED), nothing,
    )  # fmt: skip


@pytest.mark.parametrize("curvature", [0.01, -0.02])
def test_cylinders_in_a_curve_creep_by_the_unequal_ways(curvature):
    """The way of the inner contact is shorter by κ b, that of the outer one longer."""
    part = wheels("cone:0", "arc:300 mm")
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        (at,) = part.forces(motion(curvature).seen_from(side)).patches
        shorter = sign * curvature * number(at.patch.y)
        creep = [number(x) for x in (at.creepages.longitudinal, at.creepages.lateral)]
        assert creep[0] == pytest.approx(-shorter / (1.0 - shorter), rel=1e-6)
        assert creep[1] == pytest.approx(0.0, abs=1e-6)
        turning = sign * curvature / (1.0 - shorter)
        # Within a contact angle of some microradians, which the spin of the wheel magnifies.
        assert number(at.creepages.spin) == pytest.approx(turning, abs=1e-5)


def test_mirror_image_of_a_curve():
    part = wheels("S1002", "60E1")
    there = [part.forces(motion(0.02, shift=4e-3, yaw=0.01).seen_from(s)).force for s in SIDES]
    back = [part.forces(motion(-0.02, shift=-4e-3, yaw=-0.01).seen_from(s)).force for s in SIDES]
    for own, other in zip(there, reversed(back), strict=True):
        turned = [number(own[0]), -number(own[1]), number(own[2])]
        assert turned == pytest.approx([number(other[k]) for k in range(3)], rel=1e-12)


def test_rail_that_rises_as_the_wheel_runs_on_presses_like_a_falling_wheel():
    part = wheels("cone:0", "arc:300 mm")
    slope = 1e-3
    level = motion(0.0)
    rising = replace(level, shifts={s: RailPlace(0.0, 0.0, 0.0, slope) for s in SIDES})
    falling = replace(level, velocity=ops.vector(SPEED, 0.0, -slope * SPEED))
    loads = [
        number(part.forces(m.seen_from("left")).patches[0].normal_force)
        for m in (level, rising, falling)
    ]
    assert loads[1] == pytest.approx(loads[0] * (1.0 + 2.0 * slope * SPEED), rel=1e-9)
    assert loads[2] == pytest.approx(loads[1], rel=1e-9)
