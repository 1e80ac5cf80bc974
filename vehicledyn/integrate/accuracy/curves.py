"""How far curves of two runs lie apart, but for moments that come a little earlier or later.

A step that is too long makes an oscillation a little slower, and what is left of that at the end of
a run is a shift in time, as an extreme of it is the same. So a curve counts as met where the other
one gets to its value within a small part of the time that has passed. A run that goes another way,
behind a force that jumps for example, is not met, though its extremes may be the same.
"""

from __future__ import annotations

import numpy as np

from vehicledyn.kernel.engine import Vector

_CLOCK = 0.02
"""Part of the time that has passed by which moments may shift."""


def curves_apart(one: Vector, other: Vector) -> Vector:
    """Return the largest distance of curves, shape (n_channels,).

    Parameters
    ----------
    one, other
        Samples of channels at the same equal times from the start of the run, shape (n_samples,
        n_channels). A channel that is no number at some time has no distance.

    Notes
    -----
    The distance at a sample is that from the range of the other curve over the samples around,
    which are a fiftieth of those since the start to either side, rounded up by less than twice.
    Behind the end curves go on as they came, turned round, as they would if they were late.
    """
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    worst = np.zeros(one.shape[1])
    sound = np.isfinite(one).all(axis=0) & np.isfinite(other).all(axis=0)
    one, other = one[:, sound], other[:, sound]
    found, first, reach, count = np.zeros(one.shape[1]), 0, 1, len(one)
    while first < count:
        last = min(count, int(reach / _CLOCK) + 1)
        begin = max(0, first - reach)
        inside, size = slice(first - begin, last - begin), 2 * reach + 1
        for curve, other_curve in ((one, other), (other, one)):
            met, own = _continued(other_curve, last + reach)[begin:], curve[first:last]
            low = minimum_filter1d(met, size, axis=0, mode="nearest")[inside]
            high = maximum_filter1d(met, size, axis=0, mode="nearest")[inside]
            found = np.maximum(found, np.maximum(low - own, own - high).max(axis=0))
        first, reach = last, 2 * reach
    worst[sound] = found
    return worst


def _continued(curves: Vector, count: int) -> Vector:
    """Return the first samples of curves, and some behind their end by odd reflection there."""
    missing = count - len(curves)
    if missing <= 0:
        return curves[:count]
    beyond = min(missing, len(curves) - 1)
    more: Vector = 2.0 * curves[-1] - curves[-2 : -2 - beyond : -1]
    return np.concatenate([curves, more])
