"""What ends the validity of a road vehicle: it rolls over, or a wheel goes through the road."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace

from vehicledyn.multibody.model.parts import BasePart, PartEvent, Situation
from vehicledyn.multibody.model.system import System
from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.road.vehicle import RoadVehicle
from vehicledyn.road.wheel.road_wheel import RoadWheel
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec

MOST_LEAN = math.radians(70.0)
"""Angle of a body's vertical axis beyond which it counts as rolled over.

It is that to the road's normal, and to the vertical as well: an edge of the road under the
chassis turns the normal, not the vehicle. The body would touch the road about there, which no
part of a model feels.
"""

MOST_WHEEL_LEAN = math.radians(80.0)
"""Angle of a wheel's plane from both the road's normal and the vertical beyond which what it
carries has fallen over: a vehicle on two wheels, which leans by itself, or a trailer.
"""

_FEWEST_WHEELS, _MOST_WHEELS = 3, 4
"""Vehicles with fewer wheels lean, those with more may be trailers too."""


@dataclass(frozen=True)
class RoadLimits(BasePart):
    """Ends the run of a road vehicle where its model says nothing any more.

    Parameters
    ----------
    body
        The chassis, z axis upwards; None where it is not known, or leans by itself.
    wheels
        All wheels; the road under the chassis is that of the first.
    """

    body: str | None
    wheels: tuple[RoadWheel, ...]

    def events(self, situation: Situation) -> tuple[PartEvent, ...]:
        """Return the ends of validity."""
        upright, words = [], []
        if self.body is not None:
            upright.append(self._upright(situation, self.body))
            words.append(f"the vehicle leans by more than {math.degrees(MOST_LEAN):.0f} deg")
        if self.body is None or len(self.wheels) > _MOST_WHEELS:
            upright += [self._stands(situation, wheel) for wheel in self.wheels]
            words.append(f"a wheel leans by more than {math.degrees(MOST_WHEEL_LEAN):.0f} deg")
        lean = f"{' or '.join(words)} from the road"
        return (
            _ending("overturned", _least(upright), f"{lean}: it has rolled or fallen over"),
            _ending("sunk", self._lowest(situation), self._sunk),
        )

    @property
    def _sunk(self) -> str:
        """What it means that the centre of a wheel is below the ground."""
        if any(wheel.surface.soil is not None for wheel in self.wheels):
            return "a wheel has sunk to its centre: the soil does not carry it; make it firmer"
        return "the centre of a wheel has gone through the road; look for a step too long"

    def _upright(self, situation: Situation, body: str) -> Scalar:
        """Return how far the chassis is from the largest lean, in the cosine of the lean [1]."""
        axis = situation.kinematics.rotation(body)[:, 2]
        cosine = self._along_normal(situation, body, axis, self.wheels[0].surface)
        return ops.maximum(cosine, axis[2]) - math.cos(MOST_LEAN)

    def _stands(self, situation: Situation, wheel: RoadWheel) -> Scalar:
        """Return how far a wheel is from the largest lean, in the sine of the lean [1]."""
        axle = situation.kinematics.rotation(wheel.body)[:, 1]
        sine = self._along_normal(situation, wheel.body, axle, wheel.surface)
        return math.sin(MOST_WHEEL_LEAN) - ops.minimum(ops.absolute(sine), ops.absolute(axle[2]))

    def _along_normal(
        self, situation: Situation, body: str, axis: Vec, surface: RoadSurface
    ) -> Scalar:
        """Return the component of an axis along the normal of the road under a body [1]."""
        place = situation.kinematics.position(body)
        along, across = surface.gradient(place[0], place[1])
        length = ops.sqrt(1.0 + along * along + across * across)
        return (axis[2] - along * axis[0] - across * axis[1]) / length

    def _lowest(self, situation: Situation) -> Scalar:
        """Return the least height of a wheel's centre above its road [m]."""
        heights = []
        for wheel in self.wheels:
            centre = situation.kinematics.position(wheel.body)
            heights.append(centre[2] - wheel.surface.height(centre[0], centre[1]))
        return _least(heights)


def _least(values: list[Scalar]) -> Scalar:
    """Return the least of some values."""
    return functools.reduce(ops.minimum, values)


def _ending(name: str, expression: Scalar, advice: str) -> PartEvent:
    return PartEvent(name, expression, "falling", terminal=True, advice=advice, outcome=name)


def limited(vehicle: RoadVehicle) -> RoadVehicle:
    """Return a vehicle whose run ends where it rolls over or goes through the road."""
    count = sum(isinstance(part, RoadWheel) for part in vehicle.system.parts)
    chassis = vehicle.chassis if count >= _FEWEST_WHEELS else None
    return replace(vehicle, system=_with_limits(vehicle.system, vehicle.chassis, chassis))


def limited_system(system: System) -> System:
    """Return a system whose run ends where what stands on wheels falls over or through the road."""
    return _with_limits(system, None, None)


def _with_limits(system: System, name: str | None, chassis: str | None) -> System:
    """Return it with its limits, named after the body that carries the first wheel."""
    wheels = tuple(part for part in system.parts if isinstance(part, RoadWheel))
    if not wheels:
        return system
    parents = {body.name: body.parent for body in system.bodies}
    carrier = wheels[0].body
    while parents.get(carrier) in parents:
        carrier = parents[carrier]
    return system.with_parts(RoadLimits(name or carrier, chassis, wheels))
