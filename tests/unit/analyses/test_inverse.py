"""Inverse dynamics along a motion."""

import numpy as np
import pytest

from vehicledyn.analyses.mechanism.inverse import channel_rows
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, RodCut, System
from vehicledyn.multibody.equations.inverse_dynamics import derive_inverse
from vehicledyn.symbolic import ops

TIMES = np.linspace(0.0, 1.0, 5)
MASS, ARM, GRAVITY = 2.0, 0.7, 9.81


def pendulum():
    """A mass on a massless arm that turns about y from hanging down."""
    body = Body("bob", GROUND, (0, 0, 0), (Joint("R2", "angle"),), mass=MASS, com=(0.0, 0.0, -ARM))
    return System("pendulum", ParameterTable(), (body,), gravity=(0.0, 0.0, -GRAVITY))


def swing():
    angle = np.sin(2.0 * TIMES)
    rows = (angle, 2.0 * np.cos(2.0 * TIMES), -4.0 * angle)
    return [row[:, None] for row in rows]


def inverse_dynamics(system, *motion):
    """Return the values of all channels along a motion, by name."""
    inverse = derive_inverse(system)
    kernel = compile_kernel(inverse.equations, backend="interpreted")
    rows = [row for row, _ in channel_rows(inverse, kernel, TIMES, motion)]
    names = [channel.name for channel in inverse.equations.channels]
    return dict(zip(names, np.transpose(rows), strict=True))


def test_the_torque_of_a_pendulum():
    """M l² φ'' + M g l sin φ."""
    angle, _, acceleration = swing()
    found = inverse_dynamics(pendulum(), *swing())
    torque = MASS * ARM**2 * acceleration + MASS * GRAVITY * ARM * np.sin(angle)
    assert found["angle_force"] == pytest.approx(torque[:, 0], rel=1e-12, abs=1e-12)


def test_a_slider_crank_lifts_its_weight():
    """Slow motion: the torque's power is that of the weight, and the rod carries the rest."""
    crank = Body("crank", GROUND, (0, 0, 0), (Joint("R2", "angle", role="independent"),))
    piston = Body("piston", GROUND, (0, 0, 0), (Joint("T3", "height", start=0.8),), mass=MASS)
    rod = RodCut("rod", "crank", (0.2, 0.0, 0.0), "piston", (0.0, 0.0, 0.0), 0.9)
    gravity = (0.0, 0.0, -GRAVITY)
    system = System("press", ParameterTable(), (crank, piston), (rod,), gravity=gravity)
    angle = np.linspace(0.2, -1.2, 5)
    still = np.zeros((5, 1))
    found = inverse_dynamics(system, angle[:, None], still, still)
    x, z = 0.2 * np.cos(angle), -0.2 * np.sin(angle)
    height = z + np.sqrt(0.81 - x**2)
    assert found["height"] == pytest.approx(height, rel=1e-12)
    force = MASS * GRAVITY * 0.9 / (height - z)
    assert found["rod.axial_force"] == pytest.approx(-force, rel=1e-12)
    slope = -0.2 * np.cos(angle) - 0.04 * np.cos(angle) * -np.sin(angle) / (height - z)
    assert found["angle_force"] == pytest.approx(MASS * GRAVITY * slope, rel=1e-11)


def test_prescribed_states_move_as_given():
    """Position grows with the rate, the rate with the acceleration, which stays."""
    inverse = derive_inverse(pendulum())
    e = inverse.equations
    state = inverse.state([0.3], [2.0], [5.0])
    rates = ops.numeric([e.time, e.state], e.rate)(0.0, state)[:, 0]
    assert rates.tolist() == [2.0, 5.0, 0.0]
