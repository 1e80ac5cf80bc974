"""The tractor with semitrailer against levers, the geometry of off-tracking and two planar bodies.

The planar model has the masses, yaw inertias and axle places of the source of the parameters and
tyres of 5.5 times their load per radian; levers give the loads.
"""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd

pytestmark = [pytest.mark.validation, pytest.mark.long]

ROOT = Path(__file__).parents[2]
SYSTEM = str(ROOT / "systems" / "tractor_semitrailer.yaml")
SCENARIO = ROOT / "scenarios" / "systems" / "tractor_semitrailer.yaml"
GRAVITY, CORNERING = 9.81, 5.5
TRACTOR, TRACTOR_YAW, TRAILER, TRAILER_YAW = 9841.0, 29910.0, 33101.0, 573480.0
FRONT, REAR, FIFTH_WHEEL = 1.3647, np.array([-1.6353, -3.0053]), -2.0353
COM, AXLES = -4.3344, np.array([-6.4, -7.7, -9.0])
SPEED = 20.0
NAMES = ("front", "drive", "tag", "first", "second", "third")


def lever_loads():
    """Return the loads of front axle, tractor's rear group and trailer's group [N]."""
    trailer = TRAILER * COM / AXLES.mean()
    king_pin = TRAILER - trailer
    rear = (TRACTOR * FRONT + king_pin * (FRONT - FIFTH_WHEEL)) / (FRONT - REAR.mean())
    return GRAVITY * np.array([TRACTOR + king_pin - rear, rear, trailer])


def test_static_axle_loads_are_those_of_levers():
    found = vd.equilibrium(SYSTEM)
    loads = [
        sum(float(found[f"{n}_axle.wheel_{s}.tyre.normal_force"].values) for s in ("left", "right"))
        for n in NAMES
    ]
    groups = [loads[0], sum(loads[1:3]), sum(loads[3:])]
    assert sum(groups) == pytest.approx((TRACTOR + TRAILER) * GRAVITY, rel=1e-6)
    assert groups == pytest.approx(lever_loads(), rel=1e-2)


def test_off_tracking_of_a_slow_turn():
    """The axles roll as one at Σ x²/Σ x, so that the articulation angle is its arcsine over R.

    The slip that the lateral acceleration takes, a/(g C/F), turns the trailer back.
    """
    run = vd.simulate(SCENARIO)
    names = ("tractor.x_rate", "tractor.y_rate", "tractor.yaw_rate", "tractor.yaw", "trailer.yaw")
    along, sideways, turn, yaw, articulation = (float(np.asarray(run[n])[-1]) for n in names)
    heading = np.array([np.cos(yaw), np.sin(yaw)])
    across = np.array([-heading[1], heading[0]])
    velocity = np.array([along, sideways]) + turn * FIFTH_WHEEL * across
    radius = np.hypot(*velocity) / turn
    length = (AXLES**2).sum() / -AXLES.sum()
    direction = np.arctan2(velocity @ across, velocity @ heading)
    slip = turn * np.hypot(*velocity) / (GRAVITY * CORNERING)
    assert direction - articulation == pytest.approx(np.arcsin(length / radius) - slip, rel=1e-2)


def planar_eigenvalues(speed):
    """Return those of lateral speed, yaw rate, articulation rate and articulation angle."""
    front, rear, trailer = lever_loads()
    stiffness = CORNERING * np.array([front, *[rear / 2] * 2, *[trailer / 3] * 3])
    to_axles = [(1.0, x, 0.0) for x in (FRONT, *REAR)]
    to_axles += [(1.0, FIFTH_WHEEL + x, x) for x in AXLES]
    moving = np.array([(1.0, 0.0, 0.0), (1.0, FIFTH_WHEEL + COM, COM)])
    turning = np.array([(0.0, 1.0, 0.0), (0.0, 1.0, 1.0)])
    mass, damping, spring = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros(3)
    for m, inertia, way, turn in zip(
        (TRACTOR, TRAILER), (TRACTOR_YAW, TRAILER_YAW), moving, turning, strict=True
    ):
        mass += m * np.outer(way, way) + inertia * np.outer(turn, turn)
        damping[:, 1] += m * speed * way
    for k, (c, way) in enumerate(zip(stiffness, np.array(to_axles), strict=True)):
        damping += c / speed * np.outer(way, way)
        spring -= c * way * (k >= 3)
    matrix = np.zeros((4, 4))
    matrix[:3, :3] = -np.linalg.solve(mass, damping)
    matrix[:3, 3] = -np.linalg.solve(mass, spring)
    matrix[3, 2] = 1.0
    return np.linalg.eigvals(matrix)


def test_eigenvalues_without_roll_are_those_of_two_planar_bodies():
    """Centres of mass and fifth wheel at the height of the roll axis leave roll alone.

    The real ones are close together, so their sum and product are compared.
    """
    names = ("tractor.height", "trailer.height", "fifth_wheel.height")
    found = vd.modes(SYSTEM, speed=[SPEED], set=dict.fromkeys(names, "0.5 m"))
    eigenvalues = np.asarray(found["eigenvalue"])[0]
    first, second, pair = sorted(
        (v for v in planar_eigenvalues(SPEED) if v.imag >= 0.0), key=lambda v: (v.imag, v.real)
    )
    assert np.abs(eigenvalues - pair).min() < 5e-3 * abs(pair)
    near = [eigenvalues[np.argmin(abs(eigenvalues - v))] for v in (first, second)]
    assert sum(near) == pytest.approx(first + second, rel=1e-2)
    assert near[0] * near[1] == pytest.approx(first * second, rel=1e-2)
