"""What stands still: the name of the ground, as the parent of bodies and the end of links."""

from __future__ import annotations

from vehicledyn.symbolic import frames

GROUND = "ground"


def body_axes(body: str) -> str:
    """Return the label of the axes of a body; those of the ground are the world's."""
    return frames.WORLD if body == GROUND else frames.axes_of(body)
