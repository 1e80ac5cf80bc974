"""Torsion bar, assistance by a map, universal joints and free control of steerings."""

from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError
from system_texts import Motion, equations

from vehicledyn.base.errors import InputError
from vehicledyn.files.building.construct import build_system, build_vehicle
from vehicledyn.files.building.road_choice import RoadChoice
from vehicledyn.files.system.read import read_system
from vehicledyn.multibody import derive
from vehicledyn.road.manoeuvres.kinds.recorded.open_loop import OpenLoop

SYSTEMS = Path(__file__).parents[3] / "systems"
MAP = """
    torques: [0, 2, 5]
    speeds: [0, 20]
    assistance: [0, 6, 30,  0, 2, 9]
"""
SYSTEM = f"""
title: A column on a pinion with torsion bar and assistance
gravity: [0, 0, 0]
bodies:
  column: {{joints: [R1 angle], mass: 5 kg, inertia: [0.04 kg*m^2, 0, 0]}}
  pinion: {{joints: [R1 angle], mass: 5 kg, inertia: [0.02 kg*m^2, 0, 0]}}
  car: {{joints: [T1 x], mass: 100 kg}}
elements:
  bar:
    kind: torsion_bar
    coordinate: column.angle
    other: pinion.angle
    stiffness: 90 N*m/rad
    damping: 0.4 N*m*s/rad
  motor:
    kind: power_assistance
    coordinate: pinion.angle
    torque: 90 N*m/rad * (column.angle - pinion.angle)
    speed: car.x_rate
    damping: 0.3 N*m*s/rad{MAP}
"""
TORQUES, SPEEDS = [0.0, 2.0, 5.0], [0.0, 20.0]
ROWS = [[0.0, 6.0, 30.0], [0.0, 2.0, 9.0]]


def assisted(torque, speed):
    """Return the map by hand: linear in the torque, then in the speed."""
    each = [np.interp(abs(torque), TORQUES, row) for row in ROWS]
    return float(np.sign(torque) * np.interp(abs(speed), SPEEDS, each))


@pytest.fixture(scope="module")
def motion(tmp_path_factory):
    return Motion(equations(tmp_path_factory.mktemp("steering"), SYSTEM))


@pytest.mark.parametrize("seed", range(8))
def test_power_is_growth_of_energy_a_loss_and_what_the_motor_gives(motion, seed):
    draw = np.random.default_rng(seed)
    names = ("column.angle", "column.angle_rate", "pinion.angle", "pinion.angle_rate")
    state = {n.replace(".", "__"): float(draw.normal(scale=0.05)) for n in names}
    speed = float(draw.normal(scale=20.0))
    seen = motion.at(**state, car__x_rate=speed)
    turns, rates = (
        [state[f"{n}__angle{end}"] for n in ("column", "pinion")] for end in ("", "_rate")
    )
    twist, lag = turns[0] - turns[1], rates[0] - rates[1]
    kinetic = 0.04 * rates[0] * seen["d.column.angle_rate"]
    kinetic += 0.02 * rates[1] * seen["d.pinion.angle_rate"]
    stored, loss = 90.0 * twist * lag, 0.4 * lag**2
    motor = (assisted(90.0 * twist, speed) - 0.3 * rates[1]) * rates[1]
    size = abs(kinetic) + abs(stored) + loss + abs(motor)
    assert seen["bar.energy"] == pytest.approx(45.0 * twist**2, rel=1e-12)
    assert seen["motor.power"] == pytest.approx(motor, rel=1e-12)
    assert kinetic + stored + loss == pytest.approx(motor, abs=1e-9 * size)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("torques: [0, 2, 5]", "torques: [0, 5, 2]", "torques: do not grow: 2 N"),
        ("torques: [0, 2, 5]", "torques: [1, 2, 5]", "they must begin at 0"),
        ("speeds: [0, 20]", "speeds: [0]", "1 speeds, 3 torques and 6 values"),
        ("[0, 6, 30,  0, 2, 9]", "[0, 6, 30,  1, 2, 9]", "1 N.m at 20 m/s without torque"),
        ("[0, 6, 30,  0, 2, 9]", "[0, 6, 30,  0, -2, 9]", "holds -2 N.m at 20 m/s"),
    ],
)
def test_a_map_is_a_function_of_torque_and_speed(tmp_path, old, new, words):
    with pytest.raises(InputError, match=words):
        equations(tmp_path, SYSTEM.replace(old, new))


class Steering:
    """The library's steering with its hands held at an arc, as slowly as if they stood still."""

    def __init__(self, arc, **parameters):
        given = {**parameters, "test": {"amplitude": f"{arc} m", "frequency": "1e-7 Hz"}}
        model, problems = read_system(SYSTEMS / "power_steering.yaml", {"parameters": given})
        assert not problems
        self.parameters = model.resolved
        self._motion = Motion(derive(build_system(model)))

    def at(self, pinion, time=2.5e6):
        return self._motion.at(time, pinion__angle=pinion)


@pytest.mark.parametrize("arc", [0.005, -0.02])
def test_hand_torque_over_rack_force_is_that_of_the_map(arc):
    """T + A(T) = K r² p with T = k (θ - p): on the line A = a + b |T| p follows in closed form."""
    steering = Steering(arc)
    p = steering.parameters
    radius, bar, spring = (p[n] for n in ("pinion.radius", "bar.stiffness", "test.stiffness"))
    speed = p["rolling_radius"] * p["test.wheel_speed"]
    torques, first = np.array([0.0, 0.5, 2.0, 4.0, 6.0, 8.0]), [0.0, 0.4, 7.0, 22.0, 42.0, 55.0]
    second = [0.0, 0.3, 4.0, 13.0, 28.0, 42.0]
    row = np.array(first) + (speed - 5.0) / 9.0 * (np.array(second) - np.array(first))
    angle = abs(arc) / p["rim.radius"]
    for k in range(5):
        slope = (row[k + 1] - row[k]) / (torques[k + 1] - torques[k])
        rest = row[k] - slope * torques[k]
        stiff = (1.0 + slope) * bar
        turned = (stiff * angle + rest) / (stiff + spring * radius**2)
        torque = bar * (angle - turned)
        if torques[k] <= torque <= torques[k + 1]:
            break
    else:
        raise AssertionError("no line of the map holds the torque")
    side = np.sign(arc)
    seen = steering.at(side * turned)
    assert seen["d.pinion.angle_rate"] == pytest.approx(0.0, abs=1e-7)
    assert seen["bar.twist"] == pytest.approx(side * torque / bar, rel=1e-9)
    assert seen["hands.torque"] == pytest.approx(side * torque, rel=1e-9)
    force = -seen["load.force"]
    assisted_force = (1.0 + np.interp(torque, torques, row) / torque) * torque / radius
    assert side * force == pytest.approx(assisted_force, rel=1e-9)


def test_a_universal_joint_turns_unevenly_and_two_alike_evenly():
    """ω_2/ω_1 = cos β/(1 - sin² β cos² θ), by the joint's own turn θ; equal bends cancel."""
    bend, phase = 0.6, 0.7
    bends = {"upper": f"{bend} rad", "lower": f"{bend} rad", "phase": f"{phase} rad"}
    seen = Steering(0.2, bend=bends).at(0.0, time=1.1e6)
    turn = seen["wheel.angle"] + phase
    wanted = np.cos(bend) / (1.0 - np.sin(bend) ** 2 * np.cos(turn) ** 2)
    assert 0.5 < seen["wheel.angle"] < 1.0
    ratio = seen["intermediate.angle_rate"] / seen["wheel.angle_rate"]
    assert ratio == pytest.approx(wanted, rel=1e-10)
    assert seen["input.angle"] == pytest.approx(seen["wheel.angle"], abs=1e-12)


def test_torques_of_the_hands_move_a_free_steering_wheel():
    """The power of the hands is torque times the rate of the steering wheel."""
    model, problems = read_system(SYSTEMS / "small_car.yaml")
    assert not problems
    vehicle = build_vehicle(model, RoadChoice(free_wheels=True))
    per_rack = vehicle.worth(vehicle.steering_gain * vehicle.steering_ratio)
    test = OpenLoop(times=(0.0, 1.0), hand_torques=(0.0, 4.0))
    motion = Motion(derive(test.fit(vehicle).system))
    state = {f"{vehicle.rack}_rate".replace(".", "__"): 0.3}
    none, some = (motion.at(time, **state)["power.forces"] for time in (0.0, 1.0))
    assert some - none == pytest.approx(4.0 * 0.3 * per_rack, rel=1e-9)


def test_a_steering_wheel_has_angles_or_torques():
    with pytest.raises(ValidationError, match="has angles already"):
        OpenLoop(**{"times": [0.0], "angles": [0.1], "hand_torques": [1.0]})
