"""The sensor of wheel angles on a carrier that is turned by known angles."""

import numpy as np
import pytest

from vehicledyn.multibody import GROUND, Attachment, Body, Joint, ParameterTable, System
from vehicledyn.multibody.elements.wheel_angles import SteeringAxis, WheelAngles
from vehicledyn.multibody.loops.position_level import Positions

RADIUS, TRACK = 0.3, 0.8


def seen(yaw, roll, *, is_left=True, moved=False):
    """Channels of a carrier that is turned about z and then about x."""
    side = 1.0 if is_left else -1.0
    frame = Body("frame", GROUND, (0, 0, 0), (Joint("T1", "x", 5.0), Joint("R3", "turn", 0.7)))
    parent = "frame" if moved else GROUND
    joints = (Joint("R3", "yaw", yaw), Joint("R1", "roll", roll))
    carrier = Body("carrier", parent, (0.0, side * TRACK, RADIUS), joints)
    lower, upper = (Attachment("carrier", (x, 0.0, z)) for x, z in ((0.01, -0.1), (-0.02, 0.1)))
    sensor = WheelAngles(
        "wheel", body="carrier", axis=(0.0, 2.0 * side, 0.0), radius=RADIUS,
        side="left" if is_left else "right", seen_from=parent,
        steering_axis=SteeringAxis(lower, upper),
    )  # fmt: skip
    bodies = (frame, carrier) if moved else (carrier,)
    place = Positions(System("corner", ParameterTable(), bodies, parts=(sensor,)))
    names = [c.name.removeprefix("wheel.") for c in place.channels]
    return dict(zip(names, place.values(place.start), strict=True))


@pytest.mark.parametrize("is_left", [True, False])
def test_signs(is_left):
    side = 1.0 if is_left else -1.0
    steered = seen(0.1, 0.0, is_left=is_left)
    assert steered["steer_angle"] == pytest.approx(0.1, abs=1e-14)
    assert steered["toe_angle"] == pytest.approx(-0.1 * side, abs=1e-14)
    assert steered["camber"] == pytest.approx(0.0, abs=1e-14)
    # Roll turns z towards -y: the top goes to the right, which is inwards on the left.
    leaning = seen(0.0, 0.05, is_left=is_left)
    assert leaning["camber"] == pytest.approx(-0.05 * side, abs=1e-14)
    assert leaning["inclination"] == pytest.approx(-0.05 * side, abs=1e-14)
    assert leaning["half_track"] == pytest.approx(TRACK + side * RADIUS * np.sin(0.05), abs=1e-14)
    assert leaning["contact_z"] == pytest.approx(RADIUS * (1.0 - np.cos(0.05)), abs=1e-14)


def test_camber_is_seen_from_the_front():
    yaw, roll = 0.6, 0.1
    found = seen(yaw, roll)
    assert found["inclination"] == pytest.approx(-roll, abs=1e-14)
    assert np.tan(found["camber"]) == pytest.approx(-np.tan(roll) / np.cos(yaw), rel=1e-13)


def test_steering_axis_moves_with_the_wheel():
    """Trail and offset are measured along the heading: steering does not change them."""
    straight, steered = seen(0.0, 0.0), seen(0.5, 0.0)
    assert straight["caster"] == pytest.approx(np.arctan2(0.03, 0.2), abs=1e-14)
    assert straight["mechanical_trail"] == pytest.approx(0.01 + 0.03, abs=1e-14)
    assert straight["lateral_offset"] == pytest.approx(0.0, abs=1e-14)
    for name in ("mechanical_trail", "lateral_offset", "scrub_radius"):
        assert steered[name] == pytest.approx(straight[name], abs=1e-14)


def test_a_moving_reference_changes_nothing():
    still, moved = seen(0.2, 0.1), seen(0.2, 0.1, moved=True)
    for name in ("steer_angle", "camber", "caster", "half_track", "contact_x", "scrub_radius"):
        assert moved[name] == pytest.approx(still[name], abs=1e-14)
