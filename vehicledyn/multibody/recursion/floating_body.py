"""A body that moves freely: its acceleration from its own six equations.

Where three slides and then three turns carry a body, the joints need no recursion: with its
articulated inertia I and the wrench W that it lacks, I A = -W gives its acceleration A, and A
the accelerations of the six coordinates one after the other.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.tree import Link, Tree
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.elimination import Rows, solve_in_order, solve_symmetric
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

_COORDINATES = 6


def floating_base(tree: Tree, is_idle: Callable[[int], bool]) -> int | None:
    """Return the link that three slides and then three turns carry from the ground, if any.

    Parameters
    ----------
    tree
        Links of the system, parents first.
    is_idle
        Whether a link has a free joint without a force on it. The links before the base must
        carry neither inertia nor load either; those of a body's own chain do not.
    """
    for link, item in enumerate(tree.links):
        path = tree.path(link)[1:]
        if item.body is None or len(path) != _COORDINATES or not all(map(is_idle, path)):
            continue
        chain = [tree.links[k] for k in path]
        inner = set(path[:-1])
        hanging = sum(other.parent in inner for other in tree.links)
        is_bare = hanging == len(inner) and all(other.body is None for other in chain[:-1])
        if is_bare and _is_free(chain):
            return link
    return None


def _is_free(chain: list[Link]) -> bool:
    """Return whether slides along all axes come first and turns that go on from one another."""
    if any(item.before is not None or item.after is not None for item in chain):
        return False
    slides, turns = {item.slides_along for item in chain[:3]}, [i.turns_about for i in chain[3:]]
    is_ball = all(item.type is not None and item.type.elements for item in chain[3:])
    return (
        None not in slides
        and len(slides) == len(chain[:3])
        and (is_ball or (None not in turns and all(a != b for a, b in pairwise(turns))))
        and not any(item.is_ignorable_spin for item in chain)
    )


def body_acceleration(inertia: tuple[Mat, Mat, Mat], force: Vec, torque: Vec) -> tuple[Vec, Vec]:
    """Return (a, α) of a free body that lacks a force and a torque, all in its axes.

    ``inertia`` are the blocks of force = L a + C α, torque = Cᵀ a + R α.
    """
    linear, coupling, angular = inertia
    rows: Rows = [{} for _ in range(6)]
    for i in range(3):
        for j in range(3):
            rows[i][j], rows[i][3 + j] = linear[i, j], coupling[i, j]
            rows[3 + i][j], rows[3 + i][3 + j] = coupling[j, i], angular[i, j]
    side = [-vector[k] for vector in (force, torque) for k in range(3)]
    found = solve_symmetric(rows, side)
    return ops.vector(*found[:3]), ops.vector(*found[3:])


def coordinate_accelerations(
    kinematics: Kinematics, link: int, linear: Vec, angular: Vec
) -> dict[str, Scalar]:
    """Return the accelerations of the six coordinates that carry a floating base.

    ``linear`` and ``angular`` are (a, α) of the base in its axes, counted from those at zero
    accelerations of its coordinates.
    """
    tree = kinematics.tree
    path = tree.path(link)[1:]
    world = kinematics.rotation_in(-1, link) @ linear
    found: dict[str, Scalar] = {}
    for k in path[:3]:
        along = tree.links[k].slides_along
        if along is not None:
            found[tree.links[k].name] = world[along - 1]
    turns = [tree.links[k] for k in path[3:]]
    if None in (item.turns_about for item in turns):
        return found | {item.name: angular[k] for k, item in enumerate(turns)}
    middle = path[4]
    # In the axes between the last two turns those two have constant axes.
    turned = kinematics.link_rotation(link) @ angular
    own = [kinematics.link_axes(k).angular for k in path[3:]]
    axes = [kinematics.link_rotation(middle).T @ own[0], *own[1:]]
    last, between = (about - 1 for item in turns[:0:-1] if (about := item.turns_about) is not None)
    across = 3 - last - between
    rows: Rows = [
        {c: axis[k] for c, axis in enumerate(axes) if not axis[k].is_zero()} for k in range(3)
    ]
    sides = [{0: turned[k]} for k in range(3)]
    order = [(across, 0), (between, 1), (last, 2)]
    solved = solve_in_order(rows, sides, order)
    return found | {item.name: row[0] for item, row in zip(turns, solved, strict=True)}
