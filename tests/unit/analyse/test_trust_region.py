"""Search by models of figures: interpolation, variables by ratios, and how few runs it takes."""

import numpy as np
import pytest

from vehicledyn.analyse.gradients.key_figures import figure_slope, gauss_newton
from vehicledyn.analyse.objective import Evaluated, FigureCurve, FigureValue, ObjectiveParts
from vehicledyn.analyse.optimise import optimise
from vehicledyn.analyse.trust_region.interpolant import Interpolant
from vehicledyn.analyse.variable_box import VariableBox


def wave(x):
    """Return a smooth function of two variables with its gradient and second derivatives."""
    value = np.sin(3.0 * x[0]) * np.exp(x[1])
    slope = np.exp(x[1]) * np.array([3.0 * np.cos(3.0 * x[0]), np.sin(3.0 * x[0])])
    mixed = 3.0 * np.cos(3.0 * x[0]) * np.exp(x[1])
    return value, slope, np.array([[-9.0 * value, mixed], [mixed, value]])


def test_an_interpolant_keeps_what_is_known_and_learns_from_each_point():
    """All are met up to the nugget, the centre exactly; its gradient is that of its values."""
    points = np.random.default_rng(1).random((9, 2))
    known = [wave(x) for x in points]
    given = np.array([[v] for v, _, _ in known]), np.array([[g] for _, g, _ in known])
    found = Interpolant(points, *given, known[0][2][None])
    for x, (value, slope, _) in zip(points, known, strict=True):
        assert found(x)[0] == pytest.approx([value], abs=1e-4)
        assert found(x)[1] == pytest.approx(slope[None], abs=1e-3)
    assert found(points[0])[0] == pytest.approx([known[0][0]], abs=1e-14)
    x, h = np.array([0.4, 0.6]), 1e-4
    steps = [(found(x + h * e)[0] - found(x - h * e)[0]) / (2.0 * h) for e in np.eye(2)]
    assert found(x)[1] == pytest.approx(np.array(steps).T, abs=1e-5)
    assert found(x)[0] == pytest.approx([wave(x)[0]], abs=1e-2)
    close = np.vstack([points, points[:1] + 1e-9])
    twice = [np.concatenate([item, item[:1]]) for item in given]
    assert Interpolant(close, *twice)(points[0])[1] == pytest.approx(known[0][1][None], abs=1e-12)


@pytest.mark.parametrize("kind", ["mean_square", "rms"])
def test_second_derivatives_of_mean_squares_follow_from_first_ones(kind):
    """All of them, where the channel is linear in the parameters."""
    time = np.linspace(0.0, 2.0, 40)
    slopes = np.array([np.sin(time), time, np.cos(3.0 * time)]).T

    def slope(x):
        return figure_slope(kind, time, 1.0 + slopes @ x, slopes).slope

    x, h = np.array([0.3, -0.2, 0.5]), 1e-5
    bent = [(slope(x + h * e) - slope(x - h * e)) / (2.0 * h) for e in np.eye(3)]
    found = gauss_newton(kind, time, 1.0 + slopes @ x, slopes)
    assert found == pytest.approx(np.array(bent), abs=1e-8)


def test_variables_of_wide_positive_bounds_are_scaled_by_ratios():
    """Half way from 1 to 100 is 10; derivatives by the shares agree with differences."""
    box = VariableBox(np.array([1.0, -1.0]), np.array([100.0, 3.0]))
    shares = np.array([0.5, 0.5])
    point = box.point(shares)
    assert point == pytest.approx([10.0, 1.0])
    assert box.shares(point) == pytest.approx(shares)

    def values(x):
        figure = FigureValue(x[0] ** 2 * x[1], np.array([2.0 * x[0] * x[1], x[0] ** 2]))
        bend = np.array([[2.0 * x[1], 2.0 * x[0]], [2.0 * x[0], 0.0]])
        figure = FigureValue(figure.value, figure.slope, bend)
        parts = ObjectiveParts({"figure": figure}, lambda _: None)
        none = np.zeros(0), np.zeros((0, 2))
        return box.by_shares(Evaluated(figure.value, figure.slope, *none, parts=parts), x)

    found, h = values(point), 1e-5
    for k, e in enumerate(np.eye(2)):
        ahead, behind = values(box.point(shares + h * e)), values(box.point(shares - h * e))
        assert (ahead.objective - behind.objective) / (2 * h) == pytest.approx(found.gradient[k])
        bent = (ahead.gradient - behind.gradient) / (2 * h)
        assert found.parts.figures["figure"].bend[k] == pytest.approx(bent, rel=1e-6)


def search(evaluate, start, low, high, **settings):
    """Return the optimum, and how many runs it took."""
    settings = {"tolerance": 1e-12, "most_runs": 60} | settings
    bounds = np.array(low, dtype=float), np.array(high, dtype=float)
    return optimise(evaluate, start=np.array(start, dtype=float), bounds=bounds, **settings)


def hock_schittkowski_71(x):
    """Return the problem of that number: f* = 17.0140173."""
    a, b, c, d = x
    circle = np.sum(x**2)
    return Evaluated(
        a * d * (a + b + c) + c,
        np.array([d * (2.0 * a + b + c), a * d, a * d + 1.0, a * (a + b + c)]),
        np.array([a * b * c * d - 25.0, circle - 40.0, 40.0 - circle]),
        np.array([np.prod(x) / x, 2.0 * x, -2.0 * x]),
    )


def test_a_problem_with_curved_constraints_takes_few_runs():
    """Hock, Schittkowski (1981), problem 71, to its published optimum."""
    found = search(hock_schittkowski_71, [1, 5, 5, 1], [1] * 4, [5] * 4)
    assert found.values.objective == pytest.approx(17.0140173, abs=1e-5)
    assert found.message == "converged"
    assert found.n_runs <= 12


def test_curves_of_figures_are_modelled_where_that_is_closer():
    """The mean square of samples is a sum of squares; its root is most stationary in few runs."""
    times = np.linspace(0.0, 1.0, 50)

    def samples(x):
        values = (1.0 - x[0]) * (1.0 + times) + 5.0 * (x[1] - x[0] ** 2) * times**2
        by_x = -(1.0 + times) - 10.0 * x[0] * times**2, 5.0 * times**2
        return values, np.array(by_x).T

    def draw(values, slopes):
        return float(np.mean(values**2)), 2.0 * slopes.T @ values / len(values)

    def evaluate(x, drawn=True):
        values, slopes = samples(x)
        value, slope = draw(values, slopes)
        none = np.zeros(0), np.zeros((0, 2))
        figure = FigureValue(
            value, slope, curve=FigureCurve(values, slopes, draw) if drawn else None
        )
        parts = ObjectiveParts(
            {"f": figure}, lambda f: Evaluated(f["f"].value, f["f"].slope, *none)
        )
        return Evaluated(value, slope, *none, parts=parts)

    found = search(evaluate, [-1.2, 1.0], [-2, -2], [2, 2])
    plain = search(lambda x: evaluate(x, drawn=False), [-1.2, 1.0], [-2, -2], [2, 2])
    assert found.variables == pytest.approx([1.0, 1.0], abs=1e-3)
    assert found.n_runs <= 8 < plain.n_runs


def test_an_infeasible_problem_ends_where_it_misses_least():
    """x >= 1 and x <= 0 exclude each other."""

    def evaluate(x):
        bounds = np.array([x[0] - 1.0, -x[0]]), np.array([[1.0], [-1.0]])
        return Evaluated(float(x[0] ** 2), 2.0 * x, *bounds)

    found = search(evaluate, [1.7], [-2], [2])
    assert not found.is_feasible
    assert found.variables == pytest.approx([0.5], abs=1e-3)
