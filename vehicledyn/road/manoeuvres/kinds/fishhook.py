"""Fishhook: a quick turn of the steering wheel and a counter-turn when the roll rate ends."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres import figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.steering_signal import SteeringSignal
from vehicledyn.road.manoeuvres.time_table import TimeTable
from vehicledyn.road.manoeuvres.tip_up import lift_channels, tip_up
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle


@register("manoeuvre", "fishhook")
class Fishhook(DrivingTest):
    """Turn the steering wheel to an angle and, after a hold, to the other side; then back.

    In the test with roll-rate feedback the hold lasts until the roll rate falls below 1.5 deg/s;
    a run with a long hold gives that time as ``first_roll_settled``, which ``hold`` is then set
    to: up to the counter-steer both runs are the same. The customary angle is 6.5 times that at
    0.3 g. The summary says whether both inner wheels rise by 50.8 mm (2 in) at once.

    References
    ----------
    NHTSA, Consumer Information; New Car Assessment Program; Rollover Resistance, 68 FR 59250.
    """

    angle: float = quantity("rad", "Steering-wheel angle, first to the left")
    rate: float = quantity("rad/s", "Rate of the steering wheel", default=12.566370614359172, gt=0)
    hold: float = quantity("s", "How long the first angle is held", default=0.25, gt=0)
    counter_hold: float = quantity("s", "How long the second is held", default=3.0, gt=0)
    return_time: float = quantity("s", "How long the wheel takes back", default=2.0, gt=0)
    begin: float = quantity("s", "When the wheel begins to turn", default=0.5, ge=0)

    @property
    def turned_at(self) -> float:
        """Time at which the first angle is reached [s]."""
        return self.begin + abs(self.angle) / self.rate

    def steering(self) -> SteeringSignal:
        """Return turn, hold, counter-turn, hold and return."""
        held = self.turned_at + self.hold
        back = held + 2.0 * abs(self.angle) / self.rate
        end = back + self.counter_hold
        times = (self.begin, self.turned_at, held, back, end, end + self.return_time)
        angle = self.angle
        return SteeringSignal(TimeTable(times, (0.0, angle, angle, -angle, -angle, 0.0)))

    def throttle(self) -> TimeTable:
        """Return the throttle, released when the steering begins."""
        return TimeTable((self.begin, self.begin + 0.1), (1.0, 0.0))

    def problems(self, *, free_wheels: bool) -> list[str]:
        """Return what does not go together."""
        own = [] if self.angle else ["angle: a fishhook needs an angle other than zero"]
        return [*own, *super().problems(free_wheels=free_wheels)]

    def channels(self, vehicle: RoadVehicle) -> list[str]:
        """Return also the channels that show wheels lifting."""
        return list(dict.fromkeys([*super().channels(vehicle), *lift_channels(vehicle)]))

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures with the answers over one another."""
        return [figures.answers("Fishhook"), *figures.standard(vehicle)]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield when the first roll ends, and whether the car tips up."""
        yield from entry(
            "first_roll_settled",
            self.roll_settled(signals),
            "s",
            "From the end of the first turn until the roll rate is below 1.5 deg/s",
        )
        yield from tip_up(recording, vehicle)

    def roll_settled(self, signals: Signals) -> float:
        """Return when the roll rate falls below 1.5 deg/s after the first turn; NaN if never.

        It counts from where the car has begun to roll faster than that: a slow one does so after
        the turn. Straight lines join the samples, so that a change of sign between two counts.
        """
        import numpy as np

        rolls = (signals.time >= self.begin) & (np.abs(signals.roll_rate) >= _ROLL_RATE)
        if not rolls.any():
            return 0.0
        start = max(self.turned_at, float(signals.time[int(rolls.argmax())]))
        later = signals.time > start
        time = np.append(start, signals.time[later])
        rate = np.append(signals.at("roll_rate", start), signals.roll_rate[later])
        slow = np.abs(rate) < _ROLL_RATE
        slow[1:] |= rate[1:] * rate[:-1] < 0.0
        if not slow.any():
            return math.nan
        k = int(slow.argmax())
        if k == 0:
            return 0.0
        way = math.copysign(1.0, rate[k - 1])
        share = (way * rate[k - 1] - _ROLL_RATE) / (way * (rate[k - 1] - rate[k]))
        return float(time[k - 1] + share * (time[k] - time[k - 1])) - self.turned_at


_ROLL_RATE = math.radians(1.5)
