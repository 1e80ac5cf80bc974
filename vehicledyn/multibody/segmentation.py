"""Sub-system segmentation: what hangs on a carrying body, condensed to that body's motion.

The equations of a sub-system in its independent coordinates y and the acceleration A = (a, α)
of the body that carries it (book, chapter 4.4),

    [ M   Fᵀ ] [ ÿ ]   [ c ]   [ 0 ]
    [ F   I  ] [ A ] + [ p ] = [ W ],

give ÿ = -M⁻¹ (c + Fᵀ A) and the wrench W = (I - F M⁻¹ Fᵀ) A + p - F M⁻¹ c that the carrier must
supply. Sub-systems that constraints tie together form one segment; the others know nothing of
each other. The carrier and all below it then are an open tree with a few bodies.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

from vehicledyn.base.errors import InputError
from vehicledyn.multibody import articulated, inertia
from vehicledyn.multibody.articulated import ArticulatedInertia
from vehicledyn.multibody.dynamics import JointWrench, needed_wrenches, unit_column
from vehicledyn.multibody.forward import Formulation, TreeProblem, solve_closed
from vehicledyn.multibody.tree import Tree
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.elimination import Condensed, Rows, condense_symmetric
from vehicledyn.symbolic.ops import Scalar, Vec

Influence = dict[str, dict[str, Scalar]]
_SIX = 6
_ENOUGH = 3
"""Free coordinates of a carrier from which on segments need fewer operations."""


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


_BLOCKS = ((0, 0), (0, 3), (3, 3))


def solve_loops(
    problem: TreeProblem,
    independent: list[str],
    influence: Influence,
    formulation: Formulation = "auto",
) -> dict[str, Scalar]:
    """Return the independent accelerations of a system with loops by name.

    By sub-systems where a body with enough freedom of its own carries all loops, for then the
    columns of their coordinates need not be passed on below it; from one mass matrix else.
    Parameters are those of :func:`segmented_accelerations`.
    """
    tree = problem.kinematics.tree
    carrier = find_carrier(tree, influence)
    if formulation == "auto" and _freedom(problem, carrier) >= _ENOUGH:
        return segmented_accelerations(problem, carrier, independent, influence)
    return solve_closed(problem, independent, influence)


def find_carrier(tree: Tree, influence: Influence) -> int:
    """Return the outermost link that carries all coordinates of loops, -1 for the ground."""
    tied = {
        name
        for dependent, row in influence.items()
        for name in (dependent, *row)
        if name == dependent or not row[name].is_zero()
    }
    paths = [
        tree.path(item.parent)
        for item in tree.links
        if item.joint is not None and item.joint.name in tied
    ]
    shared = -1
    for step in zip(*paths, strict=False):
        if len(set(step)) > 1:
            break
        shared = step[0]
    return shared


def _freedom(problem: TreeProblem, carrier: int) -> int:
    """Return the number of free coordinates of a link and those below it."""
    tree = problem.kinematics.tree
    joints = [tree.links[link].joint for link in tree.path(carrier) if link >= 0]
    return sum(joint is not None and joint.name in problem.free for joint in joints)


def segmented_accelerations(
    problem: TreeProblem, carrier: int, independent: list[str], influence: Influence
) -> dict[str, Scalar]:
    """Return the independent accelerations of a system whose sub-systems hang on one body.

    Parameters
    ----------
    problem
        The tree at zero independent accelerations.
    carrier
        The link that carries the sub-systems, all branches beyond it; -1 for the ground.
    independent
        Names of the independent coordinates.
    influence
        For each dependent coordinate, by name {independent: entry of B in q̇_u = B q̇_v}.

    Raises
    ------
    InputError
        If a constraint ties a sub-system to more than the carrier and other sub-systems.
    """
    tree = problem.kinematics.tree
    branches = _branches(tree, carrier)
    beyond = {link for links in branches for link in links}
    needed = needed_wrenches(
        problem.kinematics, problem.wrenches, problem.gravity, problem.inertias
    )
    segments = [
        _segment(problem, carrier, links, needed, independent=independent, influence=influence)
        for links in _tied(tree, branches, influence, carrier)
    ]
    below = [link for link in range(len(tree.links)) if link not in beyond]
    found, moved = articulated.sweep(
        problem.kinematics,
        needed,
        problem.joint_forces,
        problem.inertias,
        set(problem.free),
        links=below,
        carried={carrier: [(s.inertia, s.wrench) for s in segments]} if carrier >= 0 else {},
    )
    for segment in segments:
        found.update(segment.accelerations(*moved[carrier]))
    return {name: found[name] for name in independent}


def _branches(tree: Tree, root: int) -> list[list[int]]:
    """Return the links of each branch beyond a link, parents first."""
    member: dict[int, int] = {}
    branches: list[list[int]] = []
    for link, item in enumerate(tree.links):
        if item.parent == root and link != root:
            member[link] = len(branches)
            branches.append([link])
        elif item.parent in member:
            member[link] = member[item.parent]
            branches[member[link]].append(link)
    return branches


def _tied(
    tree: Tree, branches: list[list[int]], influence: Influence, carrier: int
) -> list[list[int]]:
    """Return the links of each segment: branches joined where constraints tie them."""
    owner = {
        joint.name: k
        for k, links in enumerate(branches)
        for link in links
        if (joint := tree.links[link].joint) is not None
    }
    group = list(range(len(branches)))
    for dependent, row in influence.items():
        for name in (dependent, *(v for v, entry in row.items() if not entry.is_zero())):
            if name not in owner or dependent not in owner:
                raise InputError(
                    f"the constraints tie '{dependent}' to '{name}', which is not beyond "
                    f"'{tree.link_name(carrier)}'; choose another carrier"
                )
            old, new = group[owner[name]], group[owner[dependent]]
            group = [new if item == old else item for item in group]
    joined: dict[int, list[int]] = defaultdict(list)
    for k, links in enumerate(branches):
        joined[group[k]].extend(links)
    return [sorted(links) for links in joined.values()]


def _segment(
    problem: TreeProblem,
    root: int,
    links: list[int],
    needed: list[JointWrench],
    *,
    independent: list[str],
    influence: Influence,
) -> Segment:
    """Condense the links of one segment."""
    kinematics = problem.kinematics
    items = kinematics.tree.links
    composite = {link: problem.inertias[link] for link in links}
    composite[root] = inertia.nothing()
    lacking = {link: needed[link] for link in links}
    zero = ops.vector(0.0, 0.0, 0.0)
    lacking[root] = JointWrench(zero, zero)
    free = {
        joint.name for link in links if (joint := items[link].joint) and joint.name in problem.free
    }
    names = [name for name in independent if name in free]
    spread = {name: {names.index(name): ops.scalar(1.0)} for name in names}
    for name in free - set(names):
        row = influence[name]
        spread[name] = {names.index(v): e for v, e in row.items() if not e.is_zero()}
    n = len(names)
    rows: Rows = [{} for _ in range(n + _SIX)]
    side = [ops.scalar(0.0) for _ in range(n + _SIX)]
    for link in reversed(links):
        item, parent = items[link], items[link].parent
        rotation, arm = kinematics.link_rotation(link), kinematics.link_arm(link)
        wrench = lacking[link]
        if item.joint is not None and item.joint.name in free:
            along = wrench.torque if item.joint.is_rotation else wrench.force
            bias = ops.dot(kinematics.link_axis(link), along)
            bias = bias - problem.joint_forces.get(item.joint.name, 0.0)
            mine = spread[item.joint.name]
            for k, entry in mine.items():
                side[k] = side[k] - entry * bias
            entries, column = unit_column(kinematics, link, composite[link], free, stop=root)
            for name, value in entries.items():
                both = name == item.joint.name
                _add_products(rows, mine, spread[name], value, symmetric=not both)
            six = [*(column.force[k] for k in range(3)), *(column.torque[k] for k in range(3))]
            for k, entry in mine.items():
                for place, value in enumerate(six):
                    _add(rows, k, n + place, entry * value)
                    _add(rows, n + place, k, entry * value)
        composite[parent] = composite[parent] + composite[link].in_parent(rotation, arm)
        passed = rotation @ wrench.force
        turned = rotation @ wrench.torque + ops.cross(arm, passed)
        lacking[parent] = JointWrench(
            lacking[parent].force + passed, lacking[parent].torque + turned
        )
    rigid, wrench = ArticulatedInertia.of(composite[root]), lacking[root]
    for i in range(3):
        for j in range(3):
            _add(rows, n + i, n + j, rigid.linear[i, j])
            _add(rows, n + i, n + 3 + j, rigid.coupling[i, j])
            _add(rows, n + 3 + j, n + i, rigid.coupling[i, j])
            _add(rows, n + 3 + i, n + 3 + j, rigid.angular[i, j])
        side[n + i] = -wrench.force[i]
        side[n + 3 + i] = -wrench.torque[i]
    return Segment(names, condense_symmetric(rows, side, range(n, n + _SIX)))


def _add_products(
    rows: Rows,
    left: dict[int, Scalar],
    right: dict[int, Scalar],
    value: Scalar,
    *,
    symmetric: bool,
) -> None:
    """Add left valueᵀ right, and its transpose where the pair stands on one side only."""
    for i, a in left.items():
        for j, b in right.items():
            product = a * (value * b)
            _add(rows, i, j, product)
            if symmetric:
                _add(rows, j, i, product)


def _add(rows: Rows, i: int, j: int, value: Scalar) -> None:
    if not ops.scalar(value).is_zero():
        rows[i][j] = rows[i].get(j, 0.0) + value
