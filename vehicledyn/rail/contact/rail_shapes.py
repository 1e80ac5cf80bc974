"""What wheels on rails look like: rims with flanges, the axle between them, their forces."""

from __future__ import annotations

from collections.abc import Sequence

from vehicledyn.base.shapes import Anchor, Force, Shape, Tube, Wheel
from vehicledyn.rail.track.track import Side
from vehicledyn.symbolic.ops import Scalar

WIDTH = 0.135
"""Width of the rim of railway wheels [m], EN 13715."""

_AXLE_RADIUS, _JOURNAL = 0.085, 0.3


def rail_wheel_shapes(
    name: str, body: str, sides: Sequence[Side], *, radius: Scalar, tape_circle: Scalar
) -> tuple[Shape, ...]:
    """Return the wheels of a body, its axle, and the forces of the rails on the wheels.

    Parameters
    ----------
    name
        Name of the part; its channels ``<side>.Y`` and ``<side>.Q`` are the forces on the rails.
    body
        The body: its y axis is the axle, its origin the middle.
    sides
        Sides on which it has a wheel.
    radius, tape_circle
        Rolling radius and distance of the tape circles from the origin along the axle [m].
    """
    shapes: list[Shape] = []
    ends = [tape_circle + _JOURNAL if side == "left" else -tape_circle - _JOURNAL for side in sides]
    if len(sides) == 1:
        ends.append(0.0)
    a, b = (Anchor(body, (0.0, end, 0.0)) for end in ends)
    shapes.append(Tube(f"{name}.axle", a, b, _AXLE_RADIUS, style="steel"))
    for side in sides:
        out = 1.0 if side == "left" else -1.0
        place = Anchor(body, (0.0, out * tape_circle, 0.0))
        shapes.append(Wheel(f"{name}.{side}", place, (0.0, out, 0.0), radius, WIDTH, style="rail"))
        foot = Anchor(body, (0.0, out * tape_circle, -radius))
        forces = (None, f"{name}.{side}.Y", f"{name}.{side}.Q")
        shapes.append(Force(f"{name}.{side}", foot, forces, axes="body", factors=(-1.0, -1.0, 1.0)))
    return tuple(shapes)
