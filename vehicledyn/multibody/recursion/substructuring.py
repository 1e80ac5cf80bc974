"""Sub-system segmentation: closed sub-systems, each condensed to the body that carries them.

Sub-systems that constraints tie together form one segment; the others know nothing of each
other (book, chapter 4.4). What is left, the carrier and all below it, is an open tree with a
few bodies.
"""

from __future__ import annotations

from collections import defaultdict

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.model.tree import Tree
from vehicledyn.multibody.recursion import articulated_body as articulated
from vehicledyn.multibody.recursion.forward_dynamics import Formulation, TreeProblem, solve_closed
from vehicledyn.multibody.recursion.newton_euler import needed_wrenches
from vehicledyn.multibody.recursion.substructure import Influence, condense
from vehicledyn.symbolic.ops import Scalar

_ENOUGH = 3
"""Free coordinates of a carrier from which on segments need fewer operations."""


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
    if tree.has_deformable_bodies:
        return solve_closed(problem, independent, influence)
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
    base = problem.base
    if base in beyond:
        base = None
    problem = problem.with_whole(base)
    needed = needed_wrenches(
        problem.kinematics, problem.wrenches, problem.gravity, problem.inertias
    )
    segments = [
        condense(problem, carrier, links, needed, independent=independent, influence=influence)
        for links in _tied(tree, branches, influence, carrier)
    ]
    below = [link for link in range(len(tree.links)) if link not in beyond]
    found, moved = articulated.sweep(
        problem.kinematics,
        needed,
        problem.joint_forces,
        problem.inertias,
        set(problem.free),
        base=base,
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
