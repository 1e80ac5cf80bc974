"""Irregularities of track: how alignment, level, cross level and gauge become those of rails.

Alignment is the shift of the middle between the rails to the left, level its shift upwards;
cross level is the height of the right rail over the left one, as cant; gauge is the excess of
the distance of the rails. So with them all the left rail is shifted by (a + g/2, z - c/2) to the
left and upwards, the right one by (a - g/2, z + c/2).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from vehicledyn.rail.track.track_tables import TabledShift
from vehicledyn.symbolic.tables import CurveTable

Array = NDArray[np.float64]

QUANTITIES = ("alignment", "level", "cross_level", "gauge")


def rails_of(start: float, step: float, records: Mapping[str, Array], fade: float) -> TabledShift:
    """Return the displacement of both rails, by splines through records at equal distances.

    Both ends fade to nothing, along 10 u³ - 15 u⁴ + 6 u⁵; beyond them there is none.

    Parameters
    ----------
    start, step
        Chainage of the first value and distance of the values [m].
    records
        Values of the quantities that are there, by name, all of shape (n,) [m].
    fade
        Length over which they come and go [m].
    """
    from scipy.interpolate import CubicSpline

    count = len(next(iter(records.values())))
    window = _window(step * np.arange(count, dtype=float), step * (count - 1), fade)
    nothing = np.zeros(count)
    a, z, c, g = (window * records.get(name, nothing) for name in QUANTITIES)

    def table(name: str, values: Array, *, known: bool) -> CurveTable | None:
        if not known:
            return None
        padded = np.concatenate([[0.0], values, [0.0]])
        spline = CubicSpline(np.arange(count + 2.0), padded, bc_type="clamped")
        return CurveTable(name, start - step, step, spline.c[::-1].T)

    across = "alignment" in records or "gauge" in records
    up = "level" in records or "cross_level" in records
    left_lateral = table("left rail across", a + 0.5 * g, known=across)
    right_lateral = table("right rail across", a - 0.5 * g, known="gauge" in records)
    left_vertical = table("left rail upwards", z - 0.5 * c, known=up)
    right_vertical = table("right rail upwards", z + 0.5 * c, known="cross_level" in records)
    return TabledShift(
        left_lateral=left_lateral,
        left_vertical=left_vertical,
        right_lateral=right_lateral if "gauge" in records else left_lateral,
        right_vertical=right_vertical if "cross_level" in records else left_vertical,
        ends=(start, start + step * (count - 1)),
    )


def _window(along: Array, length: float, fade: float) -> Array:
    if fade == 0.0:
        return np.ones(along.shape)
    u = np.clip(np.minimum(along, length - along) / fade, 0.0, 1.0)
    return np.asarray(u**3 * (10.0 + u * (6.0 * u - 15.0)))
