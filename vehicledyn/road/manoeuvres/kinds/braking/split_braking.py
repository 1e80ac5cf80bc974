"""Split braking: straight braking where one side of the road is slippery (ISO 14512)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field

from vehicledyn.base.parameters import part, quantity
from vehicledyn.base.registry import register
from vehicledyn.road.drivers.driver import Driver
from vehicledyn.road.manoeuvres import figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.driving_test import PREFIX, DrivingTest
from vehicledyn.road.manoeuvres.step_path import StepPath
from vehicledyn.road.manoeuvres.time_table import TimeTable
from vehicledyn.road.patches.rectangle import Rectangle
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.patches.patch import FrictionPatch
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle

_STRAIGHT = StepPath((0.0, 1e3, 2e3, 3e3), (0.0, 0.0, 0.0, 0.0))
_JUDGED = (1.0, 2.0)
"""Times after the begin of braking at which the reactions are judged [s]."""

_SIDE = ("friction", "start", "right", "left")
_WIDTH = 1e3
"""Width of the slippery side [m]."""

Side = Literal["left", "right"]


def slippery_side(friction: float, side: Side, border: float, start: float) -> Rectangle:
    """Return a side of the road of a friction over that of the road [1], from y and x on [m]."""
    right = border - (_WIDTH if side == "right" else 0.0)
    return Rectangle(friction=friction, start=start, right=right, left=right + _WIDTH)


@register("manoeuvre", "split_braking")
class SplitBraking(DrivingTest):
    """Brake on the straight, one side of the road slippery; hold the steering wheel, or steer.

    The manoeuvre lays the slippery side over the scenario's road, from ``start`` on: the car starts
    in balance on even friction and drives onto it before it brakes. Without ``driver`` the steering
    wheel is held, as the standard's open-loop test asks for; a driver keeps the car on the x axis.
    The summary has, 1 s and 2 s after the brakes begin, deceleration, yaw rate, heading and
    lateral deviation, positive to the left, their largest values, stopping distance and mean fully
    developed deceleration; with a driver also the steering-wheel angle that keeps the path.

    References
    ----------
    ISO 14512, Passenger cars - Straight-ahead braking on surfaces with split coefficient of
    friction - Open-loop test procedure: for brakes up to full ABS operation, or without ABS up to
    the locking limit of the wheels on the high-friction side.
    """

    torque: float = quantity("N*m", "Brake torque of all wheels together", gt=0)
    brake_at: float = quantity("s", "When the brakes begin", default=1.0, ge=0)
    build_up: float = quantity("s", "How long the torque takes to grow", default=0.2, gt=0)
    low_friction: float = quantity(
        "1", "Friction of the slippery side over that of the road", default=0.3, gt=0, le=1
    )
    low_side: Side = Field(default="right", description="Slippery side")
    border: float = quantity("m", "World y of the border between the sides", default=0.0)
    start: float = quantity("m", "World x where the slippery side begins", default=3.0)
    driver: Driver | None = part(
        "driver", "Who steers; without one the steering wheel is held", default=None
    )

    def patches(self) -> tuple[FrictionPatch, ...]:
        """Return the slippery side."""
        return (slippery_side(self.low_friction, self.low_side, self.border, self.start),)

    def throttle(self) -> TimeTable:
        """Return the throttle, released when the brakes begin."""
        return TimeTable((self.brake_at, self.brake_at + 0.1), (1.0, 0.0))

    def brake_torque(self) -> TimeTable:
        """Return the brake torque, which grows and stays."""
        return TimeTable((self.brake_at, self.brake_at + self.build_up), (0.0, self.torque))

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with pedals and sensors, the wheel held or with its driver."""
        if self.driver is None:
            return super().fit(vehicle)
        path = _STRAIGHT.enter(vehicle.system.table, f"{PREFIX}.path")
        fitted = self.with_pedals(vehicle)
        return fitted.with_parts(self.driver.part(fitted, path))

    def settings_for(self, vehicle: RoadVehicle) -> dict[str, float]:
        """Return the parameters of the test, of the slippery side and of a driver's path."""
        last, (side,) = len(vehicle.surface.patches) - 1, self.patches()
        road = {f"road.patches.{last}.{n}": getattr(side, n) for n in _SIDE}
        settings = self.settings() | road
        if self.driver is None:
            return settings
        own = {n: v for n, v in settings.items() if not n.startswith(f"{PREFIX}.steering.")}
        return own | dict(_STRAIGHT.settings(f"{PREFIX}.path"))

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures after speed and answers."""
        title = "Braking on split friction"
        along, answers = figures.along(title, vehicle), figures.answers(title)
        return [along, answers, *figures.standard(vehicle)]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield decelerations, reactions at their times and at their largest, and the steering."""
        import numpy as np

        from vehicledyn.road.standards.braking import STOPPED, deceleration_figures

        braked = signals.between(self.brake_at, float(signals.time[-1]))
        if len(braked.time) < 2:
            return
        yield from deceleration_figures(braked)
        for after in _JUDGED:
            if signals.time[-1] >= self.brake_at + after:
                yield from self._at(signals, after)
        moves = braked.speed > STOPPED
        largest = int(np.argmax(np.abs(braked.yaw_rate) * moves))
        rate, time = float(braked.yaw_rate[largest]), float(braked.time[largest]) - self.brake_at
        yield from entry("largest_yaw_rate", rate, "rad/s", "Largest yaw rate while braking")
        words = "When that is, after the brakes begin"
        yield from entry("largest_yaw_rate_time", time, "s", words)
        aside = braked.y - braked.y[0]
        deviation = float(aside[np.argmax(np.abs(aside))])
        words = "Largest deviation from the straight path while braking"
        yield from entry("largest_lateral_deviation", deviation, "m", words)
        turned = float(braked.yaw[-1] - braked.yaw[0])
        yield from entry("heading_change", turned, "rad", "Heading at the end against the begin")
        if self.driver is not None:
            yield from self._steering(braked)

    def _at(self, signals: Signals, after: float) -> Iterator[SummaryEntry]:
        """Yield the reactions at a time after the brakes begin [s]."""
        label, at = f"{after:g}_s", self.brake_at + after

        def change(name: str) -> float:
            return signals.at(name, at) - signals.at(name, self.brake_at)

        slower = -change("speed") / after
        words = f"Mean deceleration in the first {after:g} s"
        yield from entry(f"mean_deceleration_{label}", slower, "m/s^2", words)
        later = f"{after:g} s after the brakes begin"
        rate = signals.at("yaw_rate", at)
        yield from entry(f"yaw_rate_{label}", rate, "rad/s", f"Yaw rate {later}")
        yield from entry(f"heading_change_{label}", change("yaw"), "rad", f"Heading {later}")
        words = f"Deviation from the straight path {later}"
        yield from entry(f"lateral_deviation_{label}", change("y"), "m", words)

    def _steering(self, braked: Signals) -> Iterator[SummaryEntry]:
        """Yield the steering-wheel angle that a driver needs."""
        import numpy as np

        from vehicledyn.road.standards.braking import STOPPED

        largest = float(braked.steering[np.argmax(np.abs(braked.steering))])
        yield from entry("largest_steering_angle", largest, "rad", "Largest steering-wheel angle")
        held = (braked.time >= self.brake_at + _JUDGED[0]) & (braked.speed > STOPPED)
        if held.any():
            words = "Mean steering-wheel angle that keeps the path, from 1 s on"
            yield from entry("steering_angle", float(braked.steering[held].mean()), "rad", words)
