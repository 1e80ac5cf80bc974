"""J-turn: one quick, large turn of the steering wheel, held, to look for two-wheel lift."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres import figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.steering_signal import SteeringSignal, ramp_and_hold
from vehicledyn.road.manoeuvres.time_table import TimeTable
from vehicledyn.road.manoeuvres.tip_up import lift_channels, tip_up

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle


@register("manoeuvre", "j_turn")
class JTurn(DrivingTest):
    """Turn the steering wheel quickly to a large angle with the throttle released, and hold it.

    The customary angle is eight times that at 0.3 g, turned at 1000 deg/s. The summary says
    whether both inner wheels rise by 50.8 mm (2 in) at once, and when.

    References
    ----------
    NHTSA light-vehicle rollover research, J-turn without pulse braking; the customary numbers.
    """

    angle: float = quantity("rad", "Steering-wheel angle to the left")
    rate: float = quantity("rad/s", "Rate of the steering wheel", default=17.453292519943297, gt=0)
    begin: float = quantity("s", "When the wheel begins to turn", default=0.5, ge=0)

    def steering(self) -> SteeringSignal:
        """Return the ramp and its hold."""
        return ramp_and_hold(self.angle, self.rate, self.begin)

    def throttle(self) -> TimeTable:
        """Return the throttle, released when the steering begins."""
        return TimeTable((self.begin, self.begin + 0.1), (1.0, 0.0))

    def channels(self, vehicle: RoadVehicle) -> list[str]:
        """Return also the channels that show wheels lifting."""
        return list(dict.fromkeys([*super().channels(vehicle), *lift_channels(vehicle)]))

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures with the answers over one another."""
        return [figures.answers("J-turn"), *figures.standard(vehicle)]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield whether the car tips up."""
        yield from tip_up(recording, vehicle)
