"""Equivalent conicity: cones, a closed form with elliptic integrals, linearisation, refusals."""

import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.rail.geometry.conicity import (
    RadiusDifference,
    equivalent_conicity,
    free_path,
    harmonic_conicity,
    regression_conicity,
)

SHIFT = np.linspace(-0.01, 0.01, 2001)
AMPLITUDES = np.array([0.001, 0.003, 0.006])


@pytest.mark.parametrize("slope", [0.025, 0.4])
def test_cone_has_its_own_conicity(slope):
    table = RadiusDifference(SHIFT, 2.0 * slope * SHIFT)
    found = equivalent_conicity(table, AMPLITUDES, radius=0.46)
    assert found == pytest.approx(slope, rel=1e-6)
    for method in (harmonic_conicity, regression_conicity):
        assert method(table, AMPLITUDES) == pytest.approx(slope, rel=1e-6)


def test_wavelength_of_klingel():
    """λ = 2π √(e r/(2 γ))."""
    table = RadiusDifference(SHIFT, 2.0 * 0.05 * SHIFT)
    path = free_path(table, 0.004, 1.5, 0.46)
    assert path.wavelength == pytest.approx(2.0 * np.pi * np.sqrt(1.5 * 0.46 / 0.1), rel=1e-6)


def test_cubic_difference_against_elliptic_integrals():
    """y'' + a y + b y³ = 0 (Duffing): λ = 4 K(m)/√(a + b A²), m = b A²/(2 (a + b A²))."""
    from scipy.special import ellipk

    a, b = 0.05, 4000.0
    table = RadiusDifference(SHIFT, 1.5 * 0.46 * (a * SHIFT + b * SHIFT**3))
    stiff = a + b * AMPLITUDES**2
    wavelength = 4.0 * ellipk(b * AMPLITUDES**2 / (2.0 * stiff)) / np.sqrt(stiff)
    expected = (np.pi / wavelength) ** 2 * 2.0 * 1.5 * 0.46
    found = equivalent_conicity(table, AMPLITUDES, radius=0.46)
    assert found == pytest.approx(expected, rel=1e-5)
    harmonic = 0.5 * 1.5 * 0.46 * (a + 0.75 * b * AMPLITUDES**2)
    assert harmonic_conicity(table, AMPLITUDES) == pytest.approx(harmonic, rel=1e-4)
    regression = 0.5 * 1.5 * 0.46 * (a + 0.6 * b * AMPLITUDES**2)
    assert regression_conicity(table, AMPLITUDES) == pytest.approx(regression, rel=1e-4)


def test_jump_in_the_middle():
    """Δr = ± c: a quarter of the wave takes √(2 A e r/c)."""
    shift = np.array([-0.01, -1e-9, 1e-9, 0.01])
    step = 2e-4
    table = RadiusDifference(shift, step * np.sign(shift))
    wavelength = 4.0 * np.sqrt(2.0 * AMPLITUDES * 1.5 * 0.46 / step)
    expected = (np.pi / wavelength) ** 2 * 2.0 * 1.5 * 0.46
    found = equivalent_conicity(table, AMPLITUDES, radius=0.46)
    assert found == pytest.approx(expected, rel=1e-3)


def test_level_middle():
    """Δr = 0 up to c, ± D beyond: a quarter takes c/v + √(2 (A - c) e r/D), v² = 2 D (A - c)/(e r).

    Cylindrical treads with flanges; rounding of the last digit of a table does not matter.
    """
    c, step = 2e-3, 1.5e-3
    noise = 1e-8 * np.random.default_rng(2).integers(-1, 2, len(SHIFT))
    difference = np.where(np.abs(SHIFT) < c + 1e-9, noise, step * np.sign(SHIFT))
    table = RadiusDifference(SHIFT, difference)
    assert table.middle == pytest.approx(0.0, abs=1e-5)
    beyond = 2.0 * step * (AMPLITUDES[1:] - c) / (1.5 * 0.46)
    wavelength = 4.0 * (c / np.sqrt(beyond) + np.sqrt(beyond) * 1.5 * 0.46 / step)
    expected = (np.pi / wavelength) ** 2 * 2.0 * 1.5 * 0.46
    found = equivalent_conicity(table, AMPLITUDES, radius=0.46)
    assert found[0] == 0.0
    assert found[1:] == pytest.approx(expected, rel=0.01)


def test_shifted_tables_have_their_own_middle():
    table = RadiusDifference(SHIFT, 2.0 * 0.1 * (SHIFT - 0.002))
    assert table.middle == pytest.approx(0.002, abs=1e-12)
    path = free_path(table, 0.003, 1.5, 0.46)
    assert (path.left, path.right) == pytest.approx((0.005, -0.001), abs=1e-12)


def test_unequal_sides_have_unequal_turning_points():
    """Half the distance of the turning points is the amplitude; both have the same energy."""
    table = RadiusDifference(SHIFT, np.where(SHIFT > 0.0, 0.4, 0.1) * SHIFT)
    path = free_path(table, 0.003, 1.5, 0.46)
    assert path.left - path.right == pytest.approx(0.006, abs=1e-12)
    assert path.left * 2.0 == pytest.approx(-path.right, rel=1e-6)
    found = equivalent_conicity(table, np.array([0.003]), radius=0.46)[0]
    halves = 0.5 * (1.0 / np.sqrt(0.2) + 1.0 / np.sqrt(0.05))
    assert found == pytest.approx(1.0 / halves**2, rel=1e-5)


def test_amplitudes_beyond_the_table_have_none():
    table = RadiusDifference(SHIFT, 0.1 * SHIFT)
    found = equivalent_conicity(table, np.array([0.01, 0.0101]), radius=0.46)
    assert found[0] == pytest.approx(0.05, rel=1e-4)
    assert np.isnan(found[1])


@pytest.mark.parametrize(
    ("shift", "difference", "told"),
    [
        (SHIFT, -0.1 * SHIFT, "does not centre itself"),
        (SHIFT[::-1], 0.1 * SHIFT, "must increase"),
        (SHIFT, np.where(SHIFT > 0, np.nan, 0.1), "not finite"),
        (SHIFT[:2], SHIFT[:2], "at least three"),
    ],
)
def test_refusals(shift, difference, told):
    with pytest.raises(InputError, match=told):
        RadiusDifference(shift, difference)
