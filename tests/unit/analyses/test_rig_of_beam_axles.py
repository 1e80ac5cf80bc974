"""Twist beams and solid axles on coil springs at the rig, against closed geometry."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd

pytestmark = pytest.mark.long

SYSTEMS = Path(__file__).parents[3] / "systems"
TRAVEL = np.array([-0.04, 0.0, 0.04])


def _rig(axle, test, values):
    data = vd.rig(str(SYSTEMS / f"{axle}.yaml"), test, values)
    return {
        name: np.asarray(data[f"left_wheel_angles.{name}"])
        for name in ("toe_angle", "camber", "half_track", "load")
    } | ({"wheel_rate": np.asarray(data["left_wheel_angles.wheel_rate"]),
          "recession": np.asarray(data["left_wheel_angles.recession"])} if test == "parallel" else {
          "roll_camber": np.asarray(data["left_wheel_angles.roll_camber"]),
          "roll_steer": np.asarray(data["left_wheel_angles.roll_steer"])})  # fmt: skip


def test_a_solid_axle_travels_upright_at_the_rate_of_its_springs():
    seen = _rig("coil_spring_axle", "parallel", "-40 mm:40 mm:2")
    assert seen["camber"] == pytest.approx(0.0, abs=1e-9)
    assert seen["toe_angle"] == pytest.approx(0.0, abs=1e-9)
    assert seen["wheel_rate"] == pytest.approx(40e3, rel=1e-6)
    weight = (120.0 / 2.0 + 28.0) * 9.81
    assert seen["load"] == pytest.approx(5400.0 + weight + 40e3 * TRAVEL, rel=1e-3)


def test_a_solid_axle_keeps_its_wheels_upright_on_the_road_in_roll():
    seen = _rig("coil_spring_axle", "roll", "-1 deg:1 deg:2")
    assert seen["roll_camber"][1] == pytest.approx(-1.0, rel=1e-6)
    assert seen["roll_steer"][1] == pytest.approx(0.0, abs=1e-9)


def test_a_twist_beam_in_parallel_travel_is_a_trailing_arm():
    seen = _rig("twist_beam_axle", "parallel", "-40 mm:40 mm:2")
    length = 0.42
    assert seen["camber"] == pytest.approx(0.0, abs=1e-9)
    slope = TRAVEL / np.sqrt(length**2 - TRAVEL**2)
    assert seen["recession"] == pytest.approx(slope, abs=1e-6)
    assert seen["wheel_rate"][1] == pytest.approx(4500.0 / length**2, rel=1e-6)


def test_a_twist_beam_in_roll_is_a_semi_trailing_arm():
    """Each arm turns about the line a from its bushing to the shear centre: a = (sin h, cos h, 0).

    A turn of 1 moves the wheel by L cos h + e sin h upwards and gives it the camber sin h.
    """
    seen = _rig("twist_beam_axle", "roll", "-1 deg:1 deg:2")
    heading, length, inset, half_track = np.radians(17.0), 0.42, 0.15, 0.75
    lift = length * np.cos(heading) + inset * np.sin(heading)
    wanted = -half_track * np.sin(heading) / lift
    assert seen["roll_camber"][1] == pytest.approx(wanted, rel=1e-6)
    assert seen["roll_steer"][1] == pytest.approx(0.0, abs=1e-9)
    gain = (seen["load"][2] - seen["load"][0]) / np.radians(2.0)
    turn = (4000.0 + 4500.0) * half_track / lift**2
    assert abs(gain) == pytest.approx(turn, rel=2e-2)
