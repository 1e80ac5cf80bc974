"""Accelerations of a tree, open or with its loops closed, by the cheaper formulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import Wrench
from vehicledyn.multibody.model.tree import Link
from vehicledyn.multibody.recursion import articulated_body as articulated
from vehicledyn.multibody.recursion.axis_alignment import AlignedTree, align, with_common_axis
from vehicledyn.multibody.recursion.barycentric import augmented_inertias
from vehicledyn.multibody.recursion.body_inertia import BodyInertia
from vehicledyn.multibody.recursion.floating_body import floating_base
from vehicledyn.multibody.recursion.inertia import rigid
from vehicledyn.multibody.recursion.link_steps import needed_in_steps
from vehicledyn.multibody.recursion.mass_matrix import mass_matrix
from vehicledyn.multibody.recursion.newton_euler import inverse_dynamics, needed_wrenches
from vehicledyn.multibody.recursion.recast_tree import RecastTree
from vehicledyn.multibody.recursion.reduction import independent_accelerations, reduced_mass
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.elimination import Rows
from vehicledyn.symbolic.ops import Scalar, Vec
from vehicledyn.symbolic.parameters import ParameterTable
from vehicledyn.symbolic.shared import count_operations
from vehicledyn.symbolic.shared_steps import Steps, Writer, written_out

Formulation: TypeAlias = Literal["auto", "composite", "articulated"]
"""Composite inertias and a factorised mass matrix, articulated inertias, or the cheaper."""

_MANY = 12
"""Free coordinates from which the recursion is written in steps, each kind once.

Written out, the 5,000 operations of 12 joints fill the 32 KiB that most cores keep of a program.
Beyond, a joint takes 1.7 times as long; within, in steps, it takes a fifth longer than written out.
"""

_LARGE = 200
"""Free coordinates from which steps are given their numbers, and no other way is tried.

Where every joint has numbers of its own each would else have a function of its own, and the time
to derive a thousand of them is what counts.
"""

_WRITTEN_OUT = 1.5
"""Time of an operation of a long system written out over that of one in steps."""

_LONG = 16
"""Entries of the mass matrix a coordinate above which it is not built even to be counted."""


@dataclass(frozen=True)
class TreeProblem:
    """A tree at q̈ = 0 of the independent coordinates, and what acts on it.

    ``kinematics`` knows the accelerations that drives and loops give then; ``inertias`` are
    those of the links or barycentric ones; ``free`` are all coordinates but the driven ones.
    """

    kinematics: Kinematics
    inertias: Sequence[BodyInertia]
    wrenches: Sequence[Wrench]
    joint_forces: dict[str, Scalar]
    gravity: Vec
    free: list[str]

    @property
    def base(self) -> int | None:
        """Link of the body that moves freely in all coordinates, if any."""
        tree = self.kinematics.tree
        idle = set(self.free) - set(tree.reflected_inertias)

        def is_idle(link: int) -> bool:
            joint = tree.links[link].joint
            return joint is not None and joint.name in idle and not self._is_loaded(joint.name)

        return floating_base(tree, is_idle)

    def _is_loaded(self, name: str) -> bool:
        return not ops.scalar(self.joint_forces.get(name, 0.0)).is_zero()

    def with_whole(self, base: int | None) -> TreeProblem:
        """Return the problem with the inertia of all that a base carries left with it."""
        if base is None:
            return self
        return replace(self, inertias=augmented_inertias(self.kinematics.tree, base))


def solve_tree(
    problem: TreeProblem, table: ParameterTable, formulation: Formulation = "auto"
) -> dict[str, Scalar]:
    """Return the accelerations of the free coordinates by name.

    The choice rests on the counted operations, those in steps being quicker; where the mass
    matrix has many entries a coordinate it is not tried. The parameter values of ``table`` tell
    where axes may be aligned.
    """
    if problem.kinematics.tree.has_deformable_bodies:
        if formulation == "articulated":
            raise InputError(
                "the articulated recursion is for rigid bodies only; choose 'auto' or 'composite'"
            )
        return by_composite(problem)
    by_matrix = None
    is_long = len(problem.free) >= _LARGE or _entries(problem) > _LONG * len(problem.free)
    if formulation == "composite" or (formulation == "auto" and not is_long):
        by_matrix = by_composite(problem)
    if by_matrix is not None and formulation == "composite":
        return by_matrix
    found, in_steps = _by_aligned(problem, table)
    if by_matrix is None:
        return found
    ways = (found, by_matrix)
    recursive, direct = (count_operations(ops.column([*way.values()])) for way in ways)
    return found if recursive < direct * (_WRITTEN_OUT if in_steps else 1.0) else by_matrix


def _by_aligned(problem: TreeProblem, table: ParameterTable) -> tuple[dict[str, Scalar], bool]:
    """Return the accelerations by articulated inertias, on axes that spare operations.

    They are written in steps where the joints are many and alike.
    """
    tree = problem.kinematics.tree
    if len(problem.free) >= _MANY and all(map(_is_elementary, tree.links)):
        named, steps = with_common_axis(tree), Steps(gives_numbers=len(problem.free) >= _LARGE)
        found = by_articulated(_on(problem, named.then(align(named.tree, table))), write=steps)
        if steps.are_alike:
            return found, True
    return by_articulated(_on(problem, align(tree, table))), False


def _is_elementary(item: Link) -> bool:
    """Return whether a link has no joint or a pure turn or slide, of which steps are made."""
    return item.type is None or (item.turns_about, item.slides_along) != (None, None)


def _on(problem: TreeProblem, aligned: AlignedTree) -> TreeProblem:
    """Return the same problem with the axes of an aligned tree."""
    if not aligned.turns:
        return problem
    return replace(
        problem,
        kinematics=problem.kinematics.on(aligned.tree),
        inertias=augmented_inertias(aligned.tree),
        wrenches=aligned.wrenches(problem.wrenches),
    )


def by_composite(problem: TreeProblem) -> dict[str, Scalar]:
    """Return them from M q̈ = -c, M factorised along the tree."""
    return solve_closed(problem, problem.free, {})


def solve_closed(
    problem: TreeProblem, independent: list[str], influence: dict[str, dict[str, Scalar]]
) -> dict[str, Scalar]:
    """Return the independent accelerations of a system with loops by name.

    Parameters
    ----------
    problem
        The tree; ``free`` are the independent and the dependent coordinates.
    independent
        Names of the independent coordinates.
    influence
        For each dependent coordinate, by name {independent: entry of B in q̇_u = B q̇_v}.
    """
    other = RecastTree(problem.kinematics.tree, set(problem.free) - set(influence))
    if other.is_needed:
        influence = {name: other.forces(row) for name, row in influence.items()}
        return other.accelerations(_solve(_recast(problem, other), independent, influence))
    return _solve(problem, independent, influence)


def _recast(problem: TreeProblem, other: RecastTree) -> TreeProblem:
    return replace(
        problem,
        kinematics=other.kinematics(problem.kinematics),
        inertias=other.inertias(problem.inertias),
        joint_forces=other.forces(problem.joint_forces),
    )


def _solve(
    p: TreeProblem, independent: list[str], influence: dict[str, dict[str, Scalar]]
) -> dict[str, Scalar]:
    bias = _bias(p)
    mass = mass_matrix(p.kinematics, set(p.free), p.inertias)
    return independent_accelerations(mass, bias, independent, influence)


def _bias(p: TreeProblem) -> dict[str, Scalar]:
    """Return what each free coordinate lacks for its motion."""
    needed, _ = inverse_dynamics(p.kinematics, p.wrenches, p.gravity, p.inertias)
    return {name: needed[name] - p.joint_forces.get(name, 0.0) for name in p.free}


def missing_forces(
    problem: TreeProblem, independent: list[str], influence: dict[str, dict[str, Scalar]]
) -> tuple[list[Scalar], Rows]:
    """Return the forces on the independent coordinates that a motion needs and does not have.

    Parameters are those of :func:`solve_closed`, but the motion has its accelerations. The mass
    matrix of the independent coordinates follows, by rows.
    """
    bias = _bias(problem)
    total = {name: bias[name] for name in independent}
    for name, row in influence.items():
        for other, entry in row.items():
            total[other] = total[other] + entry * bias[name]
    mass = mass_matrix(problem.kinematics, set(problem.free), problem.inertias)
    return list(total.values()), reduced_mass(mass, independent, influence)


def by_articulated(problem: TreeProblem, *, write: Writer = written_out) -> dict[str, Scalar]:
    """Return them by the recursion of order N, its steps written by ``write``."""
    base = problem.base
    p = problem.with_whole(base)
    kinematics = p.kinematics
    if write is written_out:
        needed = needed_wrenches(kinematics, p.wrenches, p.gravity, p.inertias)
    else:
        given = (p.wrenches, p.gravity, rigid(p.inertias))
        kinematics, needed = needed_in_steps(kinematics, *given, write)
    found = articulated.tree_accelerations(
        kinematics, needed, p.joint_forces, p.inertias, set(p.free), base=base, write=write
    )
    return {name: found[name] for name in p.free}


def _entries(problem: TreeProblem) -> int:
    """Return the number of structural entries of one triangle of the mass matrix."""
    tree, free = problem.kinematics.tree, set(problem.free)
    depth: list[int] = []
    total = 0
    for item in tree.links:
        is_free = item.joint is not None and item.joint.name in free
        depth.append((depth[item.parent] if item.parent >= 0 else 0) + is_free)
        total += depth[-1] if is_free else 0
    return total
