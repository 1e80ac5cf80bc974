"""Coast-down: the throttle is released on a straight road, and resistance slows the car down."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres import figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.time_table import TimeTable
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import Corner, RoadVehicle

FEWEST_SAMPLES = 3

_NEGLIGIBLE = 0.03
"""Least deceleration at the first speed that counts as the air's [m/s²].

What wheels with toe lose by lateral forces is a third of it at most in the cars of the library, the
drag of a car at 100 km/h seven times as much.
"""


@register("manoeuvre", "coast_down")
class CoastDown(DrivingTest):
    """Release the throttle on a straight road, the steering wheel held straight, and roll.

    The summary has the deceleration d = d_0 + d_2 v² that fits the speed best, d_0 from rolling
    and d_2 from the air, and how far and how long the car rolled. There is air where the vehicle
    has ``air_drag``, or where other forces than those of the tyres take up momentum as v² does:
    m (v_0 - v) plus the integral of the tyres' forces along.

    References
    ----------
    ISO 10521-1, Road vehicles - Road load - Determination under reference atmospheric conditions;
    the polynomial without its linear term.
    """

    release_at: float = quantity("s", "When the throttle is released", default=0.5, ge=0)

    def throttle(self) -> TimeTable:
        """Return the throttle, which is released."""
        return TimeTable((self.release_at, self.release_at + 0.1), (1.0, 0.0))

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures after speed, acceleration, slip and pitch."""
        return [figures.along("Coast-down", vehicle), *figures.standard(vehicle)]

    def channels(self, vehicle: RoadVehicle) -> list[str]:
        """Return the channels of every test, and forces and loads of the tyres."""
        forces = [name for corner in vehicle.corners for name in _forces(corner)]
        return list(dict.fromkeys([*super().channels(vehicle), *forces]))

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield the coefficients of the deceleration, way and time."""
        import numpy as np

        rolled = signals.between(self.release_at + 0.1, float(signals.time[-1]))
        if len(rolled.time) < FEWEST_SAMPLES:
            return
        time, speed = rolled.time - rolled.time[0], rolled.forward_speed

        def grown(rate: Any) -> Any:
            return np.concatenate([[0.0], np.cumsum(np.diff(time) * 0.5 * (rate[1:] + rate[:-1]))])

        def fitted(lost: Any) -> Any:
            scale = np.abs(columns).max(axis=0)
            return np.linalg.lstsq(columns / scale, lost, rcond=None)[0] / scale

        def effect() -> float:
            """Return the first deceleration by forces as v² beside those of the tyres [m/s²]."""
            kept = np.isin(signals.time, rolled.time)
            forces, loads = (
                np.sum([recording.channels[name][:] for name in names], axis=0)[kept]
                for names in zip(*map(_forces, vehicle.corners), strict=True)
            )
            gravity = math.hypot(*(vehicle.worth(g) for g in vehicle.system.gravity))
            mass = float(np.mean(loads)) / gravity
            lost = speed[0] - speed + grown(forces) / mass
            return float(fitted(lost)[1] * speed[0] ** 2)

        # Integrated over time, since the slope of samples is rough.
        columns = np.column_stack([time, grown(speed * speed)])
        found = fitted(speed[0] - speed)
        words = "Deceleration d_0 + d_2 v²: its constant part, from rolling"
        yield from entry("rolling_deceleration", float(found[0]), "m/s^2", words)
        words = "Deceleration d_0 + d_2 v²: its coefficient d_2, from the air"
        if _has_drag(vehicle) or effect() > _NEGLIGIBLE:
            yield from entry("air_deceleration", float(found[1]), "1/m", words)
        yield from entry("rolled_distance", float(grown(speed)[-1]), "m", "Way without drive")
        yield from entry("rolled_time", float(time[-1]), "s", "Time without drive")


def _forces(corner: Corner) -> tuple[str, str]:
    return f"{corner.name}.tyre.longitudinal_force", f"{corner.name}.tyre.normal_force"


def _has_drag(vehicle: RoadVehicle) -> bool:
    from vehicledyn.multibody.elements.air_drag import AirDrag

    return any(isinstance(part, AirDrag) for part in vehicle.system.parts)
