"""What the design of a track is made of: pieces of its plan and changes of its gradient."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class TrackPiece:
    """A piece of track: pairs hold values at its beginning and at its end.

    ``shape`` is a name of :data:`~vehicledyn.rail.track.transition_shapes.SHAPES` or
    "cubic_parabola", of
    which one end must be straight. ``left`` and ``right`` are the shifts of both rails to the
    left, by which the gauge is wider [m].
    """

    length: float
    curvature: tuple[float, float] = (0.0, 0.0)
    cant: tuple[float, float] = (0.0, 0.0)
    left: tuple[float, float] = (0.0, 0.0)
    right: tuple[float, float] = (0.0, 0.0)
    shape: str = "linear"


@dataclass(frozen=True)
class Grade:
    """Where the gradient changes: at a chainage [m], to a slope [1], over an arc of a radius [m].

    The arc is a parabola that begins and ends half its length from the change.
    """

    at: float
    slope: float
    radius: float = 0.0
