"""The frame in which vehicles are described: the design of a track, smooth in its accelerations.

What is described relative to a moving frame feels that frame's accelerations. Where the twist,
the gradient or the curvature of a track jumps, so do the rates of its own frame, and a step of
integration sees nothing of such an impulse. This frame goes through that of the design at knots
some wheelbase apart, by splines of degree five, so that its accelerations have two continuous
derivatives; a few knots away from a kink the two frames agree. Wheels meet the rails themselves.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, factorial

import numpy as np
from numpy.typing import NDArray

from vehicledyn.rail.track.alignment import Alignment
from vehicledyn.rail.track.track import CentreLine
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.tables import CurveTable

Array = NDArray[np.float64]

WIDTH = 1.0
"""Distance of the knots on all but the tightest curves [m]."""

TURN = 0.1
"""Change of heading between two knots that is not exceeded [rad]."""

MOST_KNOTS = 200_000
_DEGREE = 5
_BEYOND = 24
"""Knots beyond either end of the design; the spline's own ends fade away over them."""


@dataclass(frozen=True)
class RidingLine:
    """Six coordinates of a frame over the chainage; None is zero everywhere.

    Parameters
    ----------
    x, y, z
        Place of the frame, world axes [m].
    yaw, pitch, roll
        Its angles, R = Rz Ry Rx [rad].
    """

    x: CurveTable
    y: CurveTable | None
    z: CurveTable | None
    yaw: CurveTable | None
    pitch: CurveTable | None
    roll: CurveTable | None

    def coordinates(self, s: Scalar) -> tuple[Scalar, ...]:
        """Return x, y, z [m], yaw, pitch and roll [rad] at a chainage [m]."""
        tables = (self.x, self.y, self.z, self.yaw, self.pitch, self.roll)
        return tuple(ops.scalar(0.0 if table is None else table.value(s)) for table in tables)


def riding_line(design: Alignment) -> RidingLine:
    """Return the smooth frame of a design."""
    tightest = float(np.abs(design.curvature(np.linspace(0.0, design.length, 2001))).max())
    width = min(WIDTH, TURN / tightest) if tightest > 0.0 else WIDTH
    count = ceil(min(design.length / width, MOST_KNOTS))
    step = design.length / count
    knots = step * np.arange(-_BEYOND, count + _BEYOND + 1.0)
    plan = design.plan(knots)
    slope = 0.5 * (design.gradient(knots, "before") + design.gradient(knots))
    values = {
        "x": plan[0],
        "y": plan[1],
        "z": design.height(knots),
        "yaw": design.heading(knots),
        "pitch": -np.arctan(slope),
        "roll": -np.arcsin(design.cant(knots) / design.cant_base),
    }
    return RidingLine(
        **{name: _spline(name, knots, step, value) for name, value in values.items()}  # type: ignore[arg-type]
    )


def rounding(line: CentreLine, places: Array) -> Array:
    """Return by how much the smooth frame differs from that of the track within half a metre.

    Parameters
    ----------
    line
        The centre line.
    places
        Chainages, shape (n,) [m].

    Returns
    -------
    Array
        The largest difference near each, of place or angle, shape (n,) [m or rad].
    """
    s = ops.symbol("s")
    frame, riding = line.frame(s), line.riding(s)
    yaw, pitch, roll = (rotations.turn(axis, riding[6 - axis]) for axis in (3, 2, 1))
    turn = yaw @ pitch @ roll
    apart = [frame.position[k] - riding[k] for k in range(3)]
    apart += [frame.rotation[i, k] - turn[i, k] for i in range(3) for k in range(3)]
    evaluate = ops.numeric([s], ops.column(apart))
    near = np.asarray(places, dtype=float)[:, None] + np.linspace(-0.5 * WIDTH, 0.5 * WIDTH, 11)
    sizes: Array = np.abs(evaluate(near.reshape(1, -1))).max(axis=0)
    largest: Array = sizes.reshape(near.shape).max(axis=1)
    return largest


def _spline(name: str, knots: Array, step: float, values: Array) -> CurveTable | None:
    if not np.any(values):
        return None
    from scipy.interpolate import make_interp_spline

    number = np.arange(len(knots), dtype=float)
    spline = make_interp_spline(number, values, k=_DEGREE)
    begins = number[_DEGREE:-_DEGREE]
    cells = [spline(begins, nu=k) / factorial(k) for k in range(_DEGREE + 1)]
    return CurveTable(
        f"{name} of the riding frame", float(knots[_DEGREE]), step, np.stack(cells, axis=1)
    )
