"""FASTSIM: exact where all adheres or slides, arrays like scalars, Kalker's grid."""

import numpy as np
import pytest

from vehicledyn.base.registry import find
from vehicledyn.rail.creep.creep_law import CreepContact, kalker_forces
from vehicledyn.rail.creep.simplified_theory import (
    Rates,
    march,
    march_arrays,
    rates_of,
    sliding_rates,
)
from vehicledyn.rail.geometry.hertz import ContactEllipse

CASES = Rates(
    np.array([0.1, 0.8, 0.0, -0.4, 3.0]),
    np.array([0.0, 0.3, 0.1, 1.5, 0.2]),
    np.array([0.0, 0.2, 1.0, -0.6, 5.0]),
    np.array([0.0, 0.1, 1.5, -0.9, 8.0]),
)

OTHER = Rates(*(1.2 * rate for rate in vars(CASES).values()))


def contact(xi, eta, phi, a=5e-3, b=5e-3):
    return CreepContact(xi, eta, phi, 5e4, ContactEllipse(a, b), 8.2e10, 0.28)


def test_arrays_and_scalars_agree():
    arrays = march_arrays(CASES, OTHER, 7, 5)
    for k in range(5):
        both = [Rates(*(float(rate[k]) for rate in vars(x).values())) for x in (CASES, OTHER)]
        scalars = march(*both, 7, 5)
        for name, value in vars(scalars).items():
            assert float(value) == pytest.approx(getattr(arrays, name)[k], abs=1e-14)


def test_adhesion_is_that_of_the_linear_theory():
    """The linear theory's forces, which the flexibilities are made for."""
    small = contact(1e-9, 2e-9, 1e-7, a=3e-3, b=6e-3)
    forces = find("creep", "fastsim")(friction=0.3, strips=10, elements=2).forces(small)
    linear = kalker_forces(small)
    assert float(forces.longitudinal) == pytest.approx(float(linear.longitudinal), rel=5e-4)
    assert float(forces.lateral) == pytest.approx(float(linear.lateral), rel=5e-4)


def test_sliding_is_exact_on_the_smallest_grid():
    slip = Rates(-1e9, 0.0, 0.0, 0.0)
    sums = march(slip, slip, 3, 2)
    assert float(sums.longitudinal) == pytest.approx(1.0, rel=1e-8)


def test_pure_longitudinal_creep_has_a_closed_form():
    """A strip of half length l slides from x = k - l on, k = ξ a/L1: each strip by hand."""
    k = 0.6
    rates = Rates(k, 0.0, 0.0, 0.0)
    sums = march_arrays(rates, rates, 400, 400)
    angle = np.pi * ((np.arange(4000) + 0.5) / 4000 - 0.5)
    length = np.cos(angle)
    adhering = np.maximum(2.0 * length - k, 0.0)
    slid_from = length - adhering
    slid = length**2 * (slid_from + length) - (slid_from**3 + length**3) / 3.0
    wanted = np.sum((0.5 * k * adhering**2 + slid) * length) * 2.0 / 4000
    assert -float(sums.longitudinal) == pytest.approx(wanted, rel=1e-5)


def kalkers_grid(rates, strips, elements):
    """FASTSIM as published: equal strips and elements, tractions at their middles."""
    along = across = 0.0
    for j in range(strips):
        y = -1.0 + (2.0 * j + 1.0) / strips
        half = np.sqrt(1.0 - y * y)
        step = 2.0 * half / elements
        p = np.zeros(2)
        for i in range(elements):
            x = half - (i + 0.5) * step
            rate = np.array(
                [rates[0] - rates[2] * y, rates[1] + rates[3] * (x + (0.0 if i else 0.25 * step))]
            )
            p = p - rate * (step if i else 0.5 * step)
            bound, size = half**2 - x * x, np.hypot(*p)
            p = p * min(1.0, bound / size) if size else p
            along += p[0] * step * 2.0 / strips
            across += p[1] * step * 2.0 / strips
    return np.array([along, across]) * 2.0 / np.pi


@pytest.mark.parametrize("case", range(5))
def test_kalkers_own_grid_leads_to_the_same(case):
    rates = [float(rate[case]) for rate in vars(CASES).values()]
    fine = march_arrays(Rates(*rates), Rates(*rates), 320, 320)
    found = np.array([float(fine.longitudinal), float(fine.lateral)])
    finer = 2.0 * kalkers_grid(rates, 120, 120) - kalkers_grid(rates, 60, 60)
    assert finer == pytest.approx(found, abs=4e-3)


@pytest.mark.parametrize(("turning", "typical", "largest"), [(0.0, 3e-3, 5e-3), (1.0, 0.07, 0.12)])
def test_the_usual_grid_against_a_fine_one(turning, typical, largest):
    """At any creep and spin, of narrow and long contacts."""
    rng = np.random.default_rng(7)
    for ratio in (0.3, 1.0, 3.0):
        xi, eta, turn = 10.0 ** rng.uniform(-4.2, -1.8, size=(3, 200))
        eta *= rng.choice([-1.0, 1.0], size=200)
        a, b = 5e-3 * ratio**0.5, 5e-3 / ratio**0.5
        felt = contact(xi, eta, turning * turn / 5e-3, a=a, b=b)
        both = rates_of(felt, 1.5e4), sliding_rates(felt, 1.5e4)
        coarse, fine = march_arrays(*both, 10, 16), march_arrays(*both, 128, 128)
        apart = np.hypot(coarse.longitudinal - fine.longitudinal, coarse.lateral - fine.lateral)
        assert np.quantile(apart, 0.95) < typical
        assert apart.max() < largest
