"""The expressions that the equations of a system are made of, for reading and exporting them.

In all coordinates q of the tree, with the parts' states s and unknowns u,

    M(q) q̈ + c(t, q, q̇, s, u) = Jᵀ λ + forces of the drives,    h(t, q) = 0,    J = ∂h/∂q,
    J q̇ + ∂h/∂t = 0,    J q̈ + γ(t, q, q̇) = 0,

and in states x and unknowns z as in :mod:`~vehicledyn.symbolic.equations`, the solution.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from vehicledyn.multibody.derivation import Derivation, equations_of, solve_motion
from vehicledyn.multibody.dynamics import JointWrench, inverse_dynamics, mass_matrix
from vehicledyn.multibody.kinematics import Kinematics
from vehicledyn.multibody.parts import Loads, Part, Situation
from vehicledyn.multibody.system import System
from vehicledyn.multibody.tree import Tree
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations, Variable
from vehicledyn.symbolic.ops import Scalar, Vec

Entries = dict[tuple[int, int], Scalar]
"""Structural nonzeros of a matrix by row and column."""

_QUANTITIES = {
    "rotation": "R",
    "arm": "d",
    "omega": "om",
    "velocity": "v",
    "alpha": "al",
    "beta": "be",
    "acceleration": "a",
}


@dataclass(frozen=True)
class Label:
    """A meaningful intermediate expression: the section it belongs to and a short name."""

    section: str
    name: str
    expression: Scalar


@dataclass(frozen=True)
class LinkFacts:
    """A link of the tree for people; numbers count from 1, 0 is the ground."""

    number: int
    parent: int
    joint: str
    body: str


@dataclass(frozen=True)
class Ingredients:
    """Symbols and expressions of a system; see the module's text for their meaning.

    ``coordinates``, ``rates``, ``accelerations``, ``part_states`` and ``part_unknowns`` are
    columns of symbols; ``roles`` says of each coordinate whether it is independent, dependent
    or driven. ``bias`` and ``forces`` (inverse dynamics) have an entry a coordinate;
    ``constraints``, the rows of ``jacobian``, ``constraint_rate`` (∂h/∂t) and ``quadratic``
    (γ) one a constraint, named by its cut in ``constraint_names``. ``positions_of_state``,
    ``rates_of_state`` and ``accelerations_of_state`` are all coordinates, rates and
    accelerations as functions of t, x, z and p.
    """

    equations: Equations
    links: tuple[LinkFacts, ...]
    variables: tuple[Variable, ...]
    roles: tuple[str, ...]
    part_variables: tuple[Variable, ...]
    part_unknown_variables: tuple[Variable, ...]
    coordinates: Scalar
    rates: Scalar
    accelerations: Scalar
    part_states: Scalar
    part_unknowns: Scalar
    mass: Entries
    bias: list[Scalar]
    forces: list[Scalar]
    constraint_names: tuple[str, ...]
    constraints: list[Scalar]
    jacobian: Entries
    constraint_rate: list[Scalar]
    quadratic: list[Scalar]
    positions_of_state: list[Scalar]
    rates_of_state: list[Scalar]
    accelerations_of_state: list[Scalar]
    tree_labels: tuple[Label, ...]
    state_labels: tuple[Label, ...]


def derive_ingredients(system: System) -> Ingredients:
    """Return the equations of a system with the expressions they are made of.

    Raises
    ------
    InputError, NumericalError
        As :func:`~vehicledyn.multibody.derivation.derive` does.
    """
    d = solve_motion(system)
    names = [j.name for j in d.symbols.joints]
    closure = d.loops.closure
    accelerations = {n: ops.symbol(f"{n}_acceleration") for n in names}
    free = _Tree.of(d, accelerations)
    reduced = _InStates.of(d)
    part_states = [(p, v) for p in system.parts for v in p.states()]
    part_unknowns = [(p, v) for p in system.parts for v in p.unknowns()]
    return Ingredients(
        equations=equations_of(d),
        links=_link_facts(d.tree),
        variables=tuple(
            Variable(j.name, j.unit, j.description or j.name, d.loops.start[j.name])
            for j in d.symbols.joints
        ),
        roles=_roles(d),
        part_variables=_named(part_states),
        part_unknown_variables=_named(part_unknowns),
        coordinates=d.symbols.coordinate_column,
        rates=d.symbols.rate_column,
        accelerations=ops.column([accelerations[n] for n in names]),
        part_states=ops.column([d.symbols.states[p.name][v.name] for p, v in part_states]),
        part_unknowns=ops.column([d.symbols.unknowns[p.name][v.name] for p, v in part_unknowns]),
        mass={(names.index(a), names.index(b)): v for (a, b), v in free.mass.items()},
        bias=[free.bias[n] for n in names],
        forces=[free.forces[n] for n in names],
        constraint_names=tuple(c.cut for c in d.loops.constraints),
        constraints=[c.residual.expression for c in d.loops.constraints],
        jacobian={(i, j): v for i, row in enumerate(closure.jacobian) for j, v in row.items()},
        constraint_rate=closure.rate,
        quadratic=closure.quadratic,
        positions_of_state=reduced.positions,
        rates_of_state=reduced.rates,
        accelerations_of_state=reduced.accelerations,
        tree_labels=free.labels,
        state_labels=reduced.labels,
    )


@dataclass(frozen=True)
class _Tree:
    """Mass matrix, bias and joint forces of the tree with all coordinates free."""

    mass: dict[tuple[str, str], Scalar]
    bias: dict[str, Scalar]
    forces: dict[str, Scalar]
    labels: tuple[Label, ...]

    @classmethod
    def of(cls, d: Derivation, accelerations: dict[str, Scalar]) -> _Tree:
        symbols, gravity = d.symbols, ops.vector(*d.system.gravity)
        bare = Kinematics(d.tree, symbols.coordinates, symbols.rates)
        loads = {
            part.name: part.loads(
                Situation(
                    symbols.time, symbols.states[part.name], symbols.unknowns[part.name], bare
                )
            )
            for part in d.system.parts
        }
        wrenches = [w for load in loads.values() for w in load.wrenches]
        at_rest = bare.with_accelerations({n: ops.scalar(0.0) for n in accelerations})
        moving = bare.with_accelerations(accelerations)
        bias, held = inverse_dynamics(at_rest, wrenches, gravity)
        forces, carried = inverse_dynamics(moving, wrenches, gravity)
        given: dict[str, Scalar] = {}
        for load in loads.values():
            for name, force in load.joint_forces.items():
                given[name] = given.get(name, 0.0) + force
        labels = [
            *_kinematic_labels(d.tree, bare),
            *_kinematic_labels(d.tree, _accelerated(at_rest, gravity)),
            *_kinematic_labels(d.tree, _accelerated(moving, gravity)),
            *_load_labels(loads),
            *_wrench_labels(d.tree, held),
            *_wrench_labels(d.tree, carried),
        ]
        return cls(
            mass_matrix(bare, set(accelerations)),
            {n: f - given.get(n, 0.0) for n, f in bias.items()},
            {n: f - given.get(n, 0.0) for n, f in forces.items()},
            tuple(labels),
        )


@dataclass(frozen=True)
class _InStates:
    """Coordinates, rates and accelerations as functions of the states."""

    positions: list[Scalar]
    rates: list[Scalar]
    accelerations: list[Scalar]
    labels: tuple[Label, ...]

    @classmethod
    def of(cls, d: Derivation) -> _InStates:
        names = [j.name for j in d.symbols.joints]
        dependent = [names[k] for k in d.roles.dependent]
        labels = [
            *(
                Label("Rates of the dependent coordinates", f"{n}_rate", d.solved.rates[n])
                for n in dependent
            ),
            *_kinematic_labels(d.tree, d.solved.kinematics),
            *_load_labels(d.solved.loads),
        ]
        n, m = len(names), len(labels)
        column = _with_motions(
            d,
            [
                *(d.symbols.coordinates[name] for name in names),
                *(d.solved.rates[name] for name in names),
                *(d.solved.accelerations[name] for name in names),
                *(label.expression for label in labels),
            ],
        )
        return cls(
            column[:n],
            column[n : 2 * n],
            column[2 * n : 3 * n],
            tuple(
                Label(label.section, label.name, expression)
                for label, expression in zip(labels, column[3 * n : 3 * n + m], strict=True)
            ),
        )


def _with_motions(d: Derivation, items: list[Scalar]) -> list[Scalar]:
    """Return expressions with driven coordinates and rates replaced by their motions."""
    symbols, moved = d.symbols, d.moved
    old = [symbols.coordinates[n] for n in moved] + [symbols.rates[n] for n in moved]
    new = [m.position for m in moved.values()] + [m.velocity for m in moved.values()]
    column = ops.substitute(ops.column(items), ops.column(old), ops.column(new))
    return [column[k] for k in range(len(items))]


def _accelerated(kinematics: Kinematics, gravity: Vec) -> Kinematics:
    """Return the kinematics of the backward recursion, with all accelerations evaluated."""
    lifted = kinematics.in_lift(-gravity)
    for link in range(len(lifted.tree.links)):
        lifted.link_acceleration(link)
        lifted.beta(link)
    return lifted


def _kinematic_labels(tree: Tree, kinematics: Kinematics) -> Iterator[Label]:
    """Yield what the kinematics evaluated, link by link from the ground outwards."""
    known = kinematics.evaluated()
    for link in range(len(tree.links)):
        section = f"Link {link + 1}: {_joint_text(tree, link)}"
        for what, stem in _QUANTITIES.items():
            if (what, link) in known:
                yield from _elements(section, f"{stem}{link + 1}", known[what, link])


def _load_labels(loads: Mapping[str, Loads]) -> Iterator[Label]:
    """Yield the wrenches of the parts: force Fp and torque Lp, numbered in their order."""
    number = 0
    for part, load in loads.items():
        for wrench in load.wrenches:
            number += 1
            section = f"Part {part}: force and torque on body {wrench.body}, in its axes"
            yield from _elements(section, f"Fp{number}", wrench.force)
            yield from _elements(section, f"Lp{number}", wrench.torque)


def _wrench_labels(tree: Tree, carried: Mapping[int, JointWrench]) -> Iterator[Label]:
    """Yield force F and torque L that each joint transmits, from the leaves inwards."""
    for link, wrench in carried.items():
        section = f"Force and torque through joint {link + 1}: {_joint_text(tree, link)}"
        yield from _elements(section, f"F{link + 1}", wrench.force)
        yield from _elements(section, f"L{link + 1}", wrench.torque)


def _elements(section: str, name: str, value: Scalar) -> Iterator[Label]:
    """Yield the elements of a vector or matrix, named by their indices from 1."""
    rows, columns = value.shape
    for i in range(rows):
        for j in range(columns):
            index = f"{i + 1}" if columns == 1 else f"{i + 1}{j + 1}"
            yield Label(section, f"{name}_{index}", value[i, j])


def _link_facts(tree: Tree) -> tuple[LinkFacts, ...]:
    return tuple(
        LinkFacts(k + 1, link.parent + 1, _joint_text(tree, k), link.body.name if link.body else "")
        for k, link in enumerate(tree.links)
    )


def _joint_text(tree: Tree, link: int) -> str:
    item = tree.links[link]
    if item.joint is None:
        return f"fixed, {tree.link_name(link)}"
    return f"{item.joint.kind} {item.joint.name}"


def _roles(d: Derivation) -> tuple[str, ...]:
    roles = dict.fromkeys(d.roles.independent, "independent")
    roles |= dict.fromkeys(d.roles.dependent, "dependent")
    roles |= dict.fromkeys(d.roles.driven, "driven")
    return tuple(roles[k] for k in range(len(d.symbols.joints)))


def _named(pairs: list[tuple[Part, Variable]]) -> tuple[Variable, ...]:
    return tuple(replace(v, name=f"{p.name}.{v.name}") for p, v in pairs)
