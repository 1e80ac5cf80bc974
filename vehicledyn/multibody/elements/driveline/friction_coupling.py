"""Dry friction between turning parts that sticks: brakes, clutches, limited-slip differentials."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from vehicledyn.base.registry import register
from vehicledyn.multibody.model.declaration import coordinate_name, function, number
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel, Variable
from vehicledyn.symbolic.ops import Scalar

RELEASE_TIME = 2e-3
"""Time in which a sliding coupling loses the twist beyond its limit [s].

A fixed step of 1 ms resolves it; the torque does not depend on it while the coupling slides.
"""


def _one(_: Situation) -> Scalar:
    return 1.0


@dataclass(frozen=True)
class Friction:
    """Dry friction that sticks: its limit [N m], stiffness [N m/rad] and damping [N m s/rad]."""

    limit: Scalar
    stiffness: Scalar
    damping: Scalar

    def torque_and_rate(self, twist: Scalar, rate: Scalar) -> tuple[Scalar, Scalar]:
        """Return the torque against a relative rate [rad/s], and the rate of the twist [rad/s]."""
        most = ops.maximum(self.limit, 0.0)
        torque = _within(self.stiffness * twist + self.damping * rate, most)
        excess = twist - _within(twist, most / self.stiffness)
        return torque, rate - excess / RELEASE_TIME


@register("element_type", "friction_coupling")
@dataclass(frozen=True, kw_only=True)
class FrictionCoupling(BasePart):
    """Dry friction on a coordinate, or between two, that holds without creep at standstill.

    With ω the rate of ``coordinate`` less i times that of ``other``, i the ratio, and z the twist
    of the friction faces, a state, the torque against ω is

        T = max(-L, min(L, k z + c ω)),    z' = ω - (z - max(-L/k, min(L/k, z))) / τ

    L is the torque limit, k and c stiffness and damping while it sticks. Below the limit the
    coupling is a spring that never loses its twist, so it holds a load for any time; sliding, its
    torque is exactly L against the motion. At a constant limit its power T ω is the growth of the
    stored energy and a loss that is never negative.

    T acts against ``coordinate``, and i T along ``other``. A brake acts on the spin of a wheel, a
    clutch on two shafts; a limit that nothing reaches locks a differential. With a ratio that
    switches it is a gearbox with its clutch: give it a limit of zero while gears change, so that
    what is twisted is let loose first.
    """

    coordinate: str = coordinate_name("The coordinate")
    other: str | None = coordinate_name("The other coordinate, if any", default=None)
    ratio: Callable[[Situation], Scalar] = function(
        "1", "Turns i of the coordinate a turn of the other", of="motion", default=_one, written=1.0
    )
    limit: Callable[[Situation], Scalar] = function(
        "N*m", "Torque limit L, not negative", of="motion"
    )
    stiffness: Scalar = number("N*m/rad", "Stiffness k while it sticks", default=1e5, above=0.0)
    damping: Scalar = number("N*m*s/rad", "Damping c while it sticks", default=0.0, least=0.0)

    def states(self) -> tuple[Variable, ...]:
        """Return the twist of the friction faces."""
        return (Variable("twist", "rad", "Twist of the friction faces"),)

    def loads(self, situation: Situation) -> Loads:
        """Return the torque on the coordinates and the rate of the twist."""
        torque, _, twisting = self._state(situation)
        forces = {self.coordinate: -torque}
        if self.other is not None:
            forces[self.other] = self.ratio(situation) * torque
        return Loads(joint_forces=forces, rates={"twist": twisting})

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the torque and its power."""
        torque, rate, _ = self._state(situation)
        name, words = self.name, "Friction torque against the motion"
        return (
            Output(Channel(f"{name}.torque", "N*m", words), torque),
            Output(Channel(f"{name}.power", "W", "Power that friction takes"), torque * rate),
        )

    def _state(self, situation: Situation) -> tuple[Scalar, Scalar, Scalar]:
        """Return torque, relative rate and rate of the twist."""
        rate = situation.kinematics.rate(self.coordinate)
        if self.other is not None:
            rate = rate - self.ratio(situation) * situation.kinematics.rate(self.other)
        friction = Friction(self.limit(situation), self.stiffness, self.damping)
        torque, twisting = friction.torque_and_rate(situation.states["twist"], rate)
        return torque, rate, twisting


def _within(value: Scalar, most: Scalar) -> Scalar:
    return ops.minimum(ops.maximum(value, -most), most)
