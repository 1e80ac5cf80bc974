"""What a part of a system may contribute: bodies, constraints, states, loads, outputs, events.

A part (link, wheel, driver, sensor ...) is a small frozen class with a ``name`` and any of
the methods of :class:`Part`; the system calls them in this order while it derives the
equations. Nothing configures a part from outside.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.model.ground import body_axes
from vehicledyn.symbolic import frames

if TYPE_CHECKING:
    from vehicledyn.base.shapes import Shape
    from vehicledyn.multibody.model.bodies import Body
    from vehicledyn.multibody.model.constraints import Constraint
    from vehicledyn.multibody.model.cuts import Cut
    from vehicledyn.multibody.model.joint_wrench import JointWrench
    from vehicledyn.multibody.model.kinematics import Kinematics
    from vehicledyn.symbolic.equations import Channel, Direction, Variable
    from vehicledyn.symbolic.ops import Scalar, Vec


@dataclass(frozen=True)
class Wrench:
    """A force and a torque on a body, both in the axes of that body.

    ``force`` [N] acts at the origin of the body frame; ``torque`` [N m] is about it.
    """

    body: str
    force: Vec
    torque: Vec

    def __post_init__(self) -> None:
        """Refuse vectors in other axes than the body's.

        Raises
        ------
        FrameError
            If a vector is labelled with other axes.
        """
        for name, vector in (("force", self.force), ("torque", self.torque)):
            frames.require_axes(vector, body_axes(self.body), f"the {name} on body '{self.body}'")


class TransmittedForces(Protocol):
    """What joints transmit and constraints exert, once the motion is solved."""

    def reaction(self, body: str) -> JointWrench:
        """Return what the parent exerts on a body through its chain of joints."""

    def exerted(self, constraint: str, body: str) -> JointWrench:
        """Return what a cut or constraint exerts on a body."""

    def settled(self, column: Vec) -> tuple[list[Scalar], list[bool]]:
        """Return the entries of a column without symbols of multipliers, and which are unique."""

    def multiplier(self, constraint: str, channel: str) -> Scalar:
        """Return the multiplier of one row of a cut or constraint [N or N m]."""

    @property
    def redundant(self) -> list[str]:
        """Names of the forces of constraints that are not unique."""

    @property
    def gravity(self) -> Vec:
        """Acceleration of free fall, world axes [m/s²]."""


@dataclass(frozen=True)
class DrivenMotion:
    """Position and velocity of a driven coordinate; its acceleration comes with the loads."""

    position: Scalar
    velocity: Scalar


@dataclass(frozen=True)
class Clock:
    """What is known before any kinematics: time and the part's own further states."""

    time: Scalar
    states: dict[str, Scalar]


class ForcesUnknownError(InputError):
    """A channel needs forces of joints or constraints where only positions are known."""


@dataclass(frozen=True)
class Situation:
    """What a part sees: time, its own states and unknowns by short name, and the kinematics.

    ``all_states`` are those of all parts, by the part's name and short name. ``forces`` of joints
    and constraints are known to outputs only; ``reactions`` are those that the part asked for,
    by short name [N]. ``handing`` notes what surroundings hand to the system, if they are to be
    compiled apart from it.
    """

    time: Scalar
    states: dict[str, Scalar]
    unknowns: dict[str, Scalar]
    kinematics: Kinematics
    all_states: dict[str, dict[str, Scalar]] = field(default_factory=dict)
    forces: TransmittedForces | None = None
    reactions: dict[str, Scalar] = field(default_factory=dict)
    handing: Callable[[str, Scalar], Scalar] | None = None

    def hand(self, name: str, value: Scalar) -> Scalar:
        """Return what stands for a number that wrenches are to be made from.

        Parameters
        ----------
        name
            What it is, unique within the part.
        value
            Its value; where it stands for all that a driver or a manoeuvre makes of the motion,
            the system is compiled apart from it.
        """
        return value if self.handing is None else self.handing(name, value)


@dataclass(frozen=True)
class Loads:
    """What a part does to the system at a given position, velocity and time.

    ``wrenches`` act on bodies, ``joint_forces`` on coordinates by name [N or N m],
    ``rates`` are the derivatives of the part's states by short name, ``residuals`` the
    equations of its algebraic unknowns (functions of positions and time only, in the order
    of the unknowns), ``accelerations`` those of the coordinates it drives.
    """

    wrenches: tuple[Wrench, ...] = ()
    joint_forces: dict[str, Scalar] = field(default_factory=dict)
    rates: dict[str, Scalar] = field(default_factory=dict)
    residuals: tuple[Scalar, ...] = ()
    accelerations: dict[str, Scalar] = field(default_factory=dict)


@dataclass(frozen=True)
class Output:
    """A channel and its expression."""

    channel: Channel
    expression: Scalar


@dataclass(frozen=True)
class PartEvent:
    """A function whose sign change along the motion is an event, by a name within its part.

    A terminal event ends the run. ``resets`` are the new values of states by the states' full
    names: an independent coordinate, its rate (``{coordinate}_rate``) or a part's state
    (``{part}.{state}``). They take effect all at once, after which the loops close anew; they
    carry no impulse over to other rates, the expressions must say all that changes. A state
    of rate zero that only events change is a switch.

    ``impulses`` are new rates of coordinates that impulses on these coordinates bring about, and
    ``restitution`` e lets the function g of the event go back with ġ⁺ = -e ġ⁻, by an impulse
    along ∂g/∂q. With these all rates jump, see :mod:`vehicledyn.multibody.equations.impacts`. An
    event without a name of its own has that of its part.

    ``guesses`` are places from which dependent coordinates, by name, are solved anew: where loops
    have several solutions, such as the points at which two profiles touch, they go over to
    another one. With ``lands`` the constraints that hold there are met by an inelastic impact.
    ``advice`` says what a terminal event means and what to do, ``outcome`` how the
    run then ended, "ok", "derailed", "lifted", "overturned" or "sunk".
    """

    name: str
    expression: Scalar
    direction: Direction = "either"
    terminal: bool = False
    resets: dict[str, Scalar] = field(default_factory=dict)
    impulses: dict[str, Scalar] = field(default_factory=dict)
    restitution: Scalar | None = None
    guesses: dict[str, Scalar] = field(default_factory=dict)
    lands: bool = False
    advice: str = ""
    outcome: str = "ok"


def loads_of(part: Part, situation: Situation) -> Loads:
    """Return the loads of a part; errors about axes name it."""
    with frames.naming("part", part.name):
        return part.loads(situation)


def outputs_of(part: Part, situation: Situation) -> tuple[Output, ...]:
    """Return the channels of a part; errors about axes name it."""
    with frames.naming("part", part.name):
        return part.outputs(situation)


class Part(Protocol):
    """A part of a system. Derive from :class:`BasePart` and define what differs from nothing."""

    @property
    def name(self) -> str:
        """Dotted name, unique in the system; prefix of the part's states and channels."""

    def added_bodies(self) -> tuple[Body, ...]:
        """Return bodies that the part brings, with joints and inertia; dotted names.

        Their coordinates are states like all others and couple with these in the mass matrix.
        """

    def added_cuts(self) -> tuple[Cut, ...]:
        """Return cuts of loops that the part brings."""

    def added_constraints(self) -> tuple[Constraint, ...]:
        """Return further constraints that the part brings."""

    def states(self) -> tuple[Variable, ...]:
        """Return the part's further states, named without the part's prefix."""

    def unknowns(self) -> tuple[Variable, ...]:
        """Return the part's algebraic unknowns, named without the part's prefix."""

    def reactions(self) -> tuple[Variable, ...]:
        """Return forces of joints and constraints that the part's loads depend on [N].

        Named without the part's prefix. They are unknowns that are solved together with the
        accelerations, as friction needs whose limit is the force of a constraint.
        """

    def found_reactions(self, situation: Situation) -> tuple[Scalar, ...]:
        """Return these forces as the solved motion gives them, in the order of ``reactions``."""

    def motions(self, clock: Clock) -> dict[str, DrivenMotion]:
        """Return position and velocity of the coordinates that the part drives."""

    def loads(self, situation: Situation) -> Loads:
        """Return what the part does to the system."""

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the part's channels; here the kinematics know the accelerations too."""

    def events(self, situation: Situation) -> tuple[PartEvent, ...]:
        """Return the part's events; the kinematics know the accelerations."""

    def shapes(self) -> tuple[Shape, ...]:
        """Return what the part looks like."""


@dataclass(frozen=True)
class BasePart:
    """A part that contributes nothing; the base of all parts."""

    name: str

    def added_bodies(self) -> tuple[Body, ...]:
        """Bring no bodies."""
        return ()

    def added_cuts(self) -> tuple[Cut, ...]:
        """Bring no cuts."""
        return ()

    def added_constraints(self) -> tuple[Constraint, ...]:
        """Bring no constraints."""
        return ()

    def states(self) -> tuple[Variable, ...]:
        """Return no further states."""
        return ()

    def unknowns(self) -> tuple[Variable, ...]:
        """Return no algebraic unknowns."""
        return ()

    def reactions(self) -> tuple[Variable, ...]:
        """Depend on no forces of constraints."""
        return ()

    def found_reactions(self, situation: Situation) -> tuple[Scalar, ...]:
        """Find none."""
        return ()

    def motions(self, clock: Clock) -> dict[str, DrivenMotion]:
        """Drive nothing."""
        return {}

    def loads(self, situation: Situation) -> Loads:
        """Load nothing."""
        return Loads()

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Show nothing."""
        return ()

    def events(self, situation: Situation) -> tuple[PartEvent, ...]:
        """Watch nothing."""
        return ()

    def not_held(self) -> dict[str, str]:
        """Return coordinates that the part turns or moves but cannot hold, and why, with advice.

        Read where a search for an equilibrium fails, to name the law that makes it fail.
        """
        return {}

    def shapes(self) -> tuple[Shape, ...]:
        """Look like nothing."""
        return ()
