"""Flexible bodies of the library against closed forms and Ritz solutions beside them."""

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

from vehicledyn.multibody.elements.flexible.flexible_body import FlexibleBody

SYSTEMS = Path(__file__).parents[3] / "systems"


def free_bending(mass, stiffness, half):
    """Return bending frequencies [Hz] of a free beam, symmetric about its middle, by polynomials.

    ``mass`` are pieces (from, to, density) of one half [m, kg/m].
    """
    shapes = [np.polynomial.Legendre.basis(2 * k, domain=[-half, half]) for k in range(9)]
    points, weights = np.polynomial.legendre.leggauss(30)
    m, k = np.zeros((9, 9)), np.zeros((9, 9))
    for start, end, density in mass:
        x = 0.5 * (start + end) + 0.5 * (end - start) * points
        w = (end - start) * weights  # Both halves.
        values, bent = (np.array([s.deriv(d)(x) for s in shapes]) for d in (0, 2))
        m += density * (values * w) @ values.T
        k += stiffness * (bent * w) @ bent.T
    return np.sqrt(np.abs(eigh(k, m, eigvals_only=True)[1:3])) / (2.0 * np.pi)


def test_car_body_of_the_coach():
    """Its mass and inertia are the rigid coach's, its first vertical bending is at 8.5 Hz."""
    ends = {"bolster_1": 22, "bolster_2": 4}
    file = str(SYSTEMS / "coach_body.npz")
    body = FlexibleBody("body", body="car", file=file, interface=ends, modes=4)
    made, found = body.component_modes, body.flexibility
    assert made.mass == pytest.approx(32000.0, rel=1e-12)
    assert found.inertia == pytest.approx(np.diag([56800.0, 1.97e6, 1.97e6]), rel=1e-9, abs=1e-3)
    assert found.centre == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    middle = (32000.0 - 6.2 * 1750.41067) / 19.0
    assert 2.0 * (9.5**3 * middle + (12.6**3 - 9.5**3) * 1750.41067) / 3.0 == pytest.approx(
        1.97e6, rel=1e-6
    )
    pieces = [(0.0, 9.5, middle), (9.5, 12.6, 1750.41067)]
    wanted = free_bending(pieces, 3.228e9, 12.6)[0]
    frequency = made.frequencies[0] / (2.0 * np.pi)
    assert frequency == pytest.approx(8.5, abs=0.01)
    assert wanted < frequency < 1.003 * wanted
    fine = FlexibleBody("body", body="car", file=file, interface=ends, modes=20).component_modes
    assert fine.frequencies[0] / (2.0 * np.pi) == pytest.approx(wanted, rel=1e-4)
