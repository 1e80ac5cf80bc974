"""Derive the equations of a system: the whole path from bodies to ẋ = f(t, x, z, p)."""

from __future__ import annotations

from dataclasses import dataclass, replace

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodycheck import check_bodies
from vehicledyn.multibody.closure import Closure
from vehicledyn.multibody.dynamics import inverse_dynamics, mass_matrix
from vehicledyn.multibody.kinematics import Kinematics
from vehicledyn.multibody.loops import Loops, close
from vehicledyn.multibody.observation import Solved, observe
from vehicledyn.multibody.parts import Loads, Motion, Output, Part, Situation
from vehicledyn.multibody.reduction import independent_accelerations
from vehicledyn.multibody.system import Joint, System
from vehicledyn.multibody.tree import Tree, unfold
from vehicledyn.multibody.unknowns import Symbols, declare, locked, motions
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Block, Equations, ParameterValue, Variable
from vehicledyn.symbolic.ops import Scalar

LOOP_TOLERANCE = 1e-12
"""Residual at which a loop counts as closed [m]; a hundredth of what users are promised."""


def derive(system: System) -> Equations:
    """Return the symbolic equations of a system.

    Raises
    ------
    InputError
        If the system is not well formed, or a body has an impossible mass or inertia.
    NumericalError
        If its loops cannot be assembled.
    """
    system.check()
    check_bodies(system)
    tree = unfold(system)
    symbols = declare(system)
    moved = motions(system, symbols)
    loops = close(system, tree, symbols, moved)
    roles = _roles(symbols, loops)
    motion = _motion(system, tree, symbols, roles, loops.closure)
    solved = _dynamics(system, symbols, roles, loops.closure, motion)
    return _collect(system, symbols, loops, roles, solved, moved)


@dataclass(frozen=True)
class _Roles:
    """Indices of independent, dependent (in the order of solution) and driven coordinates."""

    independent: list[int]
    dependent: list[int]
    driven: list[int]


@dataclass(frozen=True)
class _MotionState:
    """Kinematics at velocity level and what the parts contribute there."""

    kinematics: Kinematics
    rates: dict[str, Scalar]
    loads: dict[str, Loads]


def _roles(symbols: Symbols, loops: Loops) -> _Roles:
    dependent = loops.dependent
    driven = [k for k, j in enumerate(symbols.joints) if j.role == "driven"]
    taken = {*dependent, *driven}
    independent = [k for k in range(len(symbols.joints)) if k not in taken]
    return _Roles(independent, dependent, driven)


def _motion(
    system: System,
    tree: Tree,
    symbols: Symbols,
    roles: _Roles,
    closure: Closure,
) -> _MotionState:
    """Close the velocities and ask the parts for their loads."""
    joints = symbols.joints
    rates = dict(symbols.rates)
    known = {k: rates[joints[k].name] for k in (*roles.independent, *roles.driven)}
    for k, rate in closure.dependent_rates(known).items():
        rates[joints[k].name] = rate
    kinematics = Kinematics(tree, symbols.coordinates, rates)
    loads = {part.name: part.loads(_situation(symbols, part, kinematics)) for part in system.parts}
    return _MotionState(kinematics, rates, loads)


def _situation(symbols: Symbols, part: Part, kinematics: Kinematics) -> Situation:
    return Situation(
        symbols.time, symbols.states[part.name], symbols.unknowns[part.name], kinematics
    )


def _dynamics(
    system: System,
    symbols: Symbols,
    roles: _Roles,
    closure: Closure,
    motion: _MotionState,
) -> Solved:
    """Solve the equations of motion for all accelerations."""
    joints = symbols.joints
    closure = _with_rates(closure, symbols, motion.rates)
    names = {k: joints[k].name for k in range(len(joints))}
    given = {name: ops.scalar(0.0) for name in names.values()}
    for load in motion.loads.values():
        given.update({n: ops.scalar(a) for n, a in load.accelerations.items()})
    known = {k: given[names[k]] for k in roles.driven}
    bias_accelerations = dict(given)
    for k, value in closure.dependent_accelerations(known).items():
        bias_accelerations[names[k]] = value
    gravity = ops.vector(*system.gravity)
    wrenches = [w for load in motion.loads.values() for w in load.wrenches]
    joint_forces = _joint_forces(symbols, motion.loads)
    needed, _ = inverse_dynamics(
        motion.kinematics.with_accelerations(bias_accelerations), wrenches, gravity
    )
    bias = {n: needed[n] - joint_forces.get(n, 0.0) for n in needed}
    moving = [names[k] for k in (*roles.independent, *roles.dependent)]
    mass = mass_matrix(motion.kinematics, set(moving))
    influence = {
        names[u]: {names[v]: entry for v, entry in row.items()}
        for u, row in closure.influence(roles.independent).items()
    }
    independent = [names[k] for k in roles.independent]
    solved = independent_accelerations(mass, {n: bias[n] for n in moving}, independent, influence)
    accelerations = {**bias_accelerations, **solved}
    for u, row in influence.items():
        for v, entry in row.items():
            accelerations[u] = accelerations[u] + entry * solved[v]
    known_kinematics = motion.kinematics.with_accelerations(accelerations)
    return Solved(
        known_kinematics, accelerations, wrenches, joint_forces, motion.rates, motion.loads, gravity
    )


def _with_rates(closure: Closure, symbols: Symbols, rates: dict[str, Scalar]) -> Closure:
    """Replace the rates in the quadratic term by their closed expressions."""
    old = symbols.rate_column
    new = ops.column([rates[j.name] for j in symbols.joints])
    return replace(closure, quadratic=[ops.substitute(v, old, new) for v in closure.quadratic])


def _joint_forces(symbols: Symbols, loads: dict[str, Loads]) -> dict[str, Scalar]:
    known = {j.name for j in symbols.joints}
    total: dict[str, Scalar] = {}
    for part, load in loads.items():
        for name, force in load.joint_forces.items():
            if name not in known:
                raise InputError(f"part '{part}' acts on '{name}', which is not a coordinate")
            total[name] = total.get(name, 0.0) + force
    return total


def _collect(
    system: System,
    symbols: Symbols,
    loops: Loops,
    roles: _Roles,
    solved: Solved,
    moved: dict[str, Motion],
) -> Equations:
    """Put everything in the order of the Equations value."""
    joints = symbols.joints
    part_states = [(p, v) for p in system.parts for v in p.states()]
    part_unknowns = [(p, v) for p in system.parts for v in p.unknowns()]
    independent = [joints[k] for k in roles.independent]
    dependent = [joints[k] for k in roles.dependent]
    state = [
        *(symbols.coordinates[j.name] for j in independent),
        *(symbols.rates[j.name] for j in independent),
        *(symbols.states[p.name][v.name] for p, v in part_states),
    ]
    rate = [
        *(symbols.rates[j.name] for j in independent),
        *(solved.accelerations[j.name] for j in independent),
        *(solved.loads[p.name].rates[v.name] for p, v in part_states),
    ]
    algebraic = [
        *(symbols.coordinates[j.name] for j in dependent),
        *(symbols.unknowns[p.name][v.name] for p, v in part_unknowns),
    ]
    contact = [r for p in system.parts for r in solved.loads[p.name].residuals]
    kept = [loops.constraints[row].residual.expression for row, _ in loops.closure.partition.pairs]
    outputs = observe(system, symbols, loops, solved)
    _check_unique(outputs)
    n = len(independent)
    return Equations(
        name=system.name,
        time=symbols.time,
        state=ops.column(state),
        algebraic=ops.column(algebraic),
        parameter=ops.column([e.symbol for e in system.table.entries]),
        rate=_put_motions(ops.column(rate), symbols, moved),
        residual=_put_motions(ops.column([*kept, *contact]), symbols, moved),
        output=_put_motions(ops.column([o.expression for o in outputs]), symbols, moved),
        event=ops.column([]),
        states=(*_coordinate_states(independent, loops), *_part_variables(part_states)),
        unknowns=(
            *(_coordinate(j, loops.start[j.name]) for j in dependent),
            *_part_variables(part_unknowns),
        ),
        parameters=tuple(
            ParameterValue(e.name, e.unit, e.description, e.value) for e in system.table.entries
        ),
        channels=tuple(o.channel for o in outputs),
        blocks=(*_loop_blocks(loops), *_part_blocks(system, len(dependent))),
        positions=tuple(range(n)),
        velocities=tuple(range(n, 2 * n)),
        structure=_structure(system, symbols, loops, roles),
    )


def _put_motions(expression: Scalar, symbols: Symbols, moved: dict[str, Motion]) -> Scalar:
    """Return an expression with the driven coordinates and rates replaced by their motions."""
    old = [symbols.coordinates[n] for n in moved] + [symbols.rates[n] for n in moved]
    new = [m.position for m in moved.values()] + [m.velocity for m in moved.values()]
    return ops.substitute(expression, ops.column(old), ops.column(new))


def _coordinate(joint: Joint, start: float) -> Variable:
    return Variable(joint.name, joint.unit, joint.description or joint.name, start)


def _coordinate_states(joints: list[Joint], loops: Loops) -> tuple[Variable, ...]:
    positions = [_coordinate(j, loops.start[j.name]) for j in joints]
    rates = [
        Variable(
            f"{j.name}_rate", f"{j.unit}/s", f"Rate of {j.description or j.name}", j.start_rate
        )
        for j in joints
    ]
    return (*positions, *rates)


def _part_variables(pairs: list[tuple[Part, Variable]]) -> tuple[Variable, ...]:
    return tuple(replace(v, name=f"{p.name}.{v.name}") for p, v in pairs)


def _loop_blocks(loops: Loops) -> tuple[Block, ...]:
    blocks, first = [], 0
    for pairs in loops.closure.partition.blocks:
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
            blocks.append(Block(part.name, first, first + count, LOOP_TOLERANCE))
            first += count
    return tuple(blocks)


def _check_unique(outputs: list[Output]) -> None:
    seen: set[str] = set()
    for output in outputs:
        if output.channel.name in seen:
            raise InputError(f"two parts give a channel named '{output.channel.name}'")
        seen.add(output.channel.name)


def _structure(system: System, symbols: Symbols, loops: Loops, roles: _Roles) -> dict[str, object]:
    """Return facts for people: bodies, coordinates by role, cuts, redundant constraints."""
    name = [j.name for j in symbols.joints]
    partition = loops.closure.partition
    return {
        "bodies": [
            {
                "name": b.name,
                "parent": b.parent,
                "joints": [f"{j.kind} {j.name}" for j in b.joints if isinstance(j, Joint)],
                "massless": b.mass is None,
            }
            for b in system.bodies
        ],
        "independent": [name[k] for k in roles.independent],
        "dependent": [name[k] for k in roles.dependent],
        "driven": [name[k] for k in roles.driven],
        "locked": sorted(locked(system, symbols)),
        "cuts": [cut.name for cut in system.cuts],
        "loops": [[loops.constraints[row].cut for row, _ in block] for block in partition.blocks],
        "redundant": [loops.constraints[row].cut for row in partition.redundant],
        "parts": [part.name for part in system.parts],
        "degrees_of_freedom": len(roles.independent),
    }
