"""The tractor with semitrailer against levers, the geometry of off-tracking and two planar bodies.

The planar model has the masses, yaw inertias and axle places of the source of the parameters and
tyres of 5.5 times their load per radian; levers give the loads.
"""

from pathlib import Path

import numpy as np

import vehicledyn as vd
from reference_cases.comparison import figure

ROOT = Path(__file__).parents[3]
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


def rows():
    """Yield static axle loads and the planar oscillation."""
    found = vd.equilibrium(SYSTEM)
    loads = [
        sum(float(found[f"{n}_axle.wheel_{s}.tyre.normal_force"].values) for s in ("left", "right"))
        for n in NAMES
    ]
    groups = [loads[0], sum(loads[1:3]), sum(loads[3:])]
    words = ("front axle", "drive and tag axle", "trailer's axles")
    weight = (TRACTOR + TRAILER) * GRAVITY / 1e3
    yield figure(
        "weight", "semitrailer: load of all axles", reference=weight, computed=sum(groups) / 1e3,
        band=1e-3, unit="kN",
    )  # fmt: skip
    for name, wanted, got in zip(words, lever_loads(), groups, strict=True):
        yield figure(
            "levers by hand", f"semitrailer: load of {name}",
            reference=wanted / 1e3, computed=got / 1e3, band=round(0.01 * wanted / 1e3, 1),
            unit="kN",
        )  # fmt: skip
    # Centres of mass and fifth wheel at the height of the roll axis leave roll alone.
    heights = ("tractor.height", "trailer.height", "fifth_wheel.height")
    modes = vd.modes(SYSTEM, speed=[SPEED], set=dict.fromkeys(heights, "0.5 m"))
    eigenvalues = np.asarray(modes["eigenvalue"])[0]
    planar = [v for v in planar_eigenvalues(SPEED) if v.imag >= 0.0]
    first, second, pair = sorted(planar, key=lambda v: (v.imag, v.real))
    found_pair = eigenvalues[np.argmin(np.abs(eigenvalues - pair))]
    near = [eigenvalues[np.argmin(abs(eigenvalues - v))] for v in (first, second)]
    for name, wanted, got, share in (
        ("yaw oscillation, real part", pair.real, found_pair.real, 5e-3),
        ("yaw oscillation, imaginary part", pair.imag, found_pair.imag, 5e-3),
        ("sum of the real eigenvalues", (first + second).real, sum(near).real, 1e-2),
        ("their product (1/s^2)", (first * second).real, (near[0] * near[1]).real, 1e-2),
    ):
        yield figure(
            "two planar bodies", f"semitrailer at {SPEED:g} m/s without roll: {name}",
            reference=wanted, computed=got, band=round(share * abs(wanted), 3) or 0.005, unit="1/s",
        )  # fmt: skip
