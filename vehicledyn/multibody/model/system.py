"""A multibody system as data: a tree of bodies, loop cuts and parts that act on it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.multibody.joints.deformation import DEFORMATION
from vehicledyn.multibody.joints.joint_type import brought_kinds, joint_kinds, joint_type
from vehicledyn.multibody.model.bodies import ROLES, Body, Joint
from vehicledyn.multibody.model.constraints import Constraint
from vehicledyn.multibody.model.contributions import merged, parents_first
from vehicledyn.multibody.model.cuts import Cut
from vehicledyn.multibody.model.declaration import out_of_bounds
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.parts import Part
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.parameters import ParameterTable

ConstraintMethod: TypeAlias = Literal["auto", "partitioning", "multipliers"]
"""How constraints are treated: by dependent coordinates, with multipliers, or what serves."""

MOST_ENTANGLED = 9
"""Entangled constraints up to which partitioning serves well."""


@dataclass(frozen=True)
class System:
    """A multibody system: parameters, bodies (parents first), cuts, parts and gravity.

    What parts bring with them, bodies, cuts and constraints, is put among those of the system.

    ``gravity`` is the acceleration vector of free fall in world axes, 3 scalars [m/s²];
    ``constraints`` are those that are no cuts of a loop. ``constraint_method`` says how they
    are treated: by "partitioning" into independent and dependent coordinates, or with
    "multipliers" and projection; "auto" takes multipliers where many coordinates depend on each
    other.
    """

    name: str
    table: ParameterTable
    bodies: tuple[Body, ...]
    cuts: tuple[Cut, ...] = ()
    parts: tuple[Part, ...] = ()
    gravity: Sequence[Scalar] = (0.0, 0.0, -9.81)
    notes: dict[str, str] = field(default_factory=dict)
    constraints: tuple[Constraint, ...] = ()
    constraint_method: ConstraintMethod = "auto"
    brought: frozenset[str] = field(default=frozenset(), repr=False)
    """Names of the bodies, cuts and constraints that parts brought."""
    surroundings: tuple[str, ...] = ()
    """Names of the parts that are no parts of the model but act on it, such as a driver."""
    starts: Mapping[str, Scalar] = field(default_factory=dict, repr=False)
    """Start values of coordinates, and of rates as NAME_rate, that follow from parameters."""

    def __post_init__(self) -> None:
        """Put what parts bring among the bodies, cuts and constraints."""
        bodies, cuts, constraints = (
            [item for part in self.parts for item in getattr(part, f"added_{what}")()]
            for what in ("bodies", "cuts", "constraints")
        )
        names = frozenset(item.name for item in (*bodies, *cuts, *constraints))
        if not names and not self.brought:
            return
        known, before = vars(self), self.brought
        known["bodies"] = parents_first(merged("body", self.bodies, bodies, before))
        known["cuts"] = merged("cut", self.cuts, cuts, before)
        known["constraints"] = merged("constraint", self.constraints, constraints, before)
        known["brought"] = names

    def with_parts(self, *parts: Part) -> System:
        """Return the system with more parts."""
        return replace(self, parts=(*self.parts, *parts))

    def with_surroundings(self, *parts: Part) -> System:
        """Return the system with more parts that act on it; one takes the place of its namesake."""
        named = {part.name: part for part in parts}
        kept = tuple(named.pop(part.name, part) for part in self.parts)
        names = dict.fromkeys((*self.surroundings, *(part.name for part in parts)))
        return replace(self, parts=(*kept, *named.values()), surroundings=tuple(names))

    def with_starts(self, starts: dict[str, float]) -> System:
        """Return the system with other start values of coordinates, and of rates as NAME_rate."""
        known = {name for joint in self.joints() for name in (joint.name, f"{joint.name}_rate")}
        for name in starts:
            if name not in known:
                raise InputError(unknown_name("coordinate", name, known))
        bodies = tuple(_restart(body, starts) for body in self.bodies)
        kept = {name: item for name, item in self.starts.items() if name not in starts}
        return replace(self, bodies=bodies, starts=kept)

    def joints(self) -> list[Joint]:
        """Return all joints with a coordinate, in the order of the bodies."""
        return [j for body in self.bodies for j in body.joints if isinstance(j, Joint)]

    def check(self) -> None:
        """Raise InputError with every fault of the tree at once: names, parents, kinds."""
        problems = [*_tree_problems(self), *_joint_problems(self), *_end_problems(self)]
        judged: list[Part | Constraint] = [*self.parts, *self.constraints]
        for item in judged:
            problems += [f"{item.name}: {words}" for words in out_of_bounds(item)]
        if problems:
            listed = "\n".join(f"  - {problem}" for problem in problems)
            raise InputError(f"system '{self.name}' has {len(problems)} problem(s):\n{listed}")


def _restart(body: Body, starts: dict[str, float]) -> Body:
    joints = tuple(_started(j, starts) if isinstance(j, Joint) else j for j in body.joints)
    return replace(body, joints=joints)


def _started(joint: Joint, starts: dict[str, float]) -> Joint:
    rate = starts.get(f"{joint.name}_rate", joint.start_rate)
    return replace(joint, start=starts.get(joint.name, joint.start), start_rate=rate)


def _tree_problems(system: System) -> list[str]:
    problems: list[str] = []
    known = {GROUND}
    bodies = {body.name: body for body in system.bodies}
    for body in system.bodies:
        if body.name in known:
            problems.append(f"body '{body.name}' is defined twice")
        if body.parent not in known:
            problems.append(f"body '{body.name}': parent: {_wrong_parent(body, known, bodies)}")
        if body.spins_about is not None and not _spins(body):
            problems.append(
                f"body '{body.name}': its last joint must be R{body.spins_about} to spin about "
                f"axis {body.spins_about}"
            )
        known.add(body.name)
    return [*problems, *_spin_problems(system), *_deformation_problems(system)]


def _deformation_problems(system: System) -> list[str]:
    """Return what is wrong with deformable bodies and with what hangs on them."""
    deformable = {body.name for body in system.bodies if body.flexibility is not None}
    problems = []
    for body in system.bodies:
        if body.parent in deformable and body.place is None:
            words = (
                f"hangs on '{body.parent}', which deforms; hang it on a frame at one of its points"
            )
            problems.append(f"body '{body.name}': {words}")
        if body.parent not in deformable and body.place is not None:
            words = f"has a place on '{body.parent}', which does not deform; give 'at' alone"
            problems.append(f"body '{body.name}': {words}")
        if body.flexibility is not None and body.spins_about is not None:
            problems.append(f"body '{body.name}': what deforms cannot have spins_about")
    return problems


def _spin_problems(system: System) -> list[str]:
    """Return what hangs on bodies whose axes do not spin with them."""
    spinning = {body.name for body in system.bodies if body.spins_about is not None}
    hanging = [(f"body '{b.name}'", b.parent) for b in system.bodies]
    for cut in system.cuts:
        hanging.extend((f"cut '{cut.name}'", body) for body in (cut.body_a, cut.body_b))
    return [
        f"{what}: hangs on '{body}', whose axes do not spin with it (spins_about); "
        f"hang it on the body before, or leave spins_about out"
        for what, body in hanging
        if body in spinning
    ]


def _wrong_parent(body: Body, known: set[str], bodies: dict[str, Body]) -> str:
    """Return what is wrong with a parent that is not among the bodies before."""
    if body.parent not in bodies:
        head, _, frame = body.parent.rpartition(".")
        if head in bodies and bodies[head].flexibility is not None:
            frames = [n.removeprefix(f"{head}.") for n, b in bodies.items() if b.parent == head]
            return f"'{head}' has no frame '{frame}'; it has {', '.join(frames)}"
        return unknown_name("body defined before it", body.parent, known)
    path = [body.name]
    while path[-1] in bodies and bodies[path[-1]].parent not in path:
        path.append(bodies[path[-1]].parent)
    last = bodies[path[-1]].parent if path[-1] in bodies else None
    if last is None:
        return f"'{body.parent}' is defined after it; put parents first"
    return f"the bodies hang on each other: {' -> '.join([*path[path.index(last) :], last])}"


def _spins(body: Body) -> bool:
    last = body.joints[-1] if body.joints else None
    return isinstance(last, Joint) and last.type.turns_about == body.spins_about


def _joint_problems(system: System) -> list[str]:
    problems: list[str] = []
    seen: set[str] = set()
    starts = {joint.name: joint.start for joint in system.joints()}
    for joint in system.joints():
        problem = _type_problem(joint)
        if problem:
            problems.append(f"joint '{joint.name}': {problem}")
        if not problem and joint.siblings and joint.leads:
            start = [starts.get(name, 0.0) for name in joint.positions]
            found = joint.type.start_problem(start)
            problems += [f"joint '{joint.name}': {found}"] if found else []
        if not problem and joint.siblings and joint.role != "independent":
            problems.append(f"joint '{joint.name}': the role of a quaternion is 'independent'")
        if not (problem or ops.is_structurally_zero(joint.reflected_inertia)):
            problems += [f"joint '{joint.name}': {text}" for text in _reflected_problems(joint)]
        if joint.role not in ROLES:
            problems.append(f"joint '{joint.name}': {unknown_name('role', joint.role, ROLES)}")
        if joint.name in seen:
            problems.append(f"joint '{joint.name}' is defined twice")
        seen.add(joint.name)
    return problems


def _reflected_problems(joint: Joint) -> Iterator[str]:
    """Yield what is wrong with an inertia that a coordinate feels."""
    if joint.siblings or joint.kind == DEFORMATION:
        yield "a reflected inertia needs a joint with one coordinate, a turn or a slide"
    value = joint.reflected_inertia
    if isinstance(value, int | float) and not math.isfinite(value):
        yield f"its reflected inertia is {value}; give a finite number"


def _type_problem(joint: Joint) -> str:
    """Return what is wrong with the kind of a joint or with its settings."""
    if joint.kind == DEFORMATION:
        return ""
    if joint.kind not in (*joint_kinds(), *brought_kinds()):
        return unknown_name("kind", joint.kind, joint_kinds())
    try:
        joint_type(joint.kind, joint.settings)
    except InputError as error:
        return str(error)
    return ""


def refuse_quaternions(system: System, what: str, why: str) -> None:
    """Raise InputError if the attitude of a body is a quaternion, which ``what`` cannot treat."""
    found = [j.name for j in system.joints() if not j.type.is_paired]
    if found:
        raise InputError(
            f"system '{system.name}': {what} cannot treat '{found[0]}', a part of a joint with a "
            f"quaternion: {why}; use three turns, as the joint 'spherical' has them",
            about=found,
        )


def _end_problems(system: System) -> list[str]:
    bodies = {GROUND, *(body.name for body in system.bodies)}
    problems: list[str] = []
    for cut in system.cuts:
        problems.extend(
            f"cut '{cut.name}': {unknown_name('body', name, bodies)}"
            for name in (cut.body_a, cut.body_b)
            if name not in bodies
        )
    names = [*(cut.name for cut in system.cuts), *(part.name for part in system.parts)]
    names += [constraint.name for constraint in system.constraints]
    problems.extend(
        f"'{n}' names two parts" for n in sorted({n for n in names if names.count(n) > 1})
    )
    return problems
