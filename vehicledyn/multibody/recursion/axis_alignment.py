"""Link axes chosen so that a turn between two joints is two turns about axes of the frames.

The axes of a link may stand at any constant angle about its joint. One choice makes the
fixed turn B between its joint and the next B = turn(m, b) turn(k, c) with m across both joint
axes (the twist of Denavit, Hartenberg 1955); c then adds to the next coordinate. Recursions
spare a third of their work on such a tree. Positions of origins stay, because common normals
are undefined where joints are parallel.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vehicledyn.multibody.model.bodies import Body
from vehicledyn.multibody.model.parts import Wrench
from vehicledyn.multibody.model.tree import Link, Tree
from vehicledyn.multibody.recursion import inertia
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar
from vehicledyn.symbolic.parameters import ParameterTable

_PARALLEL = 1e-3
"""Sine between joints, at the table's values, below which their common normal is not used."""


@dataclass(frozen=True)
class AlignedTree:
    """A tree of the same motion with other axes: v_old = turns[link] v_new where turned."""

    tree: Tree
    turns: dict[int, Mat]

    def wrenches(self, given: Sequence[Wrench]) -> list[Wrench]:
        """Return wrenches in the new axes of their bodies."""
        return [self._turned(wrench) for wrench in given]

    def then(self, further: AlignedTree) -> AlignedTree:
        """Return a tree that was made of this one as made of the tree that this was made of."""
        turns = dict(self.turns)
        for link, turn in further.turns.items():
            turns[link] = turns[link] @ turn if link in turns else turn
        return AlignedTree(further.tree, turns)

    def _turned(self, wrench: Wrench) -> Wrench:
        turn = self.turns.get(self.tree.body_link[wrench.body])
        if turn is None:
            return wrench
        return Wrench(wrench.body, turn.T @ wrench.force, turn.T @ wrench.torque)


def align(tree: Tree, table: ParameterTable) -> AlignedTree:
    """Return the tree with the axes of its links turned about their joints where that helps.

    A link with several others on it is aligned with the first of them that has an oblique
    joint. The angles are functions of the parameters; they are smooth but where, at other
    values than those of the table, two joints become parallel.
    """
    links = list(tree.links)
    beyond: dict[int, list[int]] = defaultdict(list)
    for index, item in enumerate(links):
        beyond[item.parent].append(index)
    oblique = _oblique(tree, table)
    turns: dict[int, Mat] = {}
    for index, item in enumerate(tree.links):
        guide = next((k for k in beyond[index] if k in oblique), None)
        if guide is None or item.turns_about is None:
            continue
        angle = _angle(item.turns_about, links[guide])
        turns[index] = turn = rotations.turn(item.turns_about, angle)
        links[index] = _with_axes(links[index], turn, angle)
        for k in beyond[index]:
            links[k] = _hung(links[k], turn)
        links[guide] = _elementary(links[guide], item.turns_about)
    return AlignedTree(replace(tree, links=tuple(links)), turns)


def with_common_axis(tree: Tree) -> AlignedTree:
    """Return the tree with the axes of its links renamed so that joints turn about the third.

    Only where the fixed turns of a link and of all on it are general: there new names of the axes
    cost nothing, and make the steps of a recursion alike.
    """
    links = list(tree.links)
    beyond: dict[int, list[int]] = defaultdict(list)
    for index, item in enumerate(links):
        beyond[item.parent].append(index)
    turns: dict[int, Mat] = {}
    for index, item in enumerate(tree.links):
        concerned = [item, *(links[k] for k in beyond[index])]
        about = item.turns_about
        if not _is_plain(item) or item.joint is None or about in (None, _COMMON):
            continue
        if not all(_is_general(other) for other in concerned):
            continue
        turns[index] = turn = _renaming(about)
        joint = replace(item.joint, kind=f"R{_COMMON}")
        here = links[index]
        links[index] = replace(
            here, joint=joint, before=here.before @ turn, body=_in_axes(item.body, turn)
        )
        for k in beyond[index]:
            links[k] = _hung(links[k], turn)
    return AlignedTree(replace(tree, links=tuple(links)), turns)


_COMMON = 3


def _renaming(axis: int) -> Mat:
    """Return the turn, v_old = turn v_new, whose third new axis is an old one."""
    order = [axis % 3, (axis + 1) % 3, axis - 1]
    return rotations.columns(*(rotations.axis_vector(k + 1) for k in order))


def _is_general(item: Link) -> bool:
    """Return whether the fixed turn before a joint is about no axis of the frames."""
    return item.before is not None and rotations.elementary_axis(item.before) is None


def _oblique(tree: Tree, table: ParameterTable) -> set[int]:
    """Return the links that turn, on one that turns, about an axis a general turn leads to."""
    across: dict[int, list[Scalar]] = {}
    for index, item in enumerate(tree.links):
        parent = tree.links[item.parent] if item.parent >= 0 else None
        if parent is None or not (_is_plain(item) and _is_plain(parent)):
            continue
        if item.before is None or rotations.elementary_axis(item.before) is not None:
            continue
        if item.turns_about is not None and parent.turns_about is not None:
            axis, along = parent.turns_about - 1, item.turns_about - 1
            across[index] = [item.before[k, along] for k in range(3) if k != axis]
    symbols = ops.column([entry.symbol for entry in table.entries])
    column = ops.column([entry for pair in across.values() for entry in pair])
    values = ops.numeric([symbols], column)([entry.value for entry in table.entries])
    sines = np.hypot(values[0::2, 0], values[1::2, 0])
    return {index for index, sine in zip(across, sines, strict=True) if sine > _PARALLEL}


def _is_plain(item: Link) -> bool:
    """Return whether a link turns about one of its own axes."""
    return item.turns_about is not None and not item.is_ignorable_spin and item.after is None


def _middle(first: int, second: int) -> int:
    """Return an axis other than both."""
    return next(k for k in (1, 2, 3) if k not in (first, second))


def _angle(axis: int, beyond: Link) -> Scalar:
    """Return the angle about ``axis`` that brings the next joint across the middle axis [rad]."""
    about = beyond.turns_about
    if about is None or beyond.before is None:
        raise ValueError("only a turning joint beyond a turn can be aligned with")
    m = _middle(axis, about)
    other = next(k for k in (1, 2, 3) if k not in (axis, m))
    along, across = (beyond.before[k - 1, about - 1] for k in (other, m))
    sign = 1.0 if (axis, other, m) in ((1, 2, 3), (2, 3, 1), (3, 1, 2)) else -1.0
    return ops.atan2(sign * across, along)


def _with_axes(item: Link, turn: Mat, angle: Scalar) -> Link:
    """Return a link whose axes are turned about its joint."""
    return replace(item, phase=item.phase + angle, body=_in_axes(item.body, turn))


def _in_axes(body: Body | None, turn: Mat) -> Body | None:
    """Return a body described in axes turned by ``turn``."""
    if body is None or body.mass is None:
        return body
    com = turn.T @ ops.vector(*body.com)
    m = rotations.congruent(turn.T, inertia.matrix_of(body.inertia))
    elements = (m[0, 0], m[1, 1], m[2, 2], m[0, 1], m[0, 2], m[1, 2])
    return replace(body, com=(com[0], com[1], com[2]), inertia=elements)


def _hung(item: Link, turn: Mat) -> Link:
    """Return a link that hangs on a link whose axes were turned."""
    before = turn.T if item.before is None else turn.T @ item.before
    return replace(item, offset=turn.T @ item.offset, before=before)


def _elementary(item: Link, axis: int) -> Link:
    """Return a link whose fixed turn is turn(m, b) turn(k, c), the second in its coordinate."""
    k = item.turns_about
    if k is None or item.before is None:
        return item
    m = _middle(axis, k)
    matrix = item.before
    twist = _angle_of(matrix, m, k, column=True)
    phase = _angle_of(matrix, k, m, column=False)
    return replace(item, before=rotations.turn(m, twist), phase=item.phase + phase)


def _angle_of(matrix: Mat, axis: int, other: int, *, column: bool) -> Scalar:
    """Return the angle about ``axis`` from a row or column along ``other`` of turn(m) turn(k)."""
    i, j = axis % 3, (axis + 1) % 3
    n = other - 1
    if n == i:
        c, s = (matrix[i, n], matrix[j, n]) if column else (matrix[n, i], -matrix[n, j])
    else:
        c, s = (matrix[j, n], -matrix[i, n]) if column else (matrix[n, j], matrix[n, i])
    return ops.atan2(s, c)
