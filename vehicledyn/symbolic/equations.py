"""The Equations value: all that solvers and result files need to know of a system.

    ẋ = f(t, x, z, p),    0 = g(t, x, z, p),    y = h(t, x, z, p)

x are the states (independent coordinates, their velocities, further states), z the algebraic
unknowns (dependent coordinates of the loops, contact coordinates), p the parameters and y the
named outputs. g is solved block by block in the given order: the residuals of a block depend
on its own unknowns and those of earlier blocks only, so each block is a small Newton problem.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

if TYPE_CHECKING:
    from vehicledyn.symbolic.constrained_equations import ConstrainedEquations
    from vehicledyn.symbolic.motion_residuals import MotionResiduals
    from vehicledyn.symbolic.tables import CurveTable

Expression = Any
"""A ``casadi.SX`` column."""

Direction: TypeAlias = Literal["rising", "falling", "either"]

BlockKind: TypeAlias = Literal["loop", "contact", "force"]
"""What the unknowns of a block are: coordinates of a loop, places of a contact, or forces of
constraints that the loads depend on."""


@dataclass(frozen=True)
class Variable:
    """A state or algebraic unknown: dotted name, unit, meaning and a value to start from."""

    name: str
    unit: str
    description: str
    start: float = 0.0


@dataclass(frozen=True)
class ParameterValue:
    """A parameter: dotted name, unit, meaning and its value in SI."""

    name: str
    unit: str
    description: str
    value: float


@dataclass(frozen=True)
class Channel:
    """A named output: dotted name from whole to part, unit, meaning and frame."""

    name: str
    unit: str
    description: str
    frame: str = ""


@dataclass(frozen=True)
class Block:
    """Unknowns ``start:stop`` of z, solved from the residuals ``start:stop`` of g.

    ``tolerance`` is the largest residual that counts as solved, in the residual's own unit,
    which ``unit`` states; ``name`` says which loop or part it is, for error messages.
    """

    name: str
    start: int
    stop: int
    tolerance: float
    unit: str = "m"
    kind: BlockKind = "loop"


@dataclass(frozen=True)
class Event:
    """A function of (t, x, z, p) whose sign change along the motion marks an event.

    ``index`` is its row of the equations' ``event``; only changes of the ``direction`` count.
    A terminal event ends the run. ``resets`` are pairs (state, row of the equations' ``reset``):
    at the event these states take the new values r(t, x, z, p), all at once, after which the
    unknowns are solved anew; ``guesses`` are pairs (unknown, row of ``reset``) of where to look
    for them then. ``advice`` says what a terminal event means and what to do, ``outcome`` how the
    run then ended: "ok", "derailed", "lifted", "overturned" or "sunk".
    """

    name: str
    index: int
    direction: Direction = "either"
    terminal: bool = False
    resets: tuple[tuple[int, int], ...] = ()
    guesses: tuple[tuple[int, int], ...] = ()
    advice: str = ""
    outcome: str = "ok"


@dataclass(frozen=True)
class Attitude:
    """A unit quaternion Q among the states, and the angular velocity that turns it.

    ``quaternion`` are the indices of its components (w, x, y, z), ``velocity`` those of ω in the
    turned axes, Q̇ = ½ Q ∘ (0, ω).
    """

    quaternion: tuple[int, ...]
    velocity: tuple[int, ...]


@dataclass(frozen=True)
class Seam:
    """What the surroundings of a model, such as driver and manoeuvre, hand to it.

    ``symbols`` and ``values``, shape (n,), stand for it and say what it is as functions of
    (t, x, z, p), by their ``names``. ``parts`` are the surroundings; states, channels and events
    are theirs whose names begin with that of one. ``opened`` are the same equations with the
    symbols in place of the values.
    """

    names: tuple[str, ...]
    symbols: Expression
    values: Expression
    parts: tuple[str, ...]
    opened: Equations

    def owns(self, name: str) -> bool:
        """Return whether a state, channel or event is one of the surroundings."""
        return any(name.startswith(f"{part}.") for part in self.parts)


@dataclass(frozen=True)
class Equations:
    """Symbolic equations of a system, see the module's text for the meaning of the parts.

    ``positions`` and ``velocities`` are the indices of x that form second-order pairs: the
    rate of ``x[positions[k]]`` is ``x[velocities[k]]``; ``attitudes`` are the quaternions among the
    states, whose rates are not velocities. ``reset`` is a column of new values of
    states for the resets of events, None where there are none. ``slopes`` is ∂residual/∂algebraic
    where its author knows it better than differentiation would, else None. ``tables`` are all
    that the expressions look up; like values of parameters, they are no part of what is
    compiled. ``structure`` holds facts for people (bodies, joints, degrees of freedom), never
    used in computing. ``constrained`` derives the same motion as residuals with multipliers,
    where its author can, ``motion_residuals`` the same accelerations without solving for them.
    ``seam`` says where the model may be compiled apart from its surroundings.
    """

    name: str
    time: Expression
    state: Expression
    algebraic: Expression
    parameter: Expression
    rate: Expression
    residual: Expression
    output: Expression
    event: Expression
    states: tuple[Variable, ...]
    unknowns: tuple[Variable, ...]
    parameters: tuple[ParameterValue, ...]
    channels: tuple[Channel, ...]
    blocks: tuple[Block, ...] = ()
    events: tuple[Event, ...] = ()
    positions: tuple[int, ...] = ()
    velocities: tuple[int, ...] = ()
    attitudes: tuple[Attitude, ...] = ()
    slopes: Expression | None = None
    reset: Expression = None
    tables: tuple[CurveTable, ...] = ()
    structure: dict[str, Any] = field(default_factory=dict)
    constrained: Callable[[], ConstrainedEquations] | None = field(default=None, compare=False)
    motion_residuals: Callable[[], MotionResiduals] | None = field(default=None, compare=False)
    seam: Seam | None = None

    @property
    def speeds(self) -> tuple[int, ...]:
        """Indices of all states that are speeds, angular velocities of attitudes included."""
        return (*self.velocities, *(k for a in self.attitudes for k in a.velocity))


def with_tables(equations: Equations) -> Equations:
    """Return equations that hold the tables which their expressions look up.

    Those of the model come before those of its surroundings alone.
    """
    from vehicledyn.symbolic.table_calls import tables_in

    e, seam = equations, equations.seam
    opened = [] if seam is None else _expressions(seam.opened)
    tables = tables_in([*opened, *_expressions(e)])
    if seam is not None:
        seam = replace(seam, opened=replace(seam.opened, tables=tables))
    return replace(e, tables=tables, seam=seam)


def _expressions(equations: Equations) -> list[Expression]:
    e = equations
    others = [item for item in (e.slopes, e.reset) if item is not None]
    return [e.rate, e.residual, e.output, e.event, *others]
