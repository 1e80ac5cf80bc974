"""Engines and motors by maps of torque over speed, at full and at no throttle."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.multibody.elements.straight_lines import straight_lines
from vehicledyn.multibody.model.declaration import choice, coordinate_name, function
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar


@register("element_type", "engine")
@dataclass(frozen=True, kw_only=True)
class Engine(BasePart):
    """A torque on a shaft by maps over its speed, for combustion engines and electric motors.

        T = u T_full(ω) + (1 - u) T_drag(ω)

    u is the throttle, kept within 0 and 1. The maps are straight lines between points and constant
    beyond their ends; a drag torque is negative where it brakes. The engine's block takes the
    reaction where the coordinate is that of a shaft on it.
    """

    coordinate: str = coordinate_name("Coordinate of the shaft, growing as the engine turns")
    throttle: Callable[[Situation], Scalar] = function("1", "Throttle u from 0 to 1", of="motion")
    speeds: tuple[float, ...] = choice("Speeds of the maps, growing", unit="rad/s")
    full_torques: tuple[float, ...] = choice("Torque at full throttle at each of them", unit="N*m")
    drag_torques: tuple[float, ...] = choice(
        "Torque at no throttle at each of them; none without", default=(), unit="N*m"
    )

    def __post_init__(self) -> None:
        """Refuse maps that are no functions of the speed.

        Raises
        ------
        InputError
            If speeds do not grow, lists differ in length, or a number is not finite.
        """
        lists = {"full_torques": self.full_torques, "drag_torques": self.drag_torques}
        for name, torques in lists.items():
            if len(torques) != len(self.speeds) and (torques or name == "full_torques"):
                counts = f"{len(self.speeds)} speeds and {len(torques)} values of '{name}'"
                raise InputError(f"{counts}; give as many")
        if len(self.speeds) < len(("from", "to")):
            raise InputError("the map has less than two speeds; give two at least")
        if not all(map(math.isfinite, (*self.speeds, *self.full_torques, *self.drag_torques))):
            raise InputError("the map holds a number that is not finite")
        for before, after in zip(self.speeds, self.speeds[1:], strict=False):
            if after <= before:
                words = f"{after:g} rad/s follows {before:g} rad/s"
                raise InputError(f"the speeds of the map do not grow: {words}; sort its points")

    def loads(self, situation: Situation) -> Loads:
        """Return the torque on the shaft."""
        return Loads(joint_forces={self.coordinate: self._torque(situation)})

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return torque and power."""
        torque, name = self._torque(situation), self.name
        power = torque * situation.kinematics.rate(self.coordinate)
        return (
            Output(Channel(f"{name}.torque", "N*m", f"Torque on {self.coordinate}"), torque),
            Output(Channel(f"{name}.power", "W", "Power of the engine"), power),
        )

    def _torque(self, situation: Situation) -> Scalar:
        throttle = ops.minimum(ops.maximum(self.throttle(situation), 0.0), 1.0)
        speed = situation.kinematics.rate(self.coordinate)
        drag = straight_lines(self.speeds, self.drag_torques, speed) if self.drag_torques else 0.0
        return drag + throttle * (straight_lines(self.speeds, self.full_torques, speed) - drag)
