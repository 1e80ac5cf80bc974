"""A search that circles with its objective still is noticed, one that goes on is not."""

import numpy as np
import pytest

from vehicledyn.analyse.interior_point import NonlinearProgram, Pattern
from vehicledyn.analyse.optimal_control.standstill import Iterate, Standstill, StandstillError


def search(objectives, violations):
    """Return how many iterates of a search are seen, and the one that it circles about."""
    still = Standstill(1e-6)
    for number, (objective, violation) in enumerate(zip(objectives, violations, strict=True)):
        try:
            still.look(Iterate(np.array([number]), objective, violation, 0.0))
        except StandstillError:
            return still.count, still.best
    return still.count, None


def test_a_search_that_circles_ends_at_what_keeps_its_constraints_best():
    """As the sedan's lap of an oval did, to and fro between a motion and its neighbours."""
    objectives = [30.0, 25.0, *[23.4324794, 23.4324774] * 40]
    violations = [1e-1, 1e-9, *[1e-10, 2e-4, 1e-11, 4e-4] * 20]
    count, best = search(objectives, violations)
    assert count == 32
    assert best.violation == 1e-11


@pytest.mark.parametrize(
    ("objectives", "violations"),
    [
        (30.0 - 1e-4 * np.arange(100), np.full(100, 1e-9)),
        (np.full(100, 23.4), np.full(100, 1e-4)),
    ],
)
def test_a_search_that_goes_on_or_keeps_no_constraint_is_left_alone(objectives, violations):
    assert search(objectives, violations) == (100, None)


def test_the_gap_is_what_bounds_that_do_not_act_hold_back():
    """x - μ ln x, least at x = μ with a multiplier of 1, is μ above the least x of zero."""
    none = Pattern(np.zeros(0, dtype=int), np.zeros(2, dtype=int))
    program = NonlinearProgram(
        (np.array([0.0]), np.array([np.inf])), (np.zeros(0), np.zeros(0)), None, None, none
    )
    assert program.gap(np.array([1e-3]), np.zeros(0), (np.array([-1.0]), np.zeros(0))) == 1e-3
    assert program.n_gaps == 1
