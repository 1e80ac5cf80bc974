"""Uncertainty against closed forms: the Ishigami function, linear figures of normal parameters."""

import numpy as np
import pytest

from vehicledyn.analyse.uncertainty import (
    failing,
    first_order,
    first_order_shares,
    normal,
    samples,
    sobol,
    spread,
    triangular,
    uniform,
)


@pytest.mark.parametrize("figures", [1, 2])
@pytest.mark.parametrize("parameters", [1, 2])
def test_sobol_indices_of_few_figures_and_parameters(figures, parameters):
    """Figure k is the (k + 1)-fold sum of parameters alike: each has an equal share of it."""

    def sums(points):
        return np.outer(points.sum(axis=1), np.arange(1.0, figures + 1.0))

    found = sobol(sums, [uniform(0.0, 1.0)] * parameters, 256, 1)
    for indices in found:
        assert indices.shape == (figures, parameters)
        assert indices == pytest.approx(1.0 / parameters, abs=0.02)


def test_sobol_indices_of_ishigami():
    """a = 7, b = 0.1: Ishigami and Homma (1990)."""
    a, b = 7.0, 0.1

    def ishigami(points):
        x, y, z = points.T
        return (np.sin(x) + a * np.sin(y) ** 2 + b * z**4 * np.sin(x))[:, None]

    first, total = sobol(ishigami, [uniform(-np.pi, np.pi)] * 3, 2**14, 1)
    whole = a**2 / 8 + b * np.pi**4 / 5 + b**2 * np.pi**8 / 18 + 0.5
    of_x, of_y = 0.5 * (1 + b * np.pi**4 / 5) ** 2, a**2 / 8
    mixed = b**2 * np.pi**8 * (1 / 18 - 1 / 50)
    assert first[0] == pytest.approx([of_x / whole, of_y / whole, 0.0], abs=0.01)
    expected = [(of_x + mixed) / whole, of_y / whole, mixed / whole]
    assert total[0] == pytest.approx(expected, abs=0.01)


def test_table_figures_of_normal_parameters_are_exact():
    """Variances add, and so do their shares."""
    slopes = np.array([[2.0, -3.0], [0.0, 1.0]])
    laws = [normal(1.0, 0.5), normal(2.0, 0.1)]
    found = first_order(np.array([5.0, 6.0]), slopes, laws)
    assert found.deviation == pytest.approx([np.sqrt(1.0 + 0.09), 0.1], rel=1e-14)
    shares = first_order_shares(slopes, laws)
    assert shares == pytest.approx(np.array([[1.0 / 1.09, 0.09 / 1.09], [0.0, 1.0]]), rel=1e-14)


@pytest.mark.parametrize("scrambled", [True, False])
def test_samples_have_the_moments_of_their_laws(scrambled):
    """Mean and deviation within three standard errors; a sequence is far better."""
    laws = [normal(3.0, 0.2), uniform(-1.0, 5.0), triangular(0.0, 1.0, 4.0)]
    points = samples(laws, 4096, 7, scrambled=scrambled)
    found = spread(points)
    assert (points == samples(laws, 4096, 7, scrambled=scrambled)).all()
    share = 0.05 if scrambled else 3.0
    means = np.array([law.mean for law in laws])
    deviations = np.array([law.deviation for law in laws])
    assert np.all(np.abs(found.mean - means) < share * found.mean_error)
    assert np.all(np.abs(found.deviation - deviations) < 3.0 * found.deviation_error)


def test_the_share_beyond_a_limit_has_an_interval():
    """Normal figures beyond one deviation: 15.87 %."""
    figures = samples([normal(0.0, 1.0)], 20_000, 3, scrambled=False)[:, 0]
    share, low, high = failing(figures, 1.0, above=True)
    assert low < 0.158655 < high
    assert share == pytest.approx(0.158655, abs=0.01)
    assert failing(figures, -1.0, above=False)[0] == pytest.approx(0.158655, abs=0.01)
