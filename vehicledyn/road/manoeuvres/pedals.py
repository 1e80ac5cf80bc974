"""Pedals of a driving test: a held speed until the throttle is released, brakes by time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from vehicledyn.multibody.elements.driveline.friction_coupling import Friction
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation, Wrench
from vehicledyn.road.vehicle import Corner
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.equations import Channel, Variable
from vehicledyn.symbolic.ops import Scalar

_LOCKED = 2.0
"""Wheel speed below which a torque that does not stick falls to zero [rad/s]."""

STIFFNESS, DAMPING = 1e5, 100.0
"""Of a brake that holds its wheel [N m/rad] and [N m s/rad]."""

Law = Callable[[Scalar], Scalar]
Seen = Callable[[Situation], Scalar]


def _twist(corner: Corner) -> str:
    return f"brake_twist_{corner.name}"


def forward_speed(situation: Situation, body: str) -> Scalar:
    """Return the speed of a body along its heading [m/s]."""
    velocity = situation.kinematics.velocity(body)
    heading = situation.kinematics.rotation(body)[:, 0]
    level = ops.smooth_norm(heading[0], heading[1], 0.0)
    return (velocity[0] * heading[0] + velocity[1] * heading[1]) / level


@dataclass(frozen=True)
class Pedals(BasePart):
    """Drive torque that holds a speed, and brake torques, both from the chassis to the wheels.

    T = g (K_p (v_0 - v) + K_i ∫ g (v_0 - v) dt + T_0), with the throttle's share g, the target v_0
    of the motion and a torque T_0 of time; it acts on the coordinate ``shaft`` where there is one,
    else equally on all wheels; it acts nowhere with ``by_throttle``, where a foot turns it into a
    pedal.
    Each wheel is braked by dry friction with its part of the brake torque as limit, which sticks:
    a car that has stopped on a slope does not creep
    (:mod:`vehicledyn.multibody.elements.driveline.friction_coupling`). Where ``sticks`` is False it
    is M tanh(ω / 2 rad/s), without a state, for tests that do not brake to rest.
    """

    chassis: str
    corners: tuple[Corner, ...]
    target: Seen
    throttle: Law
    torque: Law
    brake: Seen | None
    front_share: Scalar
    proportional_gain: Scalar
    integral_gain: Scalar
    shaft: str = ""
    by_throttle: bool = False
    sticks: bool = True

    def states(self) -> tuple[Variable, ...]:
        """Return the integral of the speed error, and the twists of the brakes."""
        integral = Variable("speed_error_integral", "m", "Integral of the speed error")
        braked = self.corners if self.brake is not None and self.sticks else ()
        words = "Twist of the brake's friction faces"
        return (integral, *(Variable(_twist(c), "rad", f"{words}, {c.name}") for c in braked))

    def loads(self, situation: Situation) -> Loads:
        """Return the torques and the rate of the integral."""
        gate = self.throttle(situation.time)
        rates = {"speed_error_integral": gate * self._error(situation)}
        forces: dict[str, Scalar] = {}
        for corner in self.corners if self.brake is not None else ():
            rate, friction = situation.kinematics.rate(corner.spin), self._limit(situation, corner)
            if not self.sticks:
                forces[corner.spin] = -friction.limit * ops.tanh(rate / _LOCKED)
                continue
            twist = situation.states[_twist(corner)]
            torque, twisting = friction.torque_and_rate(twist, rate)
            forces[corner.spin] = -torque
            rates[_twist(corner)] = twisting
        if self.by_throttle:
            return Loads(joint_forces=forces, rates=rates)
        if self.shaft:
            forces[self.shaft] = self._drive(situation)
            return Loads(joint_forces=forces, rates=rates)
        torque = situation.hand("torque", self._drive(situation))
        wrenches = tuple(w for c in self.corners for w in self._shafts(situation, c, torque))
        return Loads(wrenches=wrenches, joint_forces=forces, rates=rates)

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return drive and brake torque."""
        of = f"on {self.shaft}" if self.shaft else "of all wheels together"
        drive = Channel(f"{self.name}.torque", "N*m", f"Drive torque {of}")
        brake = Channel(f"{self.name}.brake_torque", "N*m", "Brake torque of all wheels together")
        return (
            Output(drive, self._drive(situation)),
            Output(brake, ops.scalar(self._braked(situation))),
        )

    def wanted(self, situation: Situation) -> Scalar:
        """Return the drive torque that is wanted, as another part sees it [N m]."""
        return self._drive(replace(situation, states=situation.all_states[self.name]))

    def _braked(self, situation: Situation) -> Scalar:
        """Return the brake torque of all wheels together [N m]."""
        return 0.0 if self.brake is None else self.brake(situation)

    def _limit(self, situation: Situation, corner: Corner) -> Friction:
        """Return the friction of a brake whose caliper is on the wheel's carrier."""
        share = self.front_share if corner.is_front else 1.0 - self.front_share
        alike = sum(other.is_front == corner.is_front for other in self.corners)
        return Friction(self._braked(situation) * share / alike, STIFFNESS, DAMPING)

    def _shafts(
        self, situation: Situation, corner: Corner, torque: Scalar
    ) -> tuple[Wrench, Wrench]:
        """Return what a drive shaft with joints does to a wheel and to the chassis."""
        kinematics = situation.kinematics
        axis, nothing = rotations.axis_vector(2), ops.vector(0.0, 0.0, 0.0)
        share = torque / len(self.corners)
        to_chassis = kinematics.rotation(self.chassis).T
        reaction = -share * (to_chassis @ (kinematics.rotation(corner.body) @ axis))
        return (
            Wrench(corner.body, nothing, share * axis),
            Wrench(self.chassis, nothing, reaction),
        )

    def _error(self, situation: Situation) -> Scalar:
        return self.target(situation) - forward_speed(situation, self.chassis)

    def _drive(self, situation: Situation) -> Scalar:
        integral = situation.states["speed_error_integral"]
        held = self.proportional_gain * self._error(situation) + self.integral_gain * integral
        return self.throttle(situation.time) * (held + self.torque(situation.time))
