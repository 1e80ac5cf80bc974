"""The expressions of the equations fit together: what one says the others say too."""

import numpy as np
import pytest
from export_cases import CASES, case

ALGEBRA = 1e-10


@pytest.fixture(params=CASES)
def found(request):
    """Values of all expressions at a consistent motion, coordinates taken from the states."""
    c = case(request.param)
    point = c.point(3)
    point["q"], point["qd"] = c.value("coordinates", point)
    (point["qdd"],) = c.value("direct_dynamics", point)
    states = len(c.equations.states) - len(c.ingredients.part_variables)
    point["s"], point["u"] = point["x"][states:], point["z"][len(c.ingredients.constraints) :]
    return c, point


def test_motion_fulfils_the_constraints(found):
    c, point = found
    (jacobian,) = c.value("constraint_jacobian", point)
    scale = 1.0 + np.abs(point["qdd"]).max(initial=0.0)
    assert np.abs(c.value("constraints", point)[0]).max(initial=0.0) < ALGEBRA
    rates = jacobian @ point["qd"] + c.value("constraint_rate", point)[0]
    assert np.abs(rates).max(initial=0.0) < ALGEBRA
    accelerations = jacobian @ point["qdd"] + c.value("quadratic_term", point)[0]
    assert np.abs(accelerations).max(initial=0.0) < ALGEBRA * scale


def test_motion_fulfils_newton_and_euler(found):
    """M q̈ + c has no component along any motion that constraints and drives allow."""
    c, point = found
    (mass,), (bias,) = c.value("mass_matrix", point), c.value("bias", point)
    (jacobian,) = c.value("constraint_jacobian", point)
    driven = [k for k, role in enumerate(c.ingredients.roles) if role == "driven"]
    held = np.vstack([jacobian, np.eye(len(bias))[driven]])
    _, sizes, directions = np.linalg.svd(held)
    allowed = directions[np.sum(sizes > 1e-9) :]
    assert len(allowed) == c.equations.structure["degrees_of_freedom"]
    needed = mass @ point["qdd"] + bias
    scale = 1.0 + np.abs(mass @ point["qdd"]).max() + np.abs(bias).max()
    assert np.abs(allowed @ needed).max() < ALGEBRA * scale


def test_inverse_dynamics_are_mass_times_acceleration_plus_bias(found):
    c, point = found
    (mass,), (bias,) = c.value("mass_matrix", point), c.value("bias", point)
    (forces,) = c.value("inverse_dynamics", point)
    assert forces == pytest.approx(
        mass @ point["qdd"] + bias, abs=1e-12 * np.abs(mass @ point["qdd"]).max(initial=1.0)
    )


def test_rates_are_those_of_the_coordinates(found):
    c, point = found
    rates = c.kernel.rates(point["t"], point["x"], point["z"])
    names = [v.name for v in c.ingredients.variables]
    for k, (position, velocity) in enumerate(
        zip(c.equations.positions, c.equations.velocities, strict=True)
    ):
        at = names.index(c.equations.states[position].name)
        assert c.ingredients.roles[at] == "independent", k
        assert point["q"][at] == point["x"][position]
        assert rates[velocity] == pytest.approx(point["qdd"][at], rel=1e-9, abs=1e-9)
