"""Put a solved system into the order of the Equations value: states, unknowns, channels, blocks."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from vehicledyn.base.errors import InputError
from vehicledyn.base.validation_messages import lower_first
from vehicledyn.multibody.equations.impacts import Impacts
from vehicledyn.multibody.equations.multipliers import ConstrainedMotion, Projection
from vehicledyn.multibody.equations.outputs import Exerted, Solved, drifts, exerted, observe
from vehicledyn.multibody.equations.part_events import collect_events
from vehicledyn.multibody.equations.seam import Replacement
from vehicledyn.multibody.loops.closure import MultiplierClosure
from vehicledyn.multibody.loops.loop_closure import Loops
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.parts import Output, Part
from vehicledyn.multibody.model.symbols import Symbols, locked
from vehicledyn.multibody.model.system import System
from vehicledyn.symbolic import frames, ops
from vehicledyn.symbolic.equations import (
    Attitude,
    Block,
    Equations,
    ParameterValue,
    Seam,
    Variable,
    with_tables,
)
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.sparse_rows import matrix_of, rows_of

LOOP_TOLERANCE = 1e-12
"""Residual at which a loop counts as closed [m]; a hundredth of what users are promised."""

REACTION_TOLERANCE = 1e-10
"""Error at which an implicit force counts as found, as a part of the weight of all bodies [1]."""


@dataclass(frozen=True)
class Roles:
    """Indices of coordinates by what they are to the equations.

    ``independent`` ones are states with their rates, ``dependent`` ones (in the order of
    solution) unknowns, ``driven`` ones known in time. ``following`` ones are states too, but
    non-holonomic constraints give their rates. ``turned`` ones are positions that the speeds of
    others turn: components of quaternions, whose speeds are among the independent ones.
    """

    independent: list[int]
    dependent: list[int]
    driven: list[int]
    following: list[int] = field(default_factory=list)
    turned: list[int] = field(default_factory=list)


def roles_of(symbols: Symbols, loops: Loops) -> Roles:
    """Return the roles of all coordinates once the loops are partitioned."""
    dependent = loops.dependent
    driven = [k for k, j in enumerate(symbols.joints) if j.role == "driven"]
    following = loops.following
    turned = [k for k, j in enumerate(symbols.joints) if not j.type.has_speed]
    taken = {*dependent, *driven, *following, *turned}
    independent = [k for k in range(len(symbols.joints)) if k not in taken]
    return Roles(independent, dependent, driven, following, turned)


def collect(
    system: System,
    symbols: Symbols,
    *,
    loops: Loops,
    roles: Roles,
    solved: Solved,
    replacement: Replacement,
    multipliers: ConstrainedMotion | None = None,
    projection: Projection | None = None,
) -> Equations:
    """Return the equations of a solved system.

    States are the independent coordinates, their rates, quaternions and their angular velocities,
    the coordinates whose rates alone are dependent, and the parts' states; unknowns are the
    dependent coordinates in the order of solution, the parts' unknowns and, in one block, the
    forces of constraints that loads depend on. With ``multipliers`` the states are those that
    ``projection`` puts onto the constraints.

    Raises
    ------
    InputError
        If two parts give a channel of the same name.
    """
    joints = symbols.joints
    finished = _Finish(replacement, projection)
    at, rates = (
        (symbols.coordinates, symbols.rates)
        if projection is None
        else (projection.coordinates, projection.rates)
    )
    part_states = [(p, v) for p in system.parts for v in p.states()]
    part_unknowns = [(p, v) for p in system.parts for v in p.unknowns()]
    reactions = [(p, v) for p in system.parts for v in p.reactions()]
    independent = [joints[k] for k in roles.independent if joints[k].type.is_paired]
    speeds = [joints[k] for k in roles.independent if not joints[k].type.is_paired]
    turned = [joints[k] for k in roles.turned]
    dependent = [joints[k] for k in roles.dependent]
    following = [joints[k] for k in roles.following]
    state = [
        *(at[j.name] for j in independent),
        *(rates[j.name] for j in independent),
        *(at[j.name] for j in (*turned, *following)),
        *(rates[j.name] for j in speeds),
        *(symbols.states[p.name][v.name] for p, v in part_states),
    ]
    rate = [
        *(symbols.rates[j.name] for j in independent),
        *(solved.accelerations[j.name] for j in independent),
        *(solved.rates[j.name] for j in (*turned, *following)),
        *(solved.accelerations[j.name] for j in speeds),
        *(solved.loads[p.name].rates[v.name] for p, v in part_states),
    ]
    algebraic = [
        *(symbols.coordinates[j.name] for j in dependent),
        *(symbols.unknowns[p.name][v.name] for p, v in part_unknowns),
        *(symbols.reactions[p.name][v.name] for p, v in reactions),
    ]
    contact = [r for p in system.parts for r in solved.loads[p.name].residuals]
    kept = [loops.constraints[row].residual.expression for row, _ in loops.positions.pairs]
    forces = exerted(system, symbols, loops, solved)
    implicit = _reaction_residuals(system, symbols, solved, forces)
    outputs = [*observe(system, symbols, loops, solved, forces), *drifts(projection)]
    _check_unique(outputs)
    states = (
        *_coordinate_states(independent, loops),
        *(_coordinate(j, loops.start[j.name]) for j in (*turned, *following)),
        *(_coordinate(j, j.start_rate) for j in speeds),
        *_part_variables(part_states),
    )
    respond = None if multipliers is None else multipliers.impulse_response
    impacts = Impacts(symbols, loops, solved, roles.independent, respond)
    unknowns = (
        *(_coordinate(j, loops.start[j.name]) for j in dependent),
        *_part_variables(part_unknowns),
        *_reaction_variables(reactions),
    )
    found = collect_events(
        system,
        symbols,
        solved,
        states=[s.name for s in states],
        unknowns=[u.name for u in unknowns],
        impacts=impacts,
    )
    n = len(independent)
    columns = {
        "rate": ops.column(rate),
        "residual": ops.column([*kept, *contact, *implicit]),
        "output": ops.column([o.expression for o in outputs]),
        "event": ops.column(found.functions),
        "slopes": _slopes(loops, contact, implicit, unknowns=algebraic),
        "reset": ops.column(found.new_values),
    }
    equations = Equations(
        name=system.name,
        time=symbols.time,
        state=ops.column(state),
        algebraic=ops.column(algebraic),
        parameter=ops.column([e.symbol for e in system.table.entries]),
        **{name: finished(column) for name, column in columns.items()},
        states=states,
        unknowns=unknowns,
        parameters=tuple(
            ParameterValue(e.name, e.unit, e.description, e.value) for e in system.table.entries
        ),
        channels=tuple(o.channel for o in outputs),
        blocks=(
            *_loop_blocks(loops),
            *_part_blocks(system, len(dependent)),
            *_reaction_block(reactions, len(algebraic)),
        ),
        positions=tuple(range(n)),
        events=tuple(found.events),
        velocities=tuple(range(n, 2 * n)),
        attitudes=_attitudes(turned, speeds, states),
        structure=_structure(system, symbols, loops, roles, multipliers),
    )
    return with_tables(replace(equations, seam=_seam(system, equations, columns, finished)))


def _seam(
    system: System, equations: Equations, columns: dict[str, Scalar], finished: _Finish
) -> Seam | None:
    """Return what the surroundings hand to the rest, and the equations with symbols for it."""
    names, symbols, values = finished.replacement.seam()
    if not names:
        return None
    opened = {name: finished.opened(column) for name, column in columns.items()}
    return Seam(
        tuple(names),
        ops.column(symbols),
        ops.column(values),
        system.surroundings,
        replace(equations, **opened),
    )


def _reaction_residuals(
    system: System, symbols: Symbols, solved: Solved, forces: Exerted
) -> list[Scalar]:
    """Return the assumed less the found forces over the weight of all bodies [1]."""
    residuals: list[Scalar] = []
    for part in system.parts:
        assumed = symbols.reactions[part.name].values()
        situation = symbols.situation(part, solved.kinematics, forces.transmitted)
        with frames.naming("part", part.name):
            found = part.found_reactions(situation)
        pairs = zip(assumed, found, strict=True)
        residuals.extend(a - f / symbols.force_scale for a, f in pairs)
    return residuals


def _reaction_variables(pairs: list[tuple[Part, Variable]]) -> tuple[Variable, ...]:
    """Return the implicit forces, which together carry the weight at the start."""
    return tuple(
        Variable(
            f"{p.name}.{v.name}",
            "1",
            f"{v.description}, over the weight of all bodies",
            1.0 / len(pairs),
        )
        for p, v in pairs
    )


def _reaction_block(pairs: list[tuple[Part, Variable]], stop: int) -> tuple[Block, ...]:
    if not pairs:
        return ()
    name = ", ".join(dict.fromkeys(p.name for p, _ in pairs))
    first = stop - len(pairs)
    return (Block(name, first, stop, REACTION_TOLERANCE, "1", "force"),)


def _slopes(
    loops: Loops, contact: list[Scalar], implicit: list[Scalar], *, unknowns: list[Scalar]
) -> Scalar:
    """Return ∂residual/∂unknown of the blocks, shape (n, n).

    That of the loops is as they know it themselves; implicit forces are the last unknowns.
    """
    place = {column: k for k, column in enumerate(loops.dependent)}
    rows = [
        {place[c]: v for c, v in loops.closure.jacobian[row].items() if c in place}
        for row, _ in loops.positions.pairs
    ]
    width = len(unknowns)
    first = width - len(implicit)
    by_force = ops.jacobian(ops.column(implicit), ops.column(unknowns[first:]))
    forces = [{first + k: v for k, v in row.items()} for row in rows_of(by_force)]
    return ops.stacked(
        matrix_of(rows, width),
        ops.jacobian(ops.column(contact), ops.column(unknowns)),
        matrix_of(forces, width),
    )


@dataclass(frozen=True)
class _Finish:
    """Writes expressions of coordinates and rates as those of the states and of time."""

    replacement: Replacement
    projection: Projection | None

    def __call__(self, expression: Scalar) -> Scalar:
        """Return an expression, its driven coordinates and rates replaced by their motions."""
        return self.replacement(self._projected(expression))

    def opened(self, expression: Scalar) -> Scalar:
        """Return an expression that keeps the symbols of what surroundings hand over."""
        return self.replacement.opened(self._projected(expression))

    def _projected(self, expression: Scalar) -> Scalar:
        return expression if self.projection is None else self.projection.applied(expression)


def _coordinate(joint: Joint, start: float) -> Variable:
    return Variable(joint.name, joint.unit, joint.description or joint.name, start)


def _coordinate_states(joints: list[Joint], loops: Loops) -> tuple[Variable, ...]:
    positions = [_coordinate(j, loops.start[j.name]) for j in joints]
    rates = [
        Variable(
            f"{j.name}_rate",
            f"{j.unit}/s",
            f"Rate of {lower_first(j.description or j.name)}",
            j.start_rate,
        )
        for j in joints
    ]
    return (*positions, *rates)


def _attitudes(
    turned: list[Joint], speeds: list[Joint], states: tuple[Variable, ...]
) -> tuple[Attitude, ...]:
    """Return where the states hold quaternions and the angular velocities that turn them."""
    place = {variable.name: k for k, variable in enumerate(states)}
    found = {j.siblings: (j.positions, j.speeds) for j in (*turned, *speeds)}
    return tuple(
        Attitude(tuple(place[n] for n in positions), tuple(place[n] for n in rates))
        for positions, rates in found.values()
    )


def _part_variables(pairs: list[tuple[Part, Variable]]) -> tuple[Variable, ...]:
    return tuple(replace(v, name=f"{p.name}.{v.name}") for p, v in pairs)


def _loop_blocks(loops: Loops) -> tuple[Block, ...]:
    blocks, first = [], 0
    for pairs in loops.positions.blocks:
        names = dict.fromkeys(loops.constraints[row].cut for row, _ in pairs)
        last = first + len(pairs)
        blocks.append(Block(", ".join(names), first, last, LOOP_TOLERANCE))
        first = last
    return tuple(blocks)


def _part_blocks(system: System, first: int) -> tuple[Block, ...]:
    blocks = []
    for part in system.parts:
        count = len(part.unknowns())
        if count:
            blocks.append(Block(part.name, first, first + count, LOOP_TOLERANCE, kind="contact"))
            first += count
    return tuple(blocks)


def _check_unique(outputs: list[Output]) -> None:
    seen: set[str] = set()
    for output in outputs:
        if output.channel.name in seen:
            name = output.channel.name
            words = f"two parts give a channel named '{name}'; rename one of them"
            raise InputError(words, about=[name, name.rpartition(".")[0]])
        seen.add(output.channel.name)


def _words(joint: Joint) -> str:
    return joint.kind if joint.siblings else f"{joint.kind} {joint.name}"


def _structure(
    system: System,
    symbols: Symbols,
    loops: Loops,
    roles: Roles,
    multipliers: ConstrainedMotion | None,
) -> dict[str, object]:
    """Return facts for people: bodies, coordinates by role, cuts, redundant constraints."""
    name = [j.name for j in symbols.joints]
    partition = loops.closure.partition
    bears = (
        len(loops.closure.multipliers({})) if isinstance(loops.closure, MultiplierClosure) else 0
    )
    return {
        "bodies": [
            {
                "name": b.name,
                "parent": b.parent,
                "joints": [_words(j) for j in b.joints if isinstance(j, Joint) and j.leads],
                "massless": b.mass is None,
            }
            for b in system.bodies
        ],
        "independent": [name[k] for k in roles.independent],
        "dependent": [name[k] for k in roles.dependent],
        "driven": [name[k] for k in roles.driven],
        "rate_dependent": [name[k] for k in roles.following],
        "locked": sorted(locked(system, symbols)),
        "cuts": [cut.name for cut in system.cuts],
        "constraints": [constraint.name for constraint in system.constraints],
        "loops": [
            [loops.constraints[row].cut for row, _ in block] for block in loops.positions.blocks
        ],
        "redundant": [loops.constraints[row].cut for row in partition.redundant],
        "redundancies": loops.redundancies,
        "rigid_loops": [
            {"constraints": list(r.constraints), "coordinates": list(r.coordinates)}
            for r in loops.rigid
        ],
        "undetermined": [loops.constraints[row].label for row in sorted(loops.undetermined)],
        "parts": [part.name for part in system.parts],
        "degrees_of_freedom": len(roles.independent) - bears,
        "constraint_method": "multipliers" if bears else "partitioning",
        "sparse_solves": multipliers is not None and multipliers.solves_sparsely,
    }
