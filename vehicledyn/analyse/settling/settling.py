"""Whether a motion has settled, judged by its amplitude from one window of time to the next."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum

import numpy as np

MOST_WINDOWS = 32
"""Windows after which a motion is given up."""

_AT_ONCE = 1e-5
"""Relative change from one window to the next with which a motion has settled."""

_LEFT = 1e-4
"""Relative change still to come, as it is foreseen, with which a motion has settled."""

_BLOCK, _SHRINKING = 3, 0.8
"""Windows whose largest change counts, and how far it shrinks to the next as many at least."""

_GONE = 0.02
"""Part of the largest amplitude below which a motion is gone."""

_LOOKED_BACK = 8
"""Windows over which a motion that does not repeat is compared with the same number before."""

_DRIFT, _SPREAD_KEPT = 0.25, 0.5
"""Largest change of the mean amplitude, part of its spread, with which a motion does not go
anywhere, and how far the spread of one that settles shrinks from one comparison to the next."""

_TURNS = 2
"""Turns of the amplitude in that time, which one that dies slowly does not make."""


class Ending(StrEnum):
    """How the simulation of a motion ended."""

    SETTLED = "settled"
    GONE = "died away"
    WANDERS = "does not repeat"
    SLOW = "not settled"
    CUT = "cut short"
    STOPPED = "stopped by an event"


_REPEATED = 2e-3
"""Part of the amplitude by which the last period of a settled motion may miss the one before."""


def judged(sizes: Sequence[float], gap: float) -> Ending | None:
    """Return how a motion with such amplitudes of one window after the other ends.

    ``gap`` is by what part of the amplitude the last period differs from the one before.

    Changes that shrink are foreseen to go on shrinking as they do, by the same factor from each
    few windows to the next: so do disturbances of a cycle, by its slowest Floquet multiplier. None
    where it has to go on. One that lasts has a spread, see :func:`spread`.
    """
    last = sizes[-1]
    if last <= _GONE * max(sizes):
        return Ending.GONE
    if gap < _REPEATED and _has_settled(sizes):
        return Ending.SETTLED
    if _wanders(sizes):
        return Ending.WANDERS
    return Ending.SLOW if len(sizes) >= MOST_WINDOWS else None


def _has_settled(sizes: Sequence[float]) -> bool:
    """Return whether the amplitude changes no more, and will not."""
    last = sizes[-1]
    if len(sizes) > 1 and abs(last - sizes[-2]) < _AT_ONCE * last:
        return True
    left = remaining_change(sizes)
    return left is not None and left < _LEFT * last


def remaining_change(sizes: Sequence[float]) -> float | None:
    """Return by how much an amplitude will still change; None where changes do not shrink."""
    if len(sizes) <= 2 * _BLOCK:
        return None
    changes = np.abs(np.diff(sizes[-2 * _BLOCK - 1 :])).reshape(2, _BLOCK).max(axis=1)
    if not changes[1] < _SHRINKING * changes[0]:
        return None
    factor = changes[1] / changes[0]
    return float(_BLOCK * changes[1] * factor / (1.0 - factor))


def spread(sizes: Sequence[float]) -> float:
    """Return by what part of itself the amplitude varies in the last windows."""
    return float(np.ptp(sizes[-_LOOKED_BACK:]) / sizes[-1]) if sizes[-1] else 0.0


def _wanders(sizes: Sequence[float]) -> bool:
    """Return whether amplitudes vary without going anywhere."""
    if len(sizes) < 2 * _LOOKED_BACK:
        return False
    before, last = np.array(sizes[-2 * _LOOKED_BACK :]).reshape(2, _LOOKED_BACK)
    if np.count_nonzero(np.diff(np.sign(np.diff(last)))) < _TURNS:
        return False
    drift = abs(last.mean() - before.mean())
    return bool(drift < _DRIFT * np.ptp(last) and np.ptp(last) > _SPREAD_KEPT * np.ptp(before))
