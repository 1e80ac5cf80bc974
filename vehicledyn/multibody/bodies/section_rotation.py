"""How the section of a bent and twisted beam is turned."""

from __future__ import annotations

from collections.abc import Sequence

from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec


def section_rotation(slopes: Sequence[Scalar], has: Sequence[bool]) -> tuple[Mat, list[Vec]]:
    """Return the rotation of a section and its axes of rotation by v', w' and ϑ, in its own axes.

    In one plane without twist the rotation is a turn about the axis across the plane.
    """
    a, b, twist = slopes
    c = ops.sqrt(1.0 - a * a - b * b)
    nothing = ops.vector(0.0, 0.0, 0.0)
    if not has[1] and not has[2]:
        return rotations.turn_by(3, c, a), [ops.vector(0.0, 0.0, 1.0 / c), nothing, nothing]
    if not has[0] and not has[2]:
        return rotations.turn_by(2, c, -b), [nothing, ops.vector(0.0, -1.0 / c, 0.0), nothing]
    s = 1.0 / (1.0 + c)
    bend = rotations.matrix(
        [[c, -a, -b], [a, 1.0 - a * a * s, -a * b * s], [b, -a * b * s, 1.0 - b * b * s]]
    )
    # In the section's axes the shortest rotation turns with
    # (0, -ḃ, ȧ) - ċ s (0, -b, a) - s (a ḃ - b ȧ, 0, 0) at c² = 1 - a² - b².
    r = s / c
    by_a = ops.vector(b * s, -a * b * r, 1.0 + a * a * r)
    by_b = ops.vector(-a * s, -1.0 - b * b * r, a * b * r)
    turn = rotations.turn(1, twist) if has[2] else rotations.identity()
    whole = bend @ turn
    found = [turn.T @ by_a, turn.T @ by_b, ops.vector(1.0, 0.0, 0.0)]
    return whole, found
