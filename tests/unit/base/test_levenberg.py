"""Least squares: closed forms, freedom, scales, and points where nothing is defined."""

import numpy as np
import pytest

from vehicledyn.base.numbers.levenberg import least_squares


def small(h):
    return float(np.abs(h).max()) < 1e-13


def test_two_circles_meet():
    def residual(q):
        x, y = q
        return np.array([x * x + y * y - 25.0, (x - 6.0) ** 2 + y * y - 25.0])

    def jacobian(q):
        x, y = q
        return np.array([[2.0 * x, 2.0 * y], [2.0 * (x - 6.0), 2.0 * y]])

    found, left = least_squares(residual, jacobian, np.array([1.0, 1.0]), is_solved=small)
    assert found == pytest.approx([3.0, 4.0], abs=1e-12)
    assert np.abs(left).max() < 1e-12


def test_no_step_goes_where_the_residuals_leave_freedom():
    """A sum that must be one, of unknowns that begin at zero: both move alike."""
    found, _ = least_squares(
        lambda q: np.array([q.sum() - 1.0]),
        lambda q: np.ones((1, 2)),
        np.zeros(2),
        is_solved=small,
    )
    assert found == pytest.approx([0.5, 0.5], abs=1e-12)


@pytest.mark.parametrize("scaled", [False, True])
def test_where_there_is_no_solution_the_best_fit_is_returned(scaled):
    """Lines x = 0, x = 1, 1e3 y = 2: the fit is exact in y and half way in x."""
    matrix = np.array([[1.0, 0.0], [1.0, 0.0], [0.0, 1e3]])
    wanted = np.array([0.0, 1.0, 2.0])
    found, left = least_squares(
        lambda q: matrix @ q - wanted,
        lambda q: matrix,
        np.array([3.0, 3.0]),
        is_solved=small,
        scaled=scaled,
    )
    assert found == pytest.approx([0.5, 2e-3], abs=1e-7)
    assert left == pytest.approx([0.5, -0.5, 0.0], abs=1e-6)


def test_steps_into_what_is_not_defined_are_shortened():
    """sqrt(x) = 0.1 from 4: Gauss-Newton's first step would end below zero."""

    def residual(q):
        with np.errstate(invalid="ignore"):
            return np.sqrt(q) - 0.1

    found, _ = least_squares(
        residual, lambda q: np.diag(0.5 / np.sqrt(q)), np.array([4.0]), is_solved=small
    )
    assert found == pytest.approx([0.01], abs=1e-12)


def powell(q):
    x, y = q
    return np.array([1e4 * x * y - 1.0, np.exp(-x) + np.exp(-y) - 1.0001])


def powell_slopes(q):
    x, y = q
    return np.array([[1e4 * y, 1e4 * x], [-np.exp(-x), -np.exp(-y)]])


def rosenbrock(q):
    x, y = q
    return np.array([10.0 * (y - x * x), 1.0 - x])


def rosenbrock_slopes(q):
    return np.array([[-20.0 * q[0], 10.0], [-1.0, 0.0]])


@pytest.mark.parametrize(
    ("residual", "jacobian", "start", "solution"),
    [
        (powell, powell_slopes, [0.0, 1.0], [1.098159e-5, 9.106146]),
        (rosenbrock, rosenbrock_slopes, [-1.2, 1.0], [1.0, 1.0]),
    ],
)
def test_problems_of_the_collection_by_more_garbow_and_hillstrom(
    residual, jacobian, start, solution
):
    """Moré, Garbow, Hillstrom (1981), ACM Trans. Math. Softw. 7(1), problems 1 and 3."""
    found, left = least_squares(residual, jacobian, np.array(start), is_solved=small, scaled=True)
    assert found == pytest.approx(solution, rel=1e-6)
    assert np.abs(left).max() < 1e-12


def test_residuals_whose_squares_overflow_end_without_a_warning():
    found, left = least_squares(
        lambda q: np.array([q[0] - 7e307, 3e200 * q[0]]),
        lambda q: np.array([[1.0], [3e200]]),
        np.array([1.0]),
        is_solved=small,
    )
    assert np.isfinite(found).all()
    assert np.isfinite(left).all()
