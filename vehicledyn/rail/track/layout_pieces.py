"""From segments of a track to the pieces of its design, and what is wrong with them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from vehicledyn.rail.track.pieces import Grade, TrackPiece
from vehicledyn.rail.track.segments import SegmentSet


class TrackState(NamedTuple):
    """Curvature [1/m], cant [m], and shifts of both rails to the left [m], at a place."""

    curvature: float
    cant: float
    left: float
    right: float


STRAIGHT = TrackState(0.0, 0.0, 0.0, 0.0)
HIGHEST_CANT = 0.4
"""Cant by the gauge beyond which it is taken for a mistake, such as metres for millimetres."""

TIGHTEST = 2.0
"""Radius of a curve by the gauge below which it is taken for a mistake."""

WIDEST = 0.1
"""Widening beyond which it is taken for a mistake [m]."""

STEEPEST = 0.5
"""Gradient beyond which it is taken for a mistake, such as per mille for a pure number [1]."""

_EQUAL = 1e-9


class LayoutFault(NamedTuple):
    """What is wrong with a segment or change of gradient: its number from zero, field, words."""

    number: int
    field: str
    words: str


def pieces_of(
    segments: Sequence[SegmentSet], gauge: float
) -> tuple[list[TrackPiece], list[LayoutFault]]:
    """Return the pieces of a layout and the faults of its segments.

    A transition leads from the segment before it to the one after. At either end of the track,
    and between two transitions, it begins or ends straight and level.
    """
    faults = [fault for k, s in enumerate(segments) for fault in _faults_of(k, s, gauge)]
    if faults:
        return [], faults
    pieces = []
    for k, segment in enumerate(segments):
        first, last = _ends(segments, k)
        bends, cant, left, right = zip(first, last, strict=True)
        if segment.kind == "ramp":
            bends = (min(bends, key=abs),) * 2
        shape = segment.shape or "linear"
        pieces.append(TrackPiece(segment.length, bends, cant, left, right, shape))
        faults += _transition_faults(k, segment, bends)
    return pieces, [*faults, *_jumps(segments, pieces)]


def grade_faults(grades: Sequence[Grade]) -> list[LayoutFault]:
    """Return the faults of changes of the gradient, by their numbers."""
    faults, before, slope = [], float("-inf"), 0.0
    for k, grade in enumerate(grades):
        half = 0.5 * grade.radius * abs(grade.slope - slope)
        if abs(grade.slope) > STEEPEST:
            words = f"a gradient of {grade.slope:g} is too steep for rails; is it in per mille?"
            faults.append(LayoutFault(k, "slope", words))
        elif grade.at - half < before - _EQUAL:
            words = (
                f"begins {grade.at - half:g} m along the track, before the change ahead of it has "
                f"ended at {before:g} m; sort the changes or take smaller radii"
            )
            faults.append(LayoutFault(k, "radius" if half > 0.0 else "at", words))
        before, slope = grade.at + half, grade.slope
    return faults


def _faults_of(k: int, segment: SegmentSet, gauge: float) -> list[LayoutFault]:
    if segment.constant is None:
        return []
    curvature, cant, widening = segment.constant
    faults = []
    if abs(curvature) * TIGHTEST * gauge >= 1.0:
        radius = getattr(segment, "radius", 0.0)
        words = f"a curve of {radius:g} m is too tight for a gauge of {1e3 * gauge:g} mm"
        faults.append(LayoutFault(k, "radius", words))
    if abs(cant) > HIGHEST_CANT * gauge:
        words = (
            f"a cant of {1e3 * cant:g} mm does not go with a gauge of {1e3 * gauge:g} mm; "
            "write the unit, such as 100 mm"
        )
        faults.append(LayoutFault(k, "cant", words))
    if abs(widening) > WIDEST:
        words = f"a widening by {1e3 * widening:g} mm is too much; write the unit, such as 10 mm"
        faults.append(LayoutFault(k, "widening", words))
    return faults


def _ends(segments: Sequence[SegmentSet], k: int) -> tuple[TrackState, TrackState]:
    own = _state(segments[k])
    if own is not None:
        return own, own
    before = _state(segments[k - 1]) if k > 0 else None
    after = _state(segments[k + 1]) if k + 1 < len(segments) else None
    return before or STRAIGHT, after or STRAIGHT


def _state(segment: SegmentSet) -> TrackState | None:
    """Return the state all along a segment, None for a transition.

    The rail inside a curve carries its widening; on a straight either rail carries half.
    """
    if segment.constant is None:
        return None
    curvature, cant, widening = segment.constant
    inner = float((curvature > 0.0) - (curvature < 0.0))
    return TrackState(
        curvature, cant, 0.5 * (1.0 + inner) * widening, -0.5 * (1.0 - inner) * widening
    )


def _transition_faults(
    k: int, segment: SegmentSet, bends: tuple[float, float]
) -> list[LayoutFault]:
    if segment.kind != "cubic_parabola":
        return []
    if 0.0 not in bends:
        words = "a cubic parabola leads from a straight to an arc or back; take a clothoid here"
        return [LayoutFault(k, "kind", words)]
    bend = max(map(abs, bends))
    if bend * segment.length >= 1.0:
        words = f"is too long for a cubic parabola to a curve of {1.0 / bend:g} m; take a clothoid"
        return [LayoutFault(k, "length", words)]
    return []


def _jumps(segments: Sequence[SegmentSet], pieces: Sequence[TrackPiece]) -> list[LayoutFault]:
    """Return where cant or gauge change at once."""
    faults = []
    for k in range(1, len(pieces)):
        before, after = pieces[k - 1], pieces[k]
        if abs(before.cant[1] - after.cant[0]) > _EQUAL:
            was, becomes = (1e3 * c for c in (before.cant[1], after.cant[0]))
            words = f"the cant jumps from {was:g} mm to {becomes:g} mm"
            field = "cant" if segments[k].constant else "kind"
            faults.append(LayoutFault(k, field, f"{words}; put a transition or a ramp in between"))
        elif max(_leap(before.left, after.left), _leap(before.right, after.right)) > _EQUAL:
            words = "a rail jumps sideways, as the widening changes at once"
            field = "widening" if segments[k].constant else "kind"
            faults.append(LayoutFault(k, field, f"{words}; put a transition or a ramp in between"))
    return faults


def _leap(before: tuple[float, float], after: tuple[float, float]) -> float:
    return abs(after[0] - before[1])
