"""Bushings against forces worked out with rotation matrices, and as internal forces."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from system_texts import Motion, equations

SYSTEM = """
title: Two bodies in space
gravity: [0, 0, 0]
bodies:
  one: {joints: [free], mass: 2 kg, inertia: [0.3 kg*m^2, 0.4 kg*m^2, 0.5 kg*m^2]}
  two: {joints: [free], mass: 3 kg, com: [0.1 m, 0, 0], inertia: [0.6 kg*m^2, 0.5 kg*m^2,
        0.4 kg*m^2]}
bushings:
  block:
    a: {body: one, point: [0.2 m, -0.1 m, 0.3 m]}
    b: {body: two, point: [-0.3 m, 0.2 m, 0.1 m]}
    stiffness: [1 kN/m, 2 kN/m, 3 kN/m]
    damping: [10 N*s/m, 20 N*s/m, 30 N*s/m]
    turning_stiffness: [7 N*m/rad, 8 N*m/rad, 9 N*m/rad]
    turning_damping: [0.7 N*m*s/rad, 0, 0.9 N*m*s/rad]
    preload: [5 N, 6 N, 7 N]
    offset: [0.05 m, 0, -0.1 m]
sensors:
  first: {kind: point, body: one, shows: [position, velocity, acceleration]}
  second: {kind: point, body: two, point: [0.1 m, 0, 0], shows: [position, velocity, acceleration]}
"""
NAMES = ("x", "y", "z", "yaw", "pitch", "roll")
A, B = np.array([0.2, -0.1, 0.3]), np.array([-0.3, 0.2, 0.1])


def _state(seed):
    draw = np.random.default_rng(seed)
    return {
        f"{body}__{name}{tail}": float(draw.normal(scale=0.4))
        for body in ("one", "two")
        for name in NAMES
        for tail in ("", "_rate")
    }


def _pose(state, body):
    place = np.array([state[f"{body}__{n}"] for n in "xyz"])
    angles = [state[f"{body}__{n}"] for n in ("yaw", "pitch", "roll")]
    return place, Rotation.from_euler("ZYX", angles).as_matrix()


def _moved(state, step):
    return {
        name: value + step * state.get(f"{name}_rate", 0.0) if not name.endswith("_rate") else value
        for name, value in state.items()
    }


def _deflection_and_turn(state):
    (place_a, turn_a), (place_b, turn_b) = _pose(state, "one"), _pose(state, "two")
    deflection = turn_a.T @ (place_b + turn_b @ B - place_a) - A - [0.05, 0.0, -0.1]
    skew = turn_a.T @ turn_b
    skew = 0.5 * (skew - skew.T)
    return deflection, np.array([skew[2, 1], skew[0, 2], skew[1, 0]])


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_force_and_torque_are_those_of_the_relative_motion(tmp_path, seed):
    state, step = _state(seed), 1e-6
    seen = Motion(equations(tmp_path, SYSTEM)).at(**state)
    deflection, turn = _deflection_and_turn(state)
    after = _deflection_and_turn(_moved(state, step))
    before = _deflection_and_turn(_moved(state, -step))
    rates = [(x - y) / (2.0 * step) for x, y in zip(after, before, strict=True)]
    force = [5.0, 6.0, 7.0] - np.array([1e3, 2e3, 3e3]) * deflection
    force -= np.array([10.0, 20.0, 30.0]) * rates[0]
    torque = -np.array([7.0, 8.0, 9.0]) * turn - np.array([0.7, 0.0, 0.9]) * rates[1]
    assert [seen[f"block.force_{k}"] for k in "xyz"] == pytest.approx(force, rel=1e-7, abs=1e-6)
    assert [seen[f"block.torque_{k}"] for k in "xyz"] == pytest.approx(torque, rel=1e-7, abs=1e-8)
    assert [seen[f"block.deflection_{k}"] for k in "xyz"] == pytest.approx(deflection, abs=1e-12)


@pytest.mark.parametrize("seed", [4, 5])
def test_the_pair_moves_neither_the_centre_of_mass_nor_turns_the_whole(tmp_path, seed):
    state, step = _state(seed), 1e-5
    motion = Motion(equations(tmp_path, SYSTEM))
    seen = motion.at(**state)
    push = [
        2.0 * seen[f"first.acceleration_{k}"] + 3.0 * seen[f"second.acceleration_{k}"]
        for k in "xyz"
    ]
    assert push == pytest.approx(np.zeros(3), abs=1e-9)

    def angular_momentum(sign):
        moved = {
            name: value + sign * step * seen[f"d.{name.replace('__', '.')}"]
            for name, value in state.items()
        }
        total = np.zeros(3)
        at = motion.at(**moved)
        for body, sensor, mass, inertia in (
            ("one", "first", 2.0, (0.3, 0.4, 0.5)),
            ("two", "second", 3.0, (0.6, 0.5, 0.4)),
        ):
            _, turn = _pose(moved, body)
            rate = (
                _pose(_moved(moved, 1e-6), body)[1] - _pose(_moved(moved, -1e-6), body)[1]
            ) / 2e-6
            spin = turn.T @ rate
            omega = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
            where, velocity = (
                np.array([at[f"{sensor}.{what}{k}"] for k in "xyz"]) for what in ("", "velocity_")
            )
            total += turn @ (np.array(inertia) * omega) + mass * np.cross(where, velocity)
        return total

    change = (angular_momentum(1.0) - angular_momentum(-1.0)) / (2.0 * step)
    assert change == pytest.approx(np.zeros(3), abs=1e-4)
