"""The motorcycle's eigenvalues against linear equations written down in world coordinates.

Lateral place of the rear contact, yaw, roll and steer, as in Sharp's model of 1971: accelerations
have no Coriolis terms there, since the motion is straight; the potential energy is that of Meijaard
et al. (2007), eq. A 22; side slip with relaxation and camber thrust in place of rolling.
"""

from pathlib import Path

import numpy as np

import vehicledyn as vd
from reference_cases.comparison import figure

SCENARIO = Path(__file__).parents[3] / "scenarios" / "systems" / "motorcycle.yaml"
GRAVITY, RELAXATION = 9.81, 0.135
WHEELBASE, TRAIL, CASTER = 1.448, 0.105, np.radians(26.8)
SINE, COSINE = np.sin(CASTER), np.cos(CASTER)
MASS, AHEAD, HEIGHT, ROLL, YAW, PRODUCT = 270.0, 0.688, 0.64, 35.5, 59.3, -1.7
FRONT, OFFSET, FRONT_HEIGHT, FRONT_ROLL, FRONT_YAW = 34.0, 0.025, 0.6, 2.0, 0.83
DAMPER = 1.0


def linear(speed, roll_gain=0.0, rate_gain=0.0):
    """Return eigenvalues of y, ψ, φ, δ and the deflections of both contact patches."""
    front = WHEELBASE + (TRAIL + OFFSET) / COSINE - FRONT_HEIGHT * np.tan(CASTER)
    tilt, turn = np.array([0.0, 0.0, 1.0, -SINE]), np.array([0.0, 1.0, 0.0, COSINE])
    # Of the whole with the steering locked; its last row and column are the front's.
    locked = MASS * np.outer(*[np.array([1.0, AHEAD, -HEIGHT, 0.0])] * 2)
    locked[1, 1] += YAW
    locked[2, 2] += ROLL
    locked[1, 2] += PRODUCT
    locked[2, 1] += PRODUCT
    way = np.array([1.0, front, -FRONT_HEIGHT, OFFSET])
    full = (
        FRONT * np.outer(way, way)
        + FRONT_ROLL * np.outer(tilt, tilt)
        + FRONT_YAW * np.outer(turn, turn)
    )
    mass = locked.copy()
    mass[3, :], mass[:, 3] = full[3, :], full[:, 3]
    gyration = np.zeros((4, 4))
    rear_spin, front_spin = 0.8 * speed / 0.299, 0.6 * speed / 0.294
    for spin, roll, yaw in (
        (rear_spin, np.eye(4)[2], np.eye(4)[1]),
        (front_spin, tilt, turn),
    ):
        gyration += spin * (np.outer(yaw, roll) - np.outer(roll, yaw))
    gyration[3, 3] += DAMPER
    gyration[3, 2] += rate_gain
    lever = FRONT * OFFSET + TRAIL * AHEAD / WHEELBASE * MASS
    stiffness = np.zeros((4, 4))
    stiffness[2, 2] = -MASS * HEIGHT * GRAVITY
    stiffness[2, 3] = stiffness[3, 2] = GRAVITY * lever
    stiffness[3, 3] = -GRAVITY * lever * SINE
    stiffness[3, 2] += roll_gain
    loads = MASS * GRAVITY * np.array([1.0 - AHEAD / WHEELBASE, AHEAD / WHEELBASE])
    contacts = np.array([[1.0, 0.0, 0.0, 0.0], [1.0, WHEELBASE, 0.0, -TRAIL]])
    headings = np.array([[0.0, 1.0, 0.0, 0.0], turn])
    tilts = np.array([[0.0, 0.0, 1.0, 0.0], tilt])
    matrix = np.zeros((10, 10))
    matrix[:4, 4:8] = np.eye(4)
    inverse = np.linalg.inv(mass)
    matrix[4:8, :4], matrix[4:8, 4:8] = -inverse @ stiffness, -inverse @ gyration
    for k, (cornering, camber) in enumerate(((14.5, 0.95), (16.0, 0.85))):
        matrix[8 + k, 4:8] = contacts[k]
        matrix[8 + k, :4] = -speed * headings[k]
        matrix[8 + k, 8 + k] = -speed / RELAXATION
        push = inverse @ contacts[k] * loads[k]
        matrix[4:8, 8 + k] -= cornering / RELAXATION * push
        matrix[4:8, :4] -= camber * np.outer(push, tilts[k])
    return np.linalg.eigvals(matrix)


def modes(speed, **gains):
    """Return the eigenvalues of the system, on tyres too stiff to sink in."""
    rider = {"roll": "0 N*m/rad", "rate": "0 N*m*s/rad", "speed": "0 N*m*s/rad", **gains}
    changes = {f"rider.{name}": value for name, value in rider.items()}
    changes |= {
        "forward_speed": f"{speed} m/s",
        "tyre.stiffness": "5 MN/m",
        "initial.frame.z": "0.298722 m",
        "initial.frame.pitch": "-1.8e-5 rad",
        "initial.rear_wheel.spin_rate": f"{speed / 0.299} rad/s",
        "initial.front_wheel.spin_rate": f"{speed / 0.294} rad/s",
    }
    return np.asarray(vd.modes(SCENARIO, start="nominal", set=changes)["eigenvalue"])[0]


def rows(speed=20.0):
    """Yield wobble, weave and capsize without the rider."""
    found = modes(speed)
    slow = [v for v in linear(speed) if v.imag >= 0.0 and 1e-6 < abs(v) < 100.0]
    for value in sorted(slow, key=lambda v: (v.imag, v.real)):
        near = found[np.argmin(np.abs(found - value))]
        name = "capsize, growth" if value.imag == 0.0 and value.real > 0.0 else "decay"
        if value.imag > 0.0:
            name = "wobble" if value.imag > _WOBBLE else "weave"
        for part, wanted, got in (
            ("real", value.real, near.real),
            ("imaginary", value.imag, near.imag),
        ):
            if wanted == 0.0 or name == "decay":
                continue
            yield figure(
                "linear equations by hand (Sharp 1971, Meijaard et al. 2007)",
                f"motorcycle at {speed:g} m/s: {name}, {part} part of the eigenvalue",
                reference=wanted, computed=got, band=round(2e-3 + 1e-3 * abs(value), 3), unit="1/s",
            )  # fmt: skip


_WOBBLE = 30.0
"""Imaginary part above which an oscillation is the wobble of the fork [1/s]."""
