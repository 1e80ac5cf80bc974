"""The classic Cooperrider bogie against its equations written as matrices by hand."""

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from vehicledyn.files.building.construct import build_system
from vehicledyn.files.system.read import read_system
from vehicledyn.kernel.derivatives import Derivatives
from vehicledyn.multibody import derive

SYSTEM = Path(__file__).parents[2] / "systems" / "cooperrider_classic.yaml"
STATES = ("front.lateral", "rear.lateral", "front.yaw", "rear.yaw")
STATES += ("frame.lateral", "frame.yaw", "frame.roll")
B, A, R0, CONICITY = 1.074, 0.716, 0.4572, 0.05
K1, K2, K3, K4, K5, K6 = 1.823e6, 3.646e6, 3.646e6, 0.1823e6, 0.3333e6, 2.710e6
D1, D2, H1, H2, HALF1, HALF2 = 20e3, 29.2e3, 0.0762, 1.5584, 0.620, 0.680
CREEP, LATERAL, LONGITUDINAL = 6.563e6, 0.54219, 0.60252


def matrix(speed, lateral=LATERAL, longitudinal=LONGITUDINAL):
    """Return the matrix of the linear equations, positions before rates."""
    k, c = np.zeros((2, 7, 7))

    def across(target, row, amount):
        target += amount * np.outer(row, row)

    across(k, np.array([1, 0, 0, 0, -1, -B, -H1]), 2 * K1)
    across(k, np.array([0, 1, 0, 0, -1, B, -H1]), 2 * K1)
    across(k, np.array([0, 0, 1, 0, 0, -1, 0]), 2 * K2 * HALF1**2)
    across(k, np.array([0, 0, 0, 1, 0, -1, 0]), 2 * K2 * HALF1**2)
    across(k, np.array([0, 0, 0, 0, 1, 0, -H2]), 2 * K4)
    across(c, np.array([0, 0, 0, 0, 1, 0, -H2]), 2 * D2)
    k[5, 5] += K6
    k[6, 6] += 2 * K5 * HALF2**2 + 4 * K3 * HALF1**2
    c[6, 6] += 2 * D1 * HALF2**2
    for i in (0, 1):
        c[i, i] += 2 * CREEP / lateral / speed
        k[i, i + 2] -= 2 * CREEP / lateral
        c[i + 2, i + 2] += 2 * CREEP / longitudinal * A * A / speed
        k[i + 2, i] += 2 * CREEP / longitudinal * A * CONICITY / R0
    inverse = np.diag(1.0 / np.array([1022, 1022, 678, 678, 2918.9, 6780, 6780]))
    return np.block([[np.zeros((7, 7)), np.eye(7)], [-inverse @ k, -inverse @ c]])


def growth(a):
    return float(np.linalg.eigvals(a).real.max())


def test_eigenvalues_are_those_of_the_matrices():
    model, problems = read_system(SYSTEM, {"parameters": {"speed": "60 m/s"}})
    assert not problems
    equations = derive(build_system(model))
    names = [s.name for s in equations.states]
    order = [names.index(n) for n in (*STATES, *(f"{n}_rate" for n in STATES))]
    parameters = np.array([p.value for p in equations.parameters])
    rest = np.zeros(len(names))
    found = Derivatives(equations).total(0.0, rest, np.zeros(0), parameters).rates
    found = found[np.ix_(order, order)]
    assert found == pytest.approx(matrix(60.0), rel=1e-9, abs=1e-6)


@pytest.mark.parametrize(
    ("factors", "speed"), [((LATERAL, LONGITUDINAL), 65.359), ((LONGITUDINAL, LATERAL), 62.138)]
)
def test_critical_speeds_of_the_documentation(factors, speed):
    found = brentq(lambda v: growth(matrix(v, *factors)), 50.0, 75.0)
    assert found == pytest.approx(speed, abs=1e-3)
