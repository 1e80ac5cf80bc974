"""Write a derived system as residuals with multipliers, for implicit methods of index 3 and 2."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.equations.multipliers import largest_size
from vehicledyn.multibody.equations.outputs import Solved, exerted, observe
from vehicledyn.multibody.loops.closure import MultiplierClosure
from vehicledyn.multibody.loops.loop_closure import Loops
from vehicledyn.multibody.model.symbols import Symbols
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.recursion.forward_dynamics import TreeProblem
from vehicledyn.multibody.recursion.newton_euler import inverse_dynamics
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.constrained_equations import ConstrainedEquations
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.quick_arithmetic import quick_arithmetic
from vehicledyn.symbolic.sparse_rows import matrix_of


@dataclass(frozen=True)
class Unsolved:
    """A system before its accelerations are solved for.

    ``rows`` are the constraints with multipliers. ``problem`` is the tree at the symbols
    ``accelerations`` of the coordinates, with what acts on it, and ``solved`` the same with all
    that channels show; ``given`` are the accelerations of the driven coordinates. ``finished`` puts
    the motions of driven coordinates into an expression.
    """

    system: System
    symbols: Symbols
    loops: Loops
    rows: list[int]
    problem: TreeProblem
    solved: Solved
    accelerations: dict[str, Scalar]
    given: dict[str, Scalar]
    finished: Callable[[Scalar], Scalar]


def refuse_unsuitable(system: System, equations: Equations) -> None:
    """Raise InputError if residuals with multipliers cannot hold what a system has."""
    found = ""
    if equations.attitudes:
        found = "quaternions"
    elif equations.structure["dependent"] or equations.structure["rate_dependent"]:
        found = "loops closed by partitioning; take 'constraint_method: multipliers'"
    elif equations.unknowns:
        found = f"unknowns found by iteration, such as '{equations.unknowns[0].name}'"
    if found:
        raise InputError(
            f"system '{system.name}' has {found}; methods on constrained residuals cannot take "
            "it, 'constraints: reduced' can"
        )


def residual_form(unsolved: Unsolved, equations: Equations) -> ConstrainedEquations:
    """Return the residuals of a system whose ``equations`` have been derived."""
    u, s, closure = unsolved, unsolved.symbols, unsolved.loops.closure
    names = list(u.accelerations)
    p = u.problem
    needed, _ = inverse_dynamics(p.kinematics, p.wrenches, p.gravity, p.inertias)
    multipliers = [ops.symbol(f"multiplier_{row}") for row in u.rows]
    place = {name: k for k, name in enumerate(names)}
    index = {k: place[j.name] for k, j in enumerate(s.joints) if j.name in place}
    jacobian = [
        {index[c]: entry for c, entry in closure.jacobian[row].items() if c in index}
        for row in u.rows
    ]
    force = [needed[name] - p.joint_forces.get(name, 0.0) for name in names]
    for entries, multiplier in zip(jacobian, multipliers, strict=True):
        for k, entry in entries.items():
            force[k] = force[k] + entry * multiplier
    others = [(p.name, v.name) for p in u.system.parts for v in p.states()]
    full = {f"{part}.{name}" for part, name in others}
    finished, loads = u.finished, u.solved.loads
    return ConstrainedEquations(
        time=equations.time,
        position=ops.column([s.coordinates[name] for name in names]),
        velocity=ops.column([s.rates[name] for name in names]),
        acceleration=ops.column([u.accelerations[name] for name in names]),
        multiplier=ops.column(multipliers),
        other=ops.column([s.states[part][name] for part, name in others]),
        parameter=equations.parameter,
        force=finished(ops.column(force)),
        gap=finished(ops.column([u.loops.constraints[row].residual.expression for row in u.rows])),
        opening=finished(ops.column([_opening(u, row) for row in u.rows])),
        quadratic=finished(ops.column([_quadratic(u, row) for row in u.rows])),
        jacobian=finished(matrix_of(jacobian, len(names))),
        other_rate=finished(ops.column([loads[part].rates[name] for part, name in others])),
        labels=tuple(u.loops.constraints[row].label for row in u.rows),
        positions=equations.positions,
        velocities=equations.velocities,
        others=tuple(k for k, v in enumerate(equations.states) if v.name in full),
        output=cache(partial(_output, u, multipliers)) if u.rows else None,
    )


@quick_arithmetic()
def _output(unsolved: Unsolved, multipliers: list[Scalar]) -> Scalar:
    """Return the channels at the symbols of accelerations and multipliers, which nothing solves."""
    u, closure = unsolved, unsolved.loops.closure
    if isinstance(closure, MultiplierClosure):
        forces = {row: -symbol for row, symbol in zip(u.rows, multipliers, strict=True)}
        closure = replace(closure, found=forces)
    loops = replace(u.loops, closure=closure)
    outputs = observe(
        u.system, u.symbols, loops, u.solved, exerted(u.system, u.symbols, loops, u.solved)
    )
    gaps = [loops.constraints[row].residual.expression for row in u.rows]
    drifts = largest_size(gaps), largest_size([_opening(u, row) for row in u.rows])
    return u.finished(ops.column([*(o.expression for o in outputs), *drifts]))


def _opening(unsolved: Unsolved, row: int) -> Scalar:
    """Return the rate of a constraint, of free and driven coordinates together."""
    closure, s = unsolved.loops.closure, unsolved.symbols
    total = closure.rate[row]
    for column, entry in closure.jacobian[row].items():
        total = total + entry * s.rates[s.joints[column].name]
    return total


def _quadratic(unsolved: Unsolved, row: int) -> Scalar:
    """Return the acceleration of a constraint where the free coordinates have none."""
    closure, joints = unsolved.loops.closure, unsolved.symbols.joints
    total = closure.quadratic[row]
    for column, entry in closure.jacobian[row].items():
        name = joints[column].name
        if name not in unsolved.accelerations:
            total = total + entry * unsolved.given[name]
    return total
