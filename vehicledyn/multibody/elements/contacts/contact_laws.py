"""How bodies that touch act on each other: by constraint, compliant, or rigid with impacts.

Friction acts along the sliding velocity v with μ N v / √(v² + v₀²), which creeps below v₀. With a
``stick_stiffness`` it sticks instead: see :mod:`vehicledyn.multibody.elements.contacts.sticking`.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from vehicledyn.multibody.elements.contacts.sticking import Sticking, sticking_states
from vehicledyn.multibody.elements.contacts.touch import (
    Placing,
    Touch,
    pair_of_forces,
    sliding,
)
from vehicledyn.multibody.model.bodies import Body, Joint
from vehicledyn.multibody.model.constraints import BaseConstraint, Constraint, Geometry
from vehicledyn.multibody.model.cuts import Residual
from vehicledyn.multibody.model.declaration import choice, number
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.parts import (
    BasePart,
    Loads,
    Output,
    PartEvent,
    Situation,
    Wrench,
)
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel, Variable
from vehicledyn.symbolic.ops import Scalar, Vec

FORCE, TOUCHES, GAP, IMPACT = "normal_force", "touches", "gap", "impact_speed"
_HOLDS = 200.0
"""Rate at which rounding of the gap of a rigid contact dies out [1/s]."""
_UNIT_MASS = 1.0
"""Turns the acceleration of a gap that should be none into a force [kg]."""


@dataclass(frozen=True, kw_only=True)
class ContactPart(BasePart):
    """Two bodies that touch, with friction; the base of all contacts."""

    friction: Scalar = number("1", "Coefficient of friction μ", default=0.0, least=0.0)
    creep_speed: Scalar = number(
        "m/s", "Sliding speed v₀ below which friction falls off", default=1e-3, above=0.0
    )
    stick_stiffness: Scalar = number(
        "N/m",
        "Stiffness k along the surface while the contact sticks; 0: it does not stick but creeps",
        default=0.0,
        least=0.0,
    )
    stick_damping: Scalar = number(
        "N*s/m", "Damping c along the surface while the contact sticks", default=0.0, least=0.0
    )

    @property
    @abstractmethod
    def bodies(self) -> tuple[str, str]:
        """First and second body."""

    @abstractmethod
    def touch(self, placing: Placing) -> Touch:
        """Return where the bodies touch or come closest."""

    @property
    def has_friction(self) -> bool:
        """Whether there may be friction."""
        return not ops.is_structurally_zero(self.friction)

    @property
    def sticks(self) -> bool:
        """Whether friction holds without creep."""
        return self.has_friction and not ops.is_structurally_zero(self.stick_stiffness)

    def states(self) -> tuple[Variable, ...]:
        """Return the deflection of a contact that sticks."""
        return sticking_states(self.name) if self.sticks else ()

    def friction_force(self, situation: Situation, touch: Touch, normal_force: Scalar) -> Vec:
        """Return the force of friction on the second body, world axes [N]."""
        if self.sticks:
            return self._sticking(situation, touch, normal_force).force
        velocity = sliding(situation.kinematics, self.bodies, touch)
        speed = ops.sqrt(ops.dot(velocity, velocity) + self.creep_speed * self.creep_speed)
        return -(self.friction * normal_force / speed) * velocity

    def friction_wrenches(
        self, situation: Situation, touch: Touch, normal_force: Scalar
    ) -> tuple[Wrench, ...]:
        """Return what friction does to both bodies."""
        if not self.has_friction:
            return ()
        force = self.friction_force(situation, touch, normal_force)
        return pair_of_forces(situation.kinematics, self.bodies, touch, force)

    def friction_rates(
        self, situation: Situation, touch: Touch, normal_force: Scalar
    ) -> dict[str, Scalar]:
        """Return the rates of the deflection of a contact that sticks."""
        return self._sticking(situation, touch, normal_force).rates if self.sticks else {}

    def friction_outputs(
        self, situation: Situation, touch: Touch, normal_force: Scalar
    ) -> tuple[Output, ...]:
        """Return the force of a contact that sticks."""
        if not self.sticks:
            return ()
        force = self._sticking(situation, touch, normal_force).force
        size = ops.sqrt(ops.dot(force, force))
        return (self.channel("friction_force", "N", "Size of the friction", size),)

    def _sticking(self, situation: Situation, touch: Touch, normal_force: Scalar) -> Sticking:
        limit = self.friction * normal_force
        return Sticking(
            situation, self.bodies, touch, limit, self.stick_stiffness, self.stick_damping
        )

    def channel(self, name: str, unit: str, words: str, value: Scalar) -> Output:
        """Return a channel of the contact."""
        return Output(Channel(f"{self.name}.{name}", unit, f"{words} of {self.name}"), value)


@dataclass(frozen=True, kw_only=True)
class PermanentContact(ContactPart):
    """A contact that is a constraint: its multiplier is the normal force, which may pull.

    Where the force falls below zero the event ``pulls`` is recorded.
    """

    def added_constraints(self) -> tuple[Constraint, ...]:
        """Return the constraint that closes the gap; its multiplier is the normal force."""
        return (_Closed(self._constraint, self),)

    def reactions(self) -> tuple[Variable, ...]:
        """Return the normal force, which friction and the event depend on."""
        return (Variable(FORCE, "N", f"Normal force of {self.name}"),)

    def found_reactions(self, situation: Situation) -> tuple[Scalar, ...]:
        """Return the multiplier."""
        if situation.forces is None:
            raise ValueError("the forces of the constraints are not known at this stage")
        return (situation.forces.multiplier(self._constraint, FORCE),)

    def loads(self, situation: Situation) -> Loads:
        """Return the friction."""
        touch = self.touch(situation.kinematics)
        force = ops.maximum(situation.reactions[FORCE], 0.0)
        return Loads(
            wrenches=self.friction_wrenches(situation, touch, force),
            rates=self.friction_rates(situation, touch, force),
        )

    def events(self, situation: Situation) -> tuple[PartEvent, ...]:
        """Return where the contact begins to pull, and where it pushes again."""
        advice = (
            "the contact pulls, which no unilateral contact can: the bodies would part; take a "
            "contact that lifts off, a stronger spring or less speed"
        )
        force = situation.reactions[FORCE]
        return (PartEvent("pulls", force, "falling", advice=advice),)

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the normal force, and the friction of a contact that sticks."""
        force = situation.reactions[FORCE]
        touch = self.touch(situation.kinematics)
        return (
            self.channel(FORCE, "N", "Normal force", force),
            *self.friction_outputs(situation, touch, ops.maximum(force, 0.0)),
        )

    @property
    def _constraint(self) -> str:
        return f"{self.name}.constraint"


@dataclass(frozen=True)
class _Closed(BaseConstraint):
    """The gap of a contact is zero."""

    part: ContactPart

    def residuals(self, geometry: Geometry) -> list[Residual]:
        """Return the gap [m]."""
        gap = self.part.touch(geometry).gap
        return [Residual(gap, "m", FORCE, "N", f"Normal force of {self.name}, positive pushes")]


@dataclass(frozen=True, kw_only=True)
class CompliantContact(ContactPart):
    """A contact with the force of Hunt and Crossley, N = k δⁿ (1 + 3/2 α δ̇), never negative.

    δ is the overlap. The coefficient of restitution falls from 1 with the slope α at low speed.
    """

    stiffness: Scalar = number("", "Stiffness k, in N/mⁿ", above=0.0)
    exponent: Scalar = number(
        "1", "Exponent n: 1.5 for round bodies, 1 for a spring", default=1.5, least=1.0
    )
    dissipation: Scalar = number("s/m", "Dissipation α", default=0.0, least=0.0)

    def loads(self, situation: Situation) -> Loads:
        """Return normal force and friction on both bodies."""
        touch = self.touch(situation.kinematics)
        force = self._force(situation, touch)
        total = force * touch.normal
        if self.has_friction:
            total = total + self.friction_force(situation, touch, force)
        return Loads(
            wrenches=pair_of_forces(situation.kinematics, self.bodies, touch, total),
            rates=self.friction_rates(situation, touch, force),
        )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return gap and normal force, and the friction of a contact that sticks."""
        touch = self.touch(situation.kinematics)
        force = self._force(situation, touch)
        return (
            self.channel(GAP, "m", "Gap", touch.gap),
            self.channel(FORCE, "N", "Normal force", force),
            *self.friction_outputs(situation, touch, force),
        )

    def _force(self, situation: Situation, touch: Touch) -> Scalar:
        rate = -situation.kinematics.time_derivative(touch.gap)
        overlap = ops.maximum(-touch.gap, 0.0)
        damping = ops.maximum(1.0 + 1.5 * self.dissipation * rate, 0.0)
        return self.stiffness * overlap**self.exponent * damping


@dataclass(frozen=True, kw_only=True)
class RigidContact(ContactPart):
    """A rigid contact: it holds while it pushes, lets go at no force, and ends flights by impacts.

    An impact turns the approach velocity v into -e v (Newton); where that is slower than
    ``rest_speed`` it ends in contact, so that chatter has finitely many impacts. Friction has no
    impulse.
    The gap is a coordinate of its own, ``<name>.gap``; in contact the normal force is the one
    that keeps its acceleration at zero. At its start a touching contact has no gap.
    """

    restitution: Scalar = number(
        "1", "Coefficient of restitution e at impacts", default=0.0, least=0.0, most=1.0
    )
    rest_speed: Scalar = number(
        "m/s", "Rebound speed below which an impact ends in contact", default=1e-3, above=0.0
    )
    touching: bool = choice("Whether the bodies touch at the start", default=True)
    changes_motion: ClassVar[bool] = True

    def added_bodies(self) -> tuple[Body, ...]:
        """Return the massless body of the gap."""
        joint = Joint("T1", self._gap, role="dependent", description=f"Gap of {self.name}")
        return (Body(f"{self._gap}_coordinate", GROUND, joints=(joint,), is_abstract=True),)

    def added_constraints(self) -> tuple[Constraint, ...]:
        """Return what makes the coordinate the gap."""
        return (_Measured(f"{self.name}.constraint", self, self._gap),)

    def states(self) -> tuple[Variable, ...]:
        """Return whether the bodies touch, the speed of the last impact, and what friction has."""
        start = 1.0 if self.touching else 0.0
        words = f"Approach speed at the last impact of {self.name}"
        return (
            Variable(TOUCHES, "1", f"Whether {self.name} touches", start),
            Variable(IMPACT, "m/s", words, 0.0),
            *super().states(),
        )

    def reactions(self) -> tuple[Variable, ...]:
        """Return the normal force."""
        return (Variable(FORCE, "N", f"Normal force of {self.name}"),)

    def found_reactions(self, situation: Situation) -> tuple[Scalar, ...]:
        """Return the normal force that keeps the gap closed, none in flight."""
        gap, rate, acceleration = situation.kinematics.joint_motion(self._gap)
        opening = acceleration + 2.0 * _HOLDS * rate + _HOLDS * _HOLDS * gap
        closed = situation.reactions[FORCE] - _UNIT_MASS * opening
        return (ops.where(self._is_closed(situation), closed, 0.0),)

    def loads(self, situation: Situation) -> Loads:
        """Return the normal force on the gap, and friction."""
        touch, force = self.touch(situation.kinematics), situation.reactions[FORCE]
        pushes = ops.maximum(force, 0.0)
        return Loads(
            wrenches=self.friction_wrenches(situation, touch, pushes),
            joint_forces={self._gap: force},
            rates={
                TOUCHES: ops.scalar(0.0),
                IMPACT: ops.scalar(0.0),
                **self.friction_rates(situation, touch, pushes),
            },
        )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the normal force, and the friction of a contact that sticks."""
        force = situation.reactions[FORCE]
        touch = self.touch(situation.kinematics)
        return (
            self.channel(FORCE, "N", "Normal force", force),
            *self.friction_outputs(situation, touch, ops.maximum(force, 0.0)),
        )

    def events(self, situation: Situation) -> tuple[PartEvent, ...]:
        """Return lift-off and impact."""
        gap, rate, acceleration = situation.kinematics.joint_motion(self._gap)
        closed, state = self._is_closed(situation), f"{self.name}.{TOUCHES}"
        is_slow = ops.logic_and(-self.restitution * rate < self.rest_speed, acceleration < 0.0)
        stays = ops.where(is_slow, 1.0, 0.0)
        return (
            PartEvent(
                "lifts_off",
                ops.where(closed, situation.reactions[FORCE], 1.0),
                "falling",
                resets={state: ops.scalar(0.0)},
            ),
            PartEvent(
                "hits",
                ops.where(closed, 1.0, gap),
                "falling",
                resets={state: stays, f"{self.name}.{IMPACT}": -rate},
                impulses={self._gap: -(1.0 - stays) * self.restitution * rate},
            ),
        )

    @property
    def _gap(self) -> str:
        return f"{self.name}.{GAP}"

    def _is_closed(self, situation: Situation) -> Scalar:
        return situation.states[TOUCHES] > 0.5


@dataclass(frozen=True)
class _Measured(BaseConstraint):
    """A coordinate is the gap of a contact, so that a force along it is the normal force."""

    part: ContactPart
    coordinate: str

    def residuals(self, geometry: Geometry) -> list[Residual]:
        """Return the gap less its coordinate [m]."""
        gap = self.part.touch(geometry).gap - geometry.coordinate(self.coordinate)
        return [Residual(gap, "m", FORCE, "N", f"Normal force along {self.coordinate}")]

    def guesses(self, geometry: Geometry) -> dict[str, Scalar]:
        """Return the gap at the start, so that no other coordinate moves for it."""
        return {self.coordinate: self.part.touch(geometry).gap}
