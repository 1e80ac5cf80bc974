"""Derive the equations of a system: the whole path from bodies to ẋ = f(t, x, z, p)."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, partial

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.equations.assemble_equations import (
    Roles,
    collect,
    roles_of,
)
from vehicledyn.multibody.equations.multipliers import ConstrainedMotion, Projection, multipliers_of
from vehicledyn.multibody.equations.outputs import Solved
from vehicledyn.multibody.equations.residual_form import Unsolved, refuse_unsuitable, residual_form
from vehicledyn.multibody.equations.seam import Handed, Replacement
from vehicledyn.multibody.equations.singular_mass import Resistance, refuse_idle
from vehicledyn.multibody.loops.closure import Closure, MultiplierClosure
from vehicledyn.multibody.loops.loop_closure import AssemblyState, Loops, close
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import DrivenMotion, Loads, loads_of
from vehicledyn.multibody.model.symbols import Symbols, declare, motions
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.model.tree import Tree, unfold
from vehicledyn.multibody.recursion.barycentric import augmented_inertias
from vehicledyn.multibody.recursion.body_checks import check_bodies
from vehicledyn.multibody.recursion.forward_dynamics import (
    Formulation,
    TreeProblem,
    missing_forces,
    solve_tree,
)
from vehicledyn.multibody.recursion.substructuring import solve_loops
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.constrained_equations import ConstrainedEquations
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.motion_residuals import MotionResiduals
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.quick_arithmetic import quick_arithmetic
from vehicledyn.symbolic.sparse_rows import matrix_of

_log = logging.getLogger(__name__)


def derive(
    system: System, *, formulation: Formulation = "auto", moment: AssemblyState | None = None
) -> Equations:
    """Return the symbolic equations of a system.

    M(q) q̈ + c(q, q̇, loads) = Jᵀ λ of the tree, reduced to the independent coordinates by the
    partitioned constraints (book, chapters 3.3 and 4.5.1). The order of states, unknowns and
    residuals is described in :func:`~vehicledyn.multibody.equations.assemble_equations.collect`.
    The log reports loops without freedom: frames whose forces are found, but that cannot move.

    Parameters
    ----------
    system
        Bodies, cuts and parts; its parameter values are used for assembly and partition only.
    formulation
        "composite" factorises the mass matrix, "articulated" is the recursion of order N, for
        trees without cuts only; "auto" takes the one with fewer operations, and condenses
        closed sub-systems to the body that carries them where one does.
    moment
        When the loops are assembled; None for the start at time zero.

    Returns
    -------
    Equations
        Symbolic in time, states, unknowns and every parameter of the system's table.

    Raises
    ------
    InputError
        If the system is not well formed, a body has an impossible mass or inertia, a part
        drives or loads what it cannot, the assembled configuration or the mass matrix is
        singular, or constraints contradict each other.
    NumericalError
        If its loops cannot be assembled.
    """
    derivation = solve_motion(system, formulation, moment, apart=True)
    for loop in derivation.loops.rigid:
        _log.warning("%s", loop)
    return equations_of(derivation)


@dataclass(frozen=True)
class Derivation:
    """A system solved for its accelerations, with everything found on the way."""

    system: System
    tree: Tree
    symbols: Symbols
    replacement: Replacement
    loops: Loops
    roles: Roles
    solved: Solved
    resistance: Resistance
    multipliers: ConstrainedMotion | None = None
    projection: Projection | None = None

    @property
    def moved(self) -> dict[str, DrivenMotion]:
        """Motions of the driven coordinates by name."""
        return self.replacement.moved


@quick_arithmetic()
def solve_motion(
    system: System,
    formulation: Formulation = "auto",
    moment: AssemblyState | None = None,
    *,
    apart: bool = False,
) -> Derivation:
    """Return a checked system solved for its accelerations, see :func:`derive`.

    With ``apart`` symbols stand for what its surroundings hand over, but not with multipliers,
    whose states surroundings see only after they are put onto the constraints.
    """
    system.check()
    check_bodies(system)
    tree = unfold(system.bodies)
    symbols = declare(system)
    if formulation == "articulated" and (system.cuts or system.constraints):
        raise InputError(
            f"system '{system.name}' has cuts or constraints; the articulated recursion is for "
            "open trees only"
        )
    moved = motions(system, symbols)
    loops = close(system, tree, symbols, moved, moment)
    multipliers = multipliers_of(system, symbols, loops)
    projection = None
    if multipliers is not None:
        loops, projection = multipliers.closed(), multipliers.projection()
    roles = roles_of(symbols, loops)
    resistance = Resistance(system, tree, symbols, loops.closure, roles.independent)
    if moment is None and multipliers is None:
        start = np.array([loops.start[j.name] for j in symbols.joints])
        refuse_idle(system, resistance.anywhere(0.0, start))
    handed = Handed()
    is_apart = apart and multipliers is None
    motion = _motion(system, symbols, roles, loops, handed if is_apart else None)
    if multipliers is None:
        solved = _dynamics(system, symbols, roles, loops.closure, motion, formulation=formulation)
    else:
        solved, found = _by_multipliers(system, symbols, roles, multipliers, motion)
        loops = multipliers.closed(found)
    return Derivation(
        system,
        tree,
        symbols,
        Replacement(symbols, moved, handed),
        loops,
        roles,
        solved,
        resistance,
        multipliers,
        projection,
    )


@quick_arithmetic()
def equations_of(derivation: Derivation) -> Equations:
    """Return the equations of a solved system, in the order of states and channels."""
    d = derivation
    equations = collect(
        d.system,
        d.symbols,
        loops=d.loops,
        roles=d.roles,
        solved=d.solved,
        replacement=d.replacement,
        multipliers=d.multipliers,
        projection=d.projection,
    )
    return replace(
        equations,
        constrained=cache(partial(_constrained, d, equations)),
        motion_residuals=(
            cache(partial(_motion_residuals, d, equations)) if d.multipliers is None else None
        ),
    )


@quick_arithmetic()
def _constrained(derivation: Derivation, equations: Equations) -> ConstrainedEquations:
    """Return the residuals of a solved system, see :func:`residual_form`."""
    d = derivation
    refuse_unsuitable(d.system, equations)
    motion = _motion(d.system, d.symbols, d.roles, d.loops)
    given = _given_accelerations(d.symbols, d.roles, motion.loads)
    names = [equations.states[k].name for k in equations.positions]
    free = {name: ops.symbol(f"{name}_acceleration") for name in names}
    problem = _problem(d.system, d.symbols, d.roles, motion, {**given, **free})
    unsolved = Unsolved(
        d.system,
        d.symbols,
        d.loops,
        rows=[] if d.multipliers is None else d.multipliers.rows,
        problem=problem,
        accelerations=free,
        given=given,
        solved=_solved(problem, motion, {**given, **free}),
        finished=Replacement(d.symbols, d.moved),
    )
    return residual_form(unsolved, equations)


@quick_arithmetic()
def _motion_residuals(derivation: Derivation, equations: Equations) -> MotionResiduals:
    """Return what the accelerations of a solved system fulfil."""
    d = derivation
    motion = _motion(d.system, d.symbols, d.roles, d.loops)
    joints = [d.symbols.joints[k] for k in d.roles.independent]
    names = [joint.name for joint in joints]
    free = {name: ops.symbol(f"{name}_acceleration") for name in names}
    given = _given_accelerations(d.symbols, d.roles, motion.loads) | free
    closure = _with_rates(d.loops.closure, d.symbols, motion.rates)
    accelerations = _closed(closure, d.symbols, (*d.roles.driven, *d.roles.independent), given)
    problem = _problem(d.system, d.symbols, d.roles, motion, accelerations)
    missing, mass = missing_forces(problem, names, _influence(closure, d.symbols, d.roles))
    place = {state.name: k for k, state in enumerate(equations.states)}
    e, finished = equations, Replacement(d.symbols, d.moved)
    return MotionResiduals(
        time=e.time,
        state=e.state,
        algebraic=e.algebraic,
        parameter=e.parameter,
        acceleration=ops.column([free[name] for name in names]),
        residual=finished(ops.column(missing)),
        mass=finished(matrix_of(mass, len(names))),
        rows=tuple(place[joint.rate_name] for joint in joints),
    )


@dataclass(frozen=True)
class _MotionState:
    """Kinematics at velocity level and what the parts contribute there."""

    kinematics: Kinematics
    rates: dict[str, Scalar]
    loads: dict[str, Loads]


def _motion(
    system: System,
    symbols: Symbols,
    roles: Roles,
    loops: Loops,
    handed: Handed | None = None,
) -> _MotionState:
    """Close the velocities and ask the parts for their loads; ``handed`` are those of others."""
    joints = symbols.joints
    rates = dict(symbols.rates)
    known = {k: rates[joints[k].name] for k in (*roles.independent, *roles.driven)}
    for k, rate in loops.closure.dependent_rates(known).items():
        rates[joints[k].name] = rate
    kinematics = loops.kinematics.with_rates(rates)
    outside = system.surroundings if handed is not None else ()
    loads = {
        p.name: (handed.loads if handed is not None and p.name in outside else loads_of)(
            p, symbols.situation(p, kinematics)
        )
        for p in system.parts
    }
    return _MotionState(kinematics, rates, loads)


def _dynamics(
    system: System,
    symbols: Symbols,
    roles: Roles,
    closure: Closure | MultiplierClosure,
    motion: _MotionState,
    *,
    formulation: Formulation,
) -> Solved:
    """Solve the equations of motion for all accelerations."""
    closure = _with_rates(closure, symbols, motion.rates)
    given = _given_accelerations(symbols, roles, motion.loads)
    at_rest = _closed(closure, symbols, roles.driven, given)
    problem = _problem(system, symbols, roles, motion, at_rest)
    influence = _influence(closure, symbols, roles)
    if influence:
        independent = [symbols.joints[k].name for k in roles.independent]
        solved = solve_loops(problem, independent, influence, formulation)
    else:
        solved = solve_tree(problem, system.table, formulation)
    accelerations = {**at_rest, **solved}
    for u, row in influence.items():
        for v, entry in row.items():
            accelerations[u] = accelerations[u] + entry * solved[v]
    return _solved(problem, motion, accelerations)


def _closed(
    closure: Closure | MultiplierClosure,
    symbols: Symbols,
    known: Sequence[int],
    given: dict[str, Scalar],
) -> dict[str, Scalar]:
    """Return accelerations with those of the dependent coordinates that known ones demand."""
    names = [j.name for j in symbols.joints]
    found = closure.dependent_accelerations({k: given[names[k]] for k in known})
    return given | {names[k]: value for k, value in found.items()}


def _influence(
    closure: Closure | MultiplierClosure, symbols: Symbols, roles: Roles
) -> dict[str, dict[str, Scalar]]:
    """Return how the dependent rates follow the independent ones, by name."""
    names = [j.name for j in symbols.joints]
    return {
        names[u]: {names[v]: entry for v, entry in row.items()}
        for u, row in closure.influence(roles.independent).items()
    }


def _by_multipliers(
    system: System,
    symbols: Symbols,
    roles: Roles,
    multipliers: ConstrainedMotion,
    motion: _MotionState,
) -> tuple[Solved, dict[int, Scalar]]:
    """Solve the equations of motion for all accelerations and multipliers together."""
    given = _given_accelerations(symbols, roles, motion.loads)
    problem = _problem(system, symbols, roles, motion, given)
    found, forces = multipliers.accelerations(problem, given)
    return _solved(problem, motion, {**given, **found}), forces


def _problem(
    system: System,
    symbols: Symbols,
    roles: Roles,
    motion: _MotionState,
    accelerations: dict[str, Scalar],
) -> TreeProblem:
    """Return the tree at some accelerations, with what acts on it."""
    names = [j.name for j in symbols.joints]
    return TreeProblem(
        motion.kinematics.with_accelerations(accelerations),
        augmented_inertias(motion.kinematics.tree),
        [w for load in motion.loads.values() for w in load.wrenches],
        _joint_forces(symbols, motion.loads),
        ops.vector(*system.gravity),
        [names[k] for k in (*roles.independent, *roles.dependent, *roles.following)],
    )


def _solved(problem: TreeProblem, motion: _MotionState, accelerations: dict[str, Scalar]) -> Solved:
    return Solved(
        motion.kinematics.with_accelerations(accelerations),
        accelerations,
        list(problem.wrenches),
        problem.joint_forces,
        motion.rates,
        motion.loads,
        problem.gravity,
    )


def _given_accelerations(
    symbols: Symbols, roles: Roles, loads: dict[str, Loads]
) -> dict[str, Scalar]:
    """Return the accelerations of driven coordinates, and zero for all others."""
    given = {j.name: ops.scalar(0.0) for j in symbols.joints}
    driven = {symbols.joints[k].name for k in roles.driven}
    for part, load in loads.items():
        for name, acceleration in load.accelerations.items():
            if name not in driven:
                raise InputError(f"part '{part}' drives '{name}', which is not a driven joint")
            given[name] = ops.scalar(acceleration)
    return given


def _with_rates(
    closure: Closure | MultiplierClosure, symbols: Symbols, rates: dict[str, Scalar]
) -> Closure | MultiplierClosure:
    """Replace the rates in the quadratic term by their closed expressions."""
    old = symbols.rate_column
    new = ops.column([rates[j.name] for j in symbols.joints])
    return replace(closure, quadratic=[ops.substitute(v, old, new) for v in closure.quadratic])


def _joint_forces(symbols: Symbols, loads: dict[str, Loads]) -> dict[str, Scalar]:
    known = {j.name for j in symbols.joints if j.type.has_speed}
    total: dict[str, Scalar] = {}
    for part, load in loads.items():
        for name, force in load.joint_forces.items():
            if name not in known:
                raise InputError(f"part '{part}' acts on '{name}', which is not a coordinate")
            total[name] = total.get(name, 0.0) + force
    return total
