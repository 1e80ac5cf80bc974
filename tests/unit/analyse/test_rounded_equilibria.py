"""Ends of Newton's method: what rounding leaves of large stiffness counts as zero, nothing else."""

import numpy as np
import pytest

from vehicledyn.analyse.newton import solve_damped

_ROUNDING = 32.0 * float(np.finfo(float).eps)
_STIFF = 1e9


def stiff(point):
    """Rates of a stiff pair whose exact zero, a third, is no number of the computer."""
    residual = np.array([_STIFF * (3.0 * point[0] - 1.0), point[1] - 2.0])
    return residual + np.array([3e-7, 0.0]), np.diag([3.0 * _STIFF, 1.0])


def unbalanced(point):
    """The same with a rate of 1e-8 that no state changes."""
    return np.array([_STIFF * (3.0 * point[0] - 1.0), 1e-8]), np.diag([3.0 * _STIFF, 0.0])


@pytest.mark.parametrize(("rounding", "solved"), [(0.0, False), (_ROUNDING, True)])
def test_rounding_of_large_forces_is_no_residual(rounding, solved):
    def noisy(point):
        residual, jacobian = stiff(point)
        return residual + np.array([4e-7 * np.sign(residual[0] + 1e-12), 0.0]), jacobian

    found = solve_damped(noisy, np.ones(2), tolerance=1e-9, rounding=rounding, persistent=False)
    assert found.solved == solved
    assert found.point == pytest.approx([1.0 / 3.0, 2.0], rel=1e-12)


def test_what_nothing_balances_is_refused():
    found = solve_damped(
        unbalanced, np.ones(2), tolerance=1e-9, rounding=_ROUNDING, persistent=False
    )
    assert not found.solved


def test_rounding_of_places_that_a_vanishing_state_hangs_on_is_no_residual():
    """A stiff spring's deflection of 1e-7 m is the difference of places half a metre away."""

    def noisy(point):
        residual = _STIFF * ((point + 0.5) - 0.5 - 1e-7) + 5e-8
        return residual, np.array([[_STIFF]])

    found = solve_damped(noisy, np.zeros(1), tolerance=1e-9, rounding=_ROUNDING, persistent=False)
    assert found.solved
    assert found.point[0] == pytest.approx(1e-7, abs=1e-15)
