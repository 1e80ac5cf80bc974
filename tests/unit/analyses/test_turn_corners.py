"""Limits of turns at a corner of their curve move with what is reached there."""

import numpy as np
import pytest

from vehicledyn.analyses.handling.turn_limit import TurnCorner
from vehicledyn.base.errors import NumericalError

FIRST, SECOND = 0.8, 1.8
"""Parameters p_1 and p_2 of x² = λ p_1 - 3 max(y - p_2, 0) and y = λ² p_1: the limit is where
y = p_2, at λ = √(p_2 / p_1)."""


def _side(sign, *, further=0.0):
    """Return turns beside the corner; beyond it another law may begin to act, too."""
    value = np.sqrt(SECOND / FIRST)
    turns = []
    for k in (1, 2, 3):
        v = value + sign * 1e-4 * k
        x, acts = np.sqrt(value * FIRST) + sign * 2e-4 * k, float(sign > 0.0)
        rows = [
            [2.0 * x, 3.0 * acts, -FIRST],
            [further * acts, 1.0, -2.0 * v * FIRST],
        ]
        turns.append((v, acts, np.array(rows)))
    return tuple(turns)


def _pushed(value, acts):
    """Return the derivatives of both equations by both parameters."""
    return np.array([[-value, -3.0 * acts], [-value * value, 0.0]])


def test_the_limit_is_where_the_corner_is_reached():
    value = np.sqrt(SECOND / FIRST)
    scale, sizes = np.array([1.2, 2.0, 1.5]), np.array([FIRST, SECOND])
    corner = TurnCorner(value, _side(-1.0), _side(1.0), scale)
    exact = 0.5 * value * np.array([-1.0 / FIRST, 1.0 / SECOND])
    assert corner.slopes(_pushed, sizes) == pytest.approx(exact, rel=1e-10)


def test_two_corners_at_once_are_refused():
    corner = TurnCorner(1.5, _side(-1.0), _side(1.0, further=1.0), np.ones(3))
    with pytest.raises(NumericalError, match="where corners meet"):
        corner.slopes(_pushed, np.ones(2))
