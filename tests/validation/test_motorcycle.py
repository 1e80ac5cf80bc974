"""The motorcycle's eigenvalues against linear equations written down in world coordinates.

Lateral place of the rear contact, yaw, roll and steer, as in Sharp's model of 1971: accelerations
have no Coriolis terms there, since the motion is straight; the potential energy is that of Meijaard
et al. (2007), eq. A 22; side slip with relaxation and camber thrust in place of rolling.
"""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd

pytestmark = [pytest.mark.validation, pytest.mark.long]

SCENARIO = Path(__file__).parents[2] / "scenarios" / "systems" / "motorcycle.yaml"
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


@pytest.mark.parametrize("speed", [10.0, 20.0, 40.0])
def test_weave_wobble_and_capsize_without_the_rider(speed):
    found = modes(speed)
    wanted = [v for v in linear(speed) if abs(v) > 1e-6 and v.imag >= 0.0]
    for value in wanted:
        assert np.abs(found - value).min() < 1e-3 * abs(value) + 2e-3, value


def test_the_rider_steers_into_the_fall_and_holds_the_motorcycle_up():
    """Without the rider it capsizes at 20 m/s; the gains of the file make every mode decay."""
    assert linear(20.0).real.max() > 0.05
    held = linear(20.0, 100.0, 5.0)
    found = modes(20.0, roll="100 N*m/rad", rate="5 N*m*s/rad")
    for value in held[(np.abs(held) > 1e-6) & (held.imag >= 0.0)]:
        assert value.real < -1.0
        assert np.abs(found - value).min() < 1e-3 * abs(value) + 2e-3, value


def test_a_steady_turn_takes_its_lean():
    """Moments about the line of contact: m g h tan φ = v r (m h + Σ I/R), with the wheels' spin."""
    run = vd.simulate(SCENARIO)
    roll, turn = (float(np.asarray(run[f"frame.{n}"])[-1]) for n in ("roll", "yaw_rate"))
    along, across = (float(np.asarray(run[f"frame.{n}_rate"])[-1]) for n in "xy")
    spin = 0.8 / 0.299 + 0.6 / 0.294
    speed = np.hypot(along, across)
    assert roll > 0.1
    moment = MASS * HEIGHT + spin
    assert np.tan(roll) == pytest.approx(
        -turn * speed * moment / (GRAVITY * MASS * HEIGHT), rel=2e-2
    )
