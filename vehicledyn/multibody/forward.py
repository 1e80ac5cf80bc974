"""Accelerations of a tree, open or with its loops closed, by the cheaper formulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from vehicledyn.multibody import articulated
from vehicledyn.multibody.alignment import AlignedTree, align
from vehicledyn.multibody.barycentric import augmented_inertias
from vehicledyn.multibody.dynamics import inverse_dynamics, mass_matrix, needed_wrenches
from vehicledyn.multibody.floating import floating_base
from vehicledyn.multibody.inertia import Inertia
from vehicledyn.multibody.kinematics import Kinematics
from vehicledyn.multibody.parts import Wrench
from vehicledyn.multibody.reduction import independent_accelerations
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.counting import count_operations
from vehicledyn.symbolic.ops import Scalar, Vec
from vehicledyn.symbolic.parameters import ParameterTable

Formulation: TypeAlias = Literal["auto", "composite", "articulated"]
"""Composite inertias and a factorised mass matrix, articulated inertias, or the cheaper."""

_LONG = 16
"""Entries of the mass matrix a coordinate above which it is not built even to be counted."""


@dataclass(frozen=True)
class TreeProblem:
    """A tree at q̈ = 0 of the independent coordinates, and what acts on it.

    ``kinematics`` knows the accelerations that drives and loops give then; ``inertias`` are
    those of the links or barycentric ones; ``free`` are all coordinates but the driven ones.
    """

    kinematics: Kinematics
    inertias: Sequence[Inertia]
    wrenches: Sequence[Wrench]
    joint_forces: dict[str, Scalar]
    gravity: Vec
    free: list[str]

    @property
    def base(self) -> int | None:
        """Link of the body that moves freely in all coordinates, if any."""
        tree = self.kinematics.tree

        def is_idle(link: int) -> bool:
            joint = tree.links[link].joint
            return joint is not None and joint.name in self.free and not self._is_loaded(joint.name)

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

    The choice rests on the counted operations; where the mass matrix has many entries a
    coordinate it is not tried. The parameter values of ``table`` tell where axes may be aligned.
    """
    candidates: list[dict[str, Scalar]] = []
    if formulation != "articulated" and not (
        formulation == "auto" and _entries(problem) > _LONG * len(problem.free)
    ):
        candidates.append(by_composite(problem))
    if formulation != "composite":
        aligned = align(problem.kinematics.tree, table)
        candidates.append(by_articulated(_on(problem, aligned) if aligned.turns else problem))
    return min(candidates, key=lambda found: count_operations(ops.column([*found.values()])))


def _on(problem: TreeProblem, aligned: AlignedTree) -> TreeProblem:
    """Return the same problem with the axes of an aligned tree."""
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
    p = problem
    needed, _ = inverse_dynamics(p.kinematics, p.wrenches, p.gravity, p.inertias)
    bias = {name: needed[name] - p.joint_forces.get(name, 0.0) for name in p.free}
    mass = mass_matrix(p.kinematics, set(p.free), p.inertias)
    return independent_accelerations(mass, bias, independent, influence)


def by_articulated(problem: TreeProblem) -> dict[str, Scalar]:
    """Return them by the recursion of order N."""
    base = problem.base
    p = problem.with_whole(base)
    needed = needed_wrenches(p.kinematics, p.wrenches, p.gravity, p.inertias)
    found = articulated.tree_accelerations(
        p.kinematics, needed, p.joint_forces, p.inertias, set(p.free), base=base
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
