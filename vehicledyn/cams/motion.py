"""The motion of a follower over a turn of the cam: laws one after the other."""

from __future__ import annotations

import math
from collections.abc import Sequence

from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.pieces import PieceCurve

TURN = 2.0 * math.pi
_CLOSED = 1e-9
"""What a turn may lack, over a full turn, and the rise, over the greatest one."""


def motion_of(laws: Sequence[MotionLaw]) -> PieceCurve:
    """Return the laws one after the other, over a turn.

    Raises
    ------
    ValueError
        If the laws do not make a turn or do not come back to where they begin.
    """
    begin = value = 0.0
    pieces, most = [], 0.0
    for law in laws:
        curve = law.placed(begin, value)
        pieces += list(curve.pieces)
        begin += law.over
        value += law.rise
        most = max(most, abs(value), abs(law.rise))
    _check_turn(begin, laws)
    if abs(value) > _CLOSED * most:
        shown = f"{math.degrees(value):.6g} deg" if _turns(laws) else f"{1e3 * value:.6g} mm"
        raise ValueError(
            f"the motion does not close: its laws rise by {shown} in all; make the falls as large "
            "as the rises"
        )
    if abs(begin - TURN) > 0.0:
        last = pieces[-1]
        pieces[-1] = last.changed(last.begin, TURN - last.begin, 1.0, 0.0)
    return PieceCurve(tuple(pieces))


def _check_turn(total: float, laws: Sequence[MotionLaw]) -> None:
    if abs(total - TURN) <= _CLOSED * TURN:
        return
    words = f"the laws take {math.degrees(total):.10g} deg in all, a turn has 360 deg; "
    short = TURN - total
    remedy = (
        f"add a dwell of {math.degrees(short):.10g} deg"
        if short > 0.0
        else f"shorten laws by {math.degrees(-short):.10g} deg"
    )
    raise ValueError(f"the motion does not close: {words}{remedy}")


def _turns(laws: Sequence[MotionLaw]) -> bool:
    return any(law.turns for law in laws)
