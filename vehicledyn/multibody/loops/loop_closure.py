"""From cuts to a closure: assemble, choose the dependent coordinates, differentiate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.loops.assembly import NotAssembledError
from vehicledyn.multibody.loops.assembly_diagnosis import RigidLoop, rigid_loops, why_open
from vehicledyn.multibody.loops.closure import Closure, MultiplierClosure
from vehicledyn.multibody.loops.configuration import (
    Guess,
    LoopAssembly,
    explain,
    refuse_contradictions,
    refuse_singular,
    warn_weak,
)
from vehicledyn.multibody.loops.constraint_equations import ConstraintRow, Gaps, rows_of_system
from vehicledyn.multibody.loops.partition import Partition
from vehicledyn.multibody.loops.redundancy import SelfStress, self_stresses
from vehicledyn.multibody.model.constraints import BaseConstraint, Geometry
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import DrivenMotion
from vehicledyn.multibody.model.symbols import Symbols, locked
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.model.tree import Tree, unfold
from vehicledyn.symbolic import ops

Array = NDArray[np.float64]


@dataclass(frozen=True)
class AssemblyState:
    """When the loops are assembled: time [s] and states of parts by full name, as started."""

    time: float = 0.0
    states: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Loops:
    """Constraints of a system, their closure and the assembled start.

    ``positions`` is the partition of the coordinates; that of the rates stands in the closure.
    ``start`` holds the assembled value of every coordinate. Coordinates are indexed like
    ``Symbols.joints``, rows like ``constraints``. ``stresses`` says which multipliers are not
    unique; it is empty where no constraint is redundant. ``kinematics`` is that at symbolic
    rates, with the motions that the constraints look at evaluated. ``rigid`` are loops without
    freedom.
    """

    constraints: list[ConstraintRow]
    positions: Partition
    closure: Closure | MultiplierClosure
    start: dict[str, float]
    kinematics: Kinematics
    gaps: Gaps
    redundancies: list[dict[str, object]]
    stresses: tuple[SelfStress, ...] = ()
    rigid: tuple[RigidLoop, ...] = ()

    @property
    def dependent(self) -> list[int]:
        """Indices of the dependent coordinates, in the order of solution."""
        return self.positions.columns

    @property
    def following(self) -> list[int]:
        """Indices of the coordinates that are free while their rates are dependent."""
        known = set(self.dependent)
        return [c for c in self.closure.partition.columns if c not in known]

    @property
    def undetermined(self) -> set[int]:
        """Rows whose multipliers are not unique, as redundant constraints share their load."""
        return {row for stress in self.stresses for row in stress.rows}


def close(
    system: System,
    tree: Tree,
    symbols: Symbols,
    motion: dict[str, DrivenMotion],
    moment: AssemblyState | None = None,
) -> Loops:
    """Assemble the loops, partition the coordinates and derive the closure.

    Parameters
    ----------
    system, tree, symbols
        The system, its links and its symbols.
    motion
        Position and velocity of the driven coordinates.
    moment
        When the loops are assembled; None for the start at time zero.

    Raises
    ------
    NumericalError
        If the loops cannot be assembled; the message names the cuts that stay open.
    InputError
        If a coordinate declared dependent is not determined by the loops, the assembled
        configuration is singular, or constraints contradict each other or what is declared to
        move.
    """
    when = moment or AssemblyState()
    kinematics = symbols.kinematics(tree)
    gaps = Gaps(system, symbols, rows_of_system(system, kinematics, symbols.time))
    given = start_values(system, symbols, motion, when)
    still = locked(system, symbols)
    place = LoopAssembly(symbols.joints, gaps, when.time, still)
    try:
        q = place.assembled_by(given, guesses(system, symbols, when.time))
    except NotAssembledError as error:
        raise why_open(system, place, given, error) from None
    chosen = place.chosen(q)
    if chosen.rates.redundancies:
        refuse_singular(place, q, chosen)
        refuse_contradictions(place, q, chosen)
    warn_weak(place, chosen)
    stresses = self_stresses(place, q) if chosen.rates.redundancies else ()
    found = gaps.differentiate()
    return Loops(
        gaps.rows,
        chosen.positions,
        Closure(chosen.rates, found.jacobian, found.rate, found.quadratic),
        {j.name: float(value) for j, value in zip(symbols.joints, q, strict=True)},
        kinematics,
        gaps,
        [explain(system, place, item) for item in chosen.rates.redundancies],
        stresses,
        rigid_loops(system, place, q),
    )


def start_values(
    system: System, symbols: Symbols, motion: dict[str, DrivenMotion], moment: AssemblyState
) -> Array:
    """Return the start values of all coordinates, driven ones from their motion."""
    values = np.array([entry.value for entry in system.table.entries])
    return starts_at(system, symbols, motion)(moment, values)


def starts_at(
    system: System, symbols: Symbols, motion: dict[str, DrivenMotion]
) -> Callable[[AssemblyState, Array], Array]:
    """Return what gives these start values at a moment and values of all parameters."""
    states = [s for part in symbols.states.values() for s in part.values()]
    entries = system.table.entries
    known = [symbols.time, ops.column(states), ops.column([e.symbol for e in entries])]
    driven = [k for k, j in enumerate(symbols.joints) if j.name in motion]
    positions = ops.column([motion[symbols.joints[k].name].position for k in driven])
    at = ops.numeric(known, positions)

    def found(moment: AssemblyState, values: Array) -> Array:
        q = np.array([j.start for j in symbols.joints])
        starts = [
            moment.states.get(f"{part.name}.{v.name}", v.start)
            for part in system.parts
            for v in part.states()
        ]
        q[driven] = at(moment.time, starts, values)[:, 0]
        return q

    return found


def guesses(system: System, symbols: Symbols, time: float) -> Guess:
    """Return what the constraints guess of coordinates of their own."""
    numbers = np.array([entry.value for entry in system.table.entries])
    return guesses_at(system, symbols)(time, numbers)


def guesses_at(system: System, symbols: Symbols) -> Callable[[float, Array], Guess]:
    """Return what gives these guesses at a time [s] and values of all parameters."""
    if all(type(c).guesses is BaseConstraint.guesses for c in system.constraints):
        return lambda _time, _numbers: Guess((), lambda q: q)
    geometry = Geometry(symbols.time, symbols.kinematics(unfold(system.bodies)))
    found = {k: v for c in system.constraints for k, v in c.guesses(geometry).items()}
    entries = system.table.entries
    known = [symbols.time, symbols.coordinate_column, ops.column([e.symbol for e in entries])]
    guess = ops.numeric(known, ops.column([*found.values()]))
    names = [j.name for j in symbols.joints]
    places = [names.index(name) for name in found]
    return lambda time, numbers: Guess(places, lambda q: guess(time, q, numbers)[:, 0])
