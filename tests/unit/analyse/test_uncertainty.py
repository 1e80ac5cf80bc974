"""Uncertainty against closed forms: the Ishigami function, linear figures of normal parameters."""

import numpy as np
import pytest

from vehicledyn.analyse.polynomial_chaos import fit_chaos, orthonormal
from vehicledyn.analyse.reliability import failing_chance
from vehicledyn.analyse.sobol_indices import sobol_samples
from vehicledyn.analyse.uncertainty import (
    failing,
    first_order,
    first_order_shares,
    normal,
    samples,
    second_order,
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

    found = sobol_samples(sums, [uniform(0.0, 1.0)] * parameters, 256, 1).shares()
    for indices in (found.first, found.total):
        assert indices.shape == (figures, parameters)
        assert indices == pytest.approx(1.0 / parameters, abs=0.02)


def test_sobol_indices_of_ishigami():
    """a = 7, b = 0.1: Ishigami and Homma (1990)."""
    found = sobol_samples(ishigami, [uniform(-np.pi, np.pi)] * 3, 2**14, 1).shares()
    first, total = ishigami_indices()
    assert found.first[0] == pytest.approx(first, abs=0.01)
    assert found.total[0] == pytest.approx(total, abs=0.01)


def ishigami(points):
    x, y, z = points.T
    return (np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x))[:, None]


def ishigami_indices():
    a, b = 7.0, 0.1
    whole = a**2 / 8 + b * np.pi**4 / 5 + b**2 * np.pi**8 / 18 + 0.5
    of_x, of_y = 0.5 * (1 + b * np.pi**4 / 5) ** 2, a**2 / 8
    mixed = b**2 * np.pi**8 * (1 / 18 - 1 / 50)
    return (
        np.array([of_x, of_y, 0.0]) / whole,
        np.array([of_x + mixed, of_y, mixed]) / whole,
    )


def test_sobol_indices_are_those_of_scipy_and_have_their_errors():
    """SciPy's to rounding; of few points 9 of 10 within two errors, and the errors no larger."""
    laws, away, sizes = [uniform(-np.pi, np.pi)] * 3, [], []
    from scipy.stats import sobol_indices

    for seed in range(40):
        found = sobol_samples(ishigami, laws, 64, seed).shares()
        away += [found.first[0] - ishigami_indices()[0], found.total[0] - ishigami_indices()[1]]
        sizes += [found.first_error[0], found.total_error[0]]
    theirs = sobol_indices(
        func=lambda x: ishigami(x.T).T, n=64, dists=[law.law for law in laws], rng=39
    )
    assert found.first[0] == pytest.approx(theirs.first_order, rel=1e-9, abs=1e-12)
    assert found.total[0] == pytest.approx(theirs.total_order, rel=1e-9, abs=1e-12)
    assert np.mean(np.abs(away) < 2.0 * np.array(sizes)) > 0.9
    assert np.sqrt(np.mean(np.square(away))) > 0.5 * np.sqrt(np.mean(np.square(sizes)))


def test_points_with_a_run_that_failed_are_left_out():
    """One failure takes its point from both samples; indices are those of the other points."""
    laws = [uniform(-np.pi, np.pi)] * 3
    every = sobol_samples(ishigami, laws, 64, 1)
    every.mixed[1, 5] = np.nan
    kept = np.arange(64) != 5
    left = every.complete()
    assert np.array_equal(left.one, every.one[kept])
    assert np.array_equal(left.mixed, every.mixed[:, kept])
    assert np.isfinite(left.shares().total).all()


@pytest.mark.parametrize("number", [24, 64])
def test_errors_of_polynomial_chaos_hold_the_truth(number):
    """Of an expansion that misses most of the variance, too, whose deviation is near zero."""
    laws, away, sizes = [uniform(-np.pi, np.pi)] * 3, [], []
    deviation = np.sqrt(7.0**2 / 8 + 0.1 * np.pi**4 / 5 + 0.01 * np.pi**8 / 18 + 0.5)
    for seed in range(4):
        points = samples(laws, number, seed, scrambled=True)
        found = fit_chaos(laws, points, ishigami(points))
        shares, spreads = found.shares(), found.spread
        away += [*(shares.first[0] - ishigami_indices()[0]), spreads.mean[0] - 3.5]
        away += [*(shares.total[0] - ishigami_indices()[1]), spreads.deviation[0] - deviation]
        sizes += [*shares.first_error[0], spreads.mean_error[0]]
        sizes += [*shares.total_error[0], spreads.deviation_error[0]]
    assert np.mean(np.abs(away) < 2.0 * np.array(sizes)) > 0.9


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


def test_runs_that_failed_may_be_on_either_side_of_a_limit():
    """Of 40 values 10 are above it, 4 unknown: Wilson's interval from 10 to 14 of 40."""
    figures = np.r_[np.zeros(26), np.ones(10), np.full(4, np.nan)]
    share, low, high = failing(figures, 0.5, above=True)
    sure = failing(np.nan_to_num(figures, nan=0.0), 0.5, above=True)
    most = failing(np.nan_to_num(figures, nan=1.0), 0.5, above=True)
    assert (share, low, high) == (10 / 36, sure[1], most[2])


LAWS = [normal(3.0, 0.2), uniform(-1.0, 5.0), triangular(0.0, 1.0, 4.0)]


@pytest.mark.parametrize("law", LAWS)
def test_polynomials_are_orthonormal_under_their_law(law):
    """Against quadratures of another order; the moments against scipy's."""
    nodes, weights = law.quadrature(40)
    table = orthonormal(law, nodes, 12)
    assert (table * weights[:, None]).T @ table == pytest.approx(np.eye(13), abs=1e-12)
    skewness, kurtosis = law.law.stats(moments="sk")
    third, fourth = law.moments()
    assert third == pytest.approx(float(skewness) * law.deviation**3, abs=1e-12)
    assert fourth == pytest.approx((float(kurtosis) + 3.0) * law.deviation**4, rel=1e-12)


def test_second_order_is_exact_for_quadratic_figures_of_any_laws():
    """Against a tensor quadrature of a quadratic of normal, even and triangular parameters."""
    slopes, bends = np.array([[1.0, -0.5, 0.3]]), np.zeros((1, 3, 3))
    bends[0] = [[2.0, 0.4, 0.0], [0.4, -0.3, 0.7], [0.0, 0.7, 0.5]]
    found, shares, _ = second_order(np.array([4.0]), slopes, bends, LAWS)
    rules = [law.quadrature(8) for law in LAWS]
    grid = np.meshgrid(*(nodes for nodes, _ in rules), indexing="ij")
    weight = np.einsum("i,j,k->ijk", *(weights for _, weights in rules))
    away = np.stack([x - law.mean for x, law in zip(grid, LAWS, strict=True)])
    values = 4.0 + np.einsum("k,kabc->abc", slopes[0], away)
    values += 0.5 * np.einsum("kl,kabc,labc->abc", bends[0], away, away)
    mean = np.sum(weight * values)
    variance = np.sum(weight * (values - mean) ** 2)
    assert found.mean[0] == pytest.approx(mean, rel=1e-12)
    assert found.deviation[0] ** 2 == pytest.approx(variance, rel=1e-12)
    for k in range(3):
        others = tuple(j for j in range(3) if j != k)
        rest = np.einsum("i,j->ij", *(rules[j][1] for j in others))
        given = np.einsum("kab,ab->k", np.moveaxis(values, k, 0), rest)
        alone = np.sum(rules[k][1] * (given - mean) ** 2)
        assert shares[0, k] == pytest.approx(alone / variance, rel=1e-10)
    fitted = fit_chaos(LAWS, points := samples(LAWS, 40, 1, scrambled=True), _quadratic(points))
    assert fitted.degree == 2
    assert fitted.missed[0] < 1e-20
    found = fitted.shares()
    for ours, theirs in zip((found.first, found.total), _quadratic_indices(), strict=True):
        assert ours == pytest.approx(theirs, abs=1e-10)


def _quadratic(points):
    away = points - np.array([law.mean for law in LAWS])
    return (away[:, 0] + away[:, 1] * away[:, 2] + away[:, 2] ** 2)[:, None]


def _quadratic_indices():
    bends = np.zeros((1, 3, 3))
    bends[0, 1, 2] = bends[0, 2, 1] = 1.0
    bends[0, 2, 2] = 2.0
    return second_order(np.zeros(1), np.array([[1.0, 0.0, 0.0]]), bends, LAWS)[1:]


def test_a_limit_out_of_reach_is_told():
    """A figure between -1 and 1 does not pass 3."""

    def margin(x):
        return 3.0 - float(np.tanh(x[0])), np.array([-1.0 / np.cosh(x[0]) ** 2])

    found = failing_chance([normal(0.0, 1.0)], margin, lambda x: margin(x)[0], 4, 1)
    assert found.chance == 0.0
    assert 0.0 < found.most < 1e-14
    assert "no failing point" in found.note


def _two_sided(mean, level, number):
    """x / 2 + y² above a level on either side of y = 0, and its chance by integration."""
    from scipy.integrate import quad
    from scipy.stats import norm

    def margin(x):
        return level - 0.5 * x[0] - x[1] ** 2, np.array([-0.5, -2.0 * x[1]])

    laws = [normal(0.0, 1.0), normal(mean, 1.0)]
    expected = quad(lambda y: norm.pdf(y, mean) * norm.sf(2.0 * (level - y**2)), -9.0, 9.0)[0]
    return failing_chance(laws, margin, lambda x: margin(x)[0], number, 1), expected


@pytest.mark.parametrize("mean", [0.0, 0.3])
def test_two_failing_regions_are_summed(mean):
    """Without a slope by y at its mean the first search stalls between both, at x = 4."""
    found, expected = _two_sided(mean, 2.0, 50)
    assert found.chance == pytest.approx(expected, abs=3.0 * found.error)
    assert found.error < 0.01 * expected
    assert sorted(np.sign(point.parameters[1]) for point in found.points) == [-1.0, 1.0]
    assert not found.note


def test_regions_in_four_directions_are_summed():
    """Beyond |x + y| = a or |x - y| = a, straight across each other: 1 - (1 - 2 Φ(-a / √2))²."""
    from scipy.stats import norm

    signs = np.array([[1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]])

    def margin(x):
        rooms = 3.0 - signs @ x
        return rooms.min(), -signs[rooms.argmin()]

    found = failing_chance([normal(0.0, 1.0)] * 2, margin, lambda x: margin(x)[0], 40, 1)
    expected = 1.0 - (1.0 - 2.0 * norm.sf(3.0 / np.sqrt(2.0))) ** 2
    assert len(found.points) == 4
    assert found.chance == pytest.approx(expected, abs=3.0 * found.error + 1e-9)
    assert found.error < 0.05 * expected


def test_regions_at_both_ends_of_a_uniform_parameter_are_summed():
    """|x| > 0.9 of x between -1 and 1, where the tangent at an end leads far across."""
    found = failing_chance(
        [uniform(-1.0, 1.0)], lambda x: (0.9 - abs(x[0]), -np.sign(x)), lambda x: 0.9 - abs(x[0]),
        2, 1,
    )  # fmt: skip
    assert found.chance == pytest.approx(0.1, rel=1e-4)


def test_lines_that_cross_a_limit_twice_are_told():
    """Where the middle fails beside a narrow region that does not: half of it is not seen."""
    found, expected = _two_sided(0.3, 0.05, 30)
    assert abs(found.chance - expected) > 0.1
    assert "cross it more than once" in found.note


def test_triangular_and_uniform_parameters_fail_as_their_law_says():
    """One parameter beyond a limit: one line, exact."""
    for law, limit in ((triangular(0.0, 1.0, 4.0), 3.5), (uniform(-1.0, 5.0), 4.9)):
        found = failing_chance(
            [law], lambda x, at=limit: (at - x[0], np.array([-1.0])), lambda x, at=limit: at - x[0],
            2, 1,
        )  # fmt: skip
        assert found.chance == pytest.approx(law.law.sf(limit), rel=1e-4)
