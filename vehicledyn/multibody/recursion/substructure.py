"""A sub-system condensed to the motion of the body that carries it.

The equations of a sub-system in its independent coordinates y and the acceleration A = (a, α)
of the body that carries it (book, chapter 4.4),

    [ M   Fᵀ ] [ ÿ ]   [ c ]   [ 0 ]
    [ F   I  ] [ A ] + [ p ] = [ W ],

give ÿ = -M⁻¹ (c + Fᵀ A) and the wrench W = (I - F M⁻¹ Fᵀ) A + p - F M⁻¹ c that the carrier must
supply.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

from vehicledyn.multibody.model.joint_wrench import JointWrench
from vehicledyn.multibody.recursion import inertia
from vehicledyn.multibody.recursion.articulated_inertia import ArticulatedInertia
from vehicledyn.multibody.recursion.forward_dynamics import TreeProblem
from vehicledyn.multibody.recursion.mass_matrix import unit_wrench
from vehicledyn.multibody.recursion.newton_euler import reflected_forces
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.elimination import Condensed, Rows, condense_symmetric
from vehicledyn.symbolic.ops import Scalar, Vec

Influence = dict[str, dict[str, Scalar]]
"""B of q̇_u = B q̇_v: for each dependent coordinate {independent: entry}."""

Columns = dict[int, JointWrench]
"""What a unit acceleration of each independent coordinate, by place, needs of a link."""

_SIX = 6
_BLOCKS = ((0, 0), (0, 3), (3, 3))


@dataclass(frozen=True)
class Segment:
    """A sub-system condensed to its carrier.

    ``names`` are its independent coordinates; ``condensed`` holds them at the places 0 to
    n - 1 and the carrier's acceleration (a, α) after them.
    """

    names: list[str]
    condensed: Condensed

    @property
    def inertia(self) -> ArticulatedInertia:
        """What the carrier feels as inertia, at its origin and in its axes."""
        n = len(self.names)

        def block(row: int, column: int) -> list[list[Scalar]]:
            rows = self.condensed.rows
            return [
                [rows[n + row + i].get(n + column + j, 0.0) for j in range(3)] for i in range(3)
            ]

        return ArticulatedInertia(*(rotations.matrix(block(i, j)) for i, j in _BLOCKS))

    @property
    def wrench(self) -> JointWrench:
        """What the carrier must supply when it does not accelerate [N, N m]."""
        side = [-value for value in self.condensed.side[len(self.names) :]]
        return JointWrench(ops.vector(*side[:3]), ops.vector(*side[3:]))

    def accelerations(self, linear: Vec, angular: Vec) -> dict[str, Scalar]:
        """Return those of the independent coordinates by name, given the carrier's."""
        motion = [*(linear[k] for k in range(3)), *(angular[k] for k in range(3))]
        known = {len(self.names) + k: value for k, value in enumerate(motion)}
        found = self.condensed.solution(known)
        return {name: found[k] for k, name in enumerate(self.names)}


def condense(
    problem: TreeProblem,
    root: int,
    links: list[int],
    needed: list[JointWrench],
    *,
    independent: list[str],
    influence: Influence,
) -> Segment:
    """Return a sub-system condensed to its carrier.

    Parameters
    ----------
    problem
        The tree at zero independent accelerations.
    root
        Link of the carrier, -1 for the ground.
    links
        Links of the sub-system, parents first: whole branches beyond the carrier.
    needed
        Wrench that each link of the tree lacks, at its origin and in its axes.
    independent, influence
        Independent coordinates of the whole system, and what they make of the others.
    """
    kinematics, items = problem.kinematics, problem.kinematics.tree.links
    names_of = {k: joint.name for k in links if (joint := items[k].joint) is not None}
    free = {name for name in names_of.values() if name in problem.free}
    names = [name for name in independent if name in free]
    bordered = _Bordered.of(names, {name: influence[name] for name in free - set(names)})
    zero = ops.vector(0.0, 0.0, 0.0)
    columns: dict[int, Columns] = defaultdict(dict)
    own = inertia.rigid([problem.inertias[k] for k in links])
    composite = {root: inertia.nothing(), **dict(zip(links, own, strict=True))}
    lacking = {root: JointWrench(zero, zero), **{k: needed[k] for k in links}}
    reflected, inertial = kinematics.tree.reflected_inertias, reflected_forces(kinematics)
    for link in reversed(links):
        item, name, wrench, mine = items[link], names_of.get(link), lacking[link], columns[link]
        if name in free:
            unit = unit_wrench(kinematics, link, composite[link])
            beyond = {place: column.along(kinematics, link) for place, column in mine.items()}
            inertia_felt = unit.along(kinematics, link) + reflected.get(name, 0.0)
            bordered.enter(name, beyond, inertia_felt)
            _add_to(mine, {k: unit.times(entry) for k, entry in bordered.spread[name].items()})
            force = wrench.along(kinematics, link) - problem.joint_forces.get(name, 0.0)
            bordered.push(name, force + inertial.get(name, 0.0))
        _add_to(columns[item.parent], {k: v.in_parent(kinematics, link) for k, v in mine.items()})
        rotation, arm = kinematics.link_rotation(link), kinematics.link_arm(link)
        moved = composite[link].in_parent(kinematics.link_turns(link), arm)
        composite[item.parent] = composite[item.parent] + moved
        lacking[item.parent] = lacking[item.parent].plus(wrench, rotation, arm)
    bordered.carry(ArticulatedInertia.of(composite[root]), lacking[root], columns[root])
    n = len(names)
    return Segment(names, condense_symmetric(bordered.rows, bordered.side, range(n, n + _SIX)))


@dataclass(frozen=True)
class _Bordered:
    """The matrix of M, F and I and its right-hand side, filled joint by joint.

    ``spread`` gives each coordinate {place of an independent one: entry of T}.
    """

    spread: dict[str, dict[int, Scalar]]
    rows: Rows
    side: list[Scalar]

    @classmethod
    def of(cls, names: list[str], influence: Influence) -> _Bordered:
        """Return an empty one for some independent coordinates."""
        place = {name: k for k, name in enumerate(names)}
        spread = {name: {k: ops.scalar(1.0)} for name, k in place.items()}
        for name, row in influence.items():
            spread[name] = {place[v]: entry for v, entry in row.items() if not entry.is_zero()}
        size = len(names) + _SIX
        return cls(spread, [{} for _ in range(size)], [ops.scalar(0.0)] * size)

    def enter(self, name: str, beyond: dict[int, Scalar], own: Scalar) -> None:
        """Add to TᵀMT what one coordinate brings.

        ``beyond`` is the force on it that the coordinates beyond need for a unit acceleration
        of each independent one, ``own`` what a unit acceleration of the coordinate needs.
        """
        for i, left in self.spread[name].items():
            for j, force in beyond.items():
                self._add(i, j, left * force)
                self._add(j, i, left * force)
            for j, right in self.spread[name].items():
                self._add(i, j, left * (own * right))

    def push(self, name: str, force: Scalar) -> None:
        """Add the force that a coordinate lacks."""
        for k, entry in self.spread[name].items():
            self.side[k] = self.side[k] - entry * force

    def carry(self, rigid: ArticulatedInertia, wrench: JointWrench, columns: Columns) -> None:
        """Add what the carrier feels: of each independent coordinate, and with all at rest."""
        n = len(self.rows) - _SIX
        for i, column in columns.items():
            for k, value in enumerate(_six(column)):
                self._add(i, n + k, value)
                self._add(n + k, i, value)
        for i in range(3):
            for j in range(3):
                self._add(n + i, n + j, rigid.linear[i, j])
                self._add(n + i, n + 3 + j, rigid.coupling[i, j])
                self._add(n + 3 + j, n + i, rigid.coupling[i, j])
                self._add(n + 3 + i, n + 3 + j, rigid.angular[i, j])
        for k, value in enumerate(_six(wrench)):
            self.side[n + k] = -value

    def _add(self, i: int, j: int, value: Scalar) -> None:
        if not value.is_zero():
            self.rows[i][j] = self.rows[i].get(j, 0.0) + value


def _add_to(columns: Columns, more: Columns) -> None:
    for place, wrench in more.items():
        columns[place] = columns[place].added_to(wrench) if place in columns else wrench


def _six(wrench: JointWrench) -> list[Scalar]:
    return [vector[k] for vector in (wrench.force, wrench.torque) for k in range(3)]
