"""When a simulated motion has settled, is gone, or does not repeat."""

import numpy as np
import pytest

from vehicledyn.analyse.settling.settling import MOST_WINDOWS, Ending, judged, remaining_change


def ending_of(sizes, gap=0.0):
    """Return how a motion ends of which one window after the other is told, and after how many."""
    for count in range(1, len(sizes) + 1):
        if (ending := judged(sizes[:count], gap)) is not None:
            return ending, count
    return None, len(sizes)


@pytest.mark.parametrize("factor", [0.3, 0.6, 0.72, -0.7])
def test_changes_that_shrink_are_waited_for_until_little_is_left(factor):
    """The amplitude goes from 1.1 to 1 by a factor a window: at the end 1e-4 of it is left."""
    sizes = [1.0 + 0.1 * factor**k for k in range(60)]
    ending, count = ending_of(sizes)
    assert ending is Ending.SETTLED
    assert abs(sizes[count - 1] - 1.0) < 1e-4


def test_what_is_left_is_foreseen():
    """A factor of 0.8 a window: what is left is the sum of a geometric series."""
    sizes = [1.0 + 0.1 * 0.8**k for k in range(20)]
    assert remaining_change(sizes) >= sizes[-1] - 1.0
    assert remaining_change(sizes) == pytest.approx(sizes[-1] - 1.0, rel=1.0)
    assert remaining_change([1.0 + 0.01 * k for k in range(20)]) is None


def test_a_motion_that_dies_is_gone():
    ending, count = ending_of([0.5**k for k in range(30)])
    assert ending is Ending.GONE and count == 7


def test_equal_amplitudes_of_periods_that_differ_have_not_settled():
    """A motion of twice the period has the same amplitude in every window."""
    assert ending_of([1.0] * 10)[0] is Ending.SETTLED
    assert ending_of([1.0] * 10, gap=0.1)[0] is None


def test_a_motion_of_two_frequencies_does_not_repeat():
    sizes = list(1.0 + 0.02 * np.sin(1.9 * np.arange(40)))
    ending, count = ending_of(sizes, gap=0.01)
    assert ending is Ending.WANDERS and count < 20


def test_one_that_goes_on_and_on_is_given_up():
    sizes = [1.0 + 0.01 * k for k in range(100)]
    assert ending_of(sizes) == (Ending.SLOW, MOST_WINDOWS)
