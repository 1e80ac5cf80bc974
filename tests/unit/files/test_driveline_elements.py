"""Friction couplings and half shafts: energy at random states, sticking, sliding, bad input."""

import numpy as np
import pytest
from system_texts import Motion, equations, problems

from vehicledyn.base.errors import InputError

SYSTEM = """
title: Two flywheels with a friction coupling, and a wheel on a half shaft
gravity: [0, 0, 0]
parameters: {limit: 80 N*m}
bodies:
  one: {joints: [R2 angle], mass: 5 kg, inertia: [0, 0.4 kg*m^2, 0]}
  two: {joints: [R2 angle], mass: 5 kg, inertia: [0, 0.7 kg*m^2, 0]}
  knee: {at: [1 m, 0, 0], joints: [R3 steer], mass: 10 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
  wheel:
    parent: knee
    joints: [R2 spin]
    mass: 20 kg
    inertia: [0.5 kg*m^2, 0.9 kg*m^2, 0.5 kg*m^2]
    spins_about: 2
elements:
  clutch:
    kind: friction_coupling
    coordinate: one.angle
    other: two.angle
    ratio: 1.5
    limit: limit + 5 N*m*s/rad * abs(two.angle_rate)
    stiffness: 2 kN*m/rad
    damping: 3 N*m*s/rad
  engine:
    kind: engine
    coordinate: two.angle
    throttle: 0.3 + 0.2 * one.angle_rate / (1 rad/s)
    speeds: [-5, 0, 4, 9]
    full_torques: [10, 40, 55, 20]
    drag_torques: [0, 0, -6, -9]
  shaft: {kind: half_shaft, shaft: one, wheel: wheel, stiffness: 900 N*m/rad, damping: 4 N*m*s/rad}
"""


@pytest.fixture(scope="module")
def motion(tmp_path_factory):
    return Motion(equations(tmp_path_factory.mktemp("driveline"), SYSTEM))


def _state(seed):
    draw = np.random.default_rng(seed)
    names = ("one.angle_rate", "two.angle_rate", "knee.steer_rate", "wheel.spin_rate")
    state = {name.replace(".", "__"): float(draw.normal(scale=3.0)) for name in names}
    twists = {"clutch__twist": float(draw.normal(scale=0.05)), "shaft__twist": float(draw.normal())}
    return state | twists | {"knee__steer": float(draw.normal())}


@pytest.mark.parametrize("seed", range(8))
def test_power_is_growth_of_stored_energy_and_a_loss(motion, seed):
    """d(kinetic)/dt + d(stored)/dt = -loss, with the loss of each element by its own formula."""
    state = _state(seed)
    seen = motion.at(**state)
    one, two, spin = (state[f"{n}_rate"] for n in ("one__angle", "two__angle", "wheel__spin"))
    kinetic = 0.4 * one * seen["d.one.angle_rate"] + 0.7 * two * seen["d.two.angle_rate"]
    kinetic += 0.9 * spin * seen["d.wheel.spin_rate"]
    kinetic += (1.0 + 0.5) * state["knee__steer_rate"] * seen["d.knee.steer_rate"]
    slide, twist = one - 1.5 * two, state["clutch__twist"]
    most = 80.0 + 5.0 * abs(two)
    stuck = float(np.clip(twist, -most / 2e3, most / 2e3))
    torque = float(np.clip(2e3 * twist + 3.0 * slide, -most, most))
    stored = 2e3 * stuck * seen["d.clutch.twist"]
    loss = torque * slide - stored
    lag = one - spin
    assert seen["clutch.torque"] == pytest.approx(torque, rel=1e-12)
    assert loss >= -1e-12
    stored += 900.0 * state["shaft__twist"] * seen["d.shaft.twist"]
    loss += 4.0 * lag**2
    size = abs(kinetic) + abs(stored) + loss
    throttle = np.clip(0.3 + 0.2 * one, 0.0, 1.0)
    full = np.interp(two, [-5, 0, 4, 9], [10, 40, 55, 20])
    drag = np.interp(two, [-5, 0, 4, 9], [0, 0, -6, -9])
    power = (throttle * full + (1.0 - throttle) * drag) * two
    assert seen["engine.power"] == pytest.approx(power, rel=1e-12)
    assert kinetic + stored + loss == pytest.approx(power, abs=1e-9 * (size + abs(power)))


def test_a_stuck_coupling_is_a_spring_that_keeps_its_twist(motion):
    seen = motion.at(clutch__twist=0.02, one__angle_rate=0.0)
    assert seen["clutch.torque"] == pytest.approx(40.0, rel=1e-12)
    assert seen["d.clutch.twist"] == 0.0


def test_a_sliding_coupling_has_its_limit_against_the_motion(motion):
    seen = motion.at(clutch__twist=0.2, one__angle_rate=7.0)
    assert seen["clutch.torque"] == pytest.approx(80.0, rel=1e-12)
    assert seen["clutch.power"] == pytest.approx(560.0, rel=1e-12)


def test_stiffness_must_be_positive(tmp_path):
    text = SYSTEM.replace("stiffness: 2 kN*m/rad", "stiffness: 0 N*m/rad")
    assert any("elements.clutch.stiffness" in problem for problem in problems(tmp_path, text))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("speeds: [-5, 0, 4, 9]", "speeds: [-5, 4, 0, 9]", "speeds of the map do not grow"),
        ("speeds: [-5, 0, 4, 9]", "speeds: [-5, 0, 4]", "3 speeds and 4 values"),
        ("full_torques: [10, 40, 55, 20]", "full_torques: []", "0 values of 'full_torques'"),
        ("full_torques: [10, 40, 55, 20]", "full_torques: [10, .nan, 55, 20]", "a finite number"),
    ],
)
def test_a_map_is_a_function_of_the_speed(tmp_path, old, new, words):
    with pytest.raises(InputError, match=words):
        equations(tmp_path, SYSTEM.replace(old, new))
