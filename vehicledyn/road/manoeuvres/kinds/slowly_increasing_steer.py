"""Slowly increasing steer: the steering wheel turns slowly at a constant speed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres import figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.steering_signal import SteeringSignal, ramp_and_hold
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle

_INITIAL = 4.0
"""Lateral acceleration up to which the initial gradients are taken [m/s²]."""


@register("manoeuvre", "slowly_increasing_steer")
class SlowlyIncreasingSteer(DrivingTest):
    """Turn the steering wheel slowly at a held speed, through steady states up to the limit.

    The summary has the steering-wheel angle at 0.3 g, which scales sine with dwell, fishhook and
    J-turn; gradients of understeer, side-slip and roll angle over lateral acceleration up to
    4 m/s²; and the largest lateral acceleration. The side-slip gradient includes rolling's share.

    References
    ----------
    49 CFR 571.126 (FMVSS 126) and UN R140, slowly increasing steer. ISO 4138, Passenger cars -
    Steady-state circular driving behaviour - Open-loop test methods, constant-speed method.
    """

    rate: float = quantity("rad/s", "Rate of the steering wheel", default=0.23561944901923448, gt=0)
    angle: float = quantity("rad", "Steering-wheel angle at the end, to the left")
    begin: float = quantity("s", "When the wheel begins to turn", default=0.5, ge=0)

    def steering(self) -> SteeringSignal:
        """Return the slow ramp."""
        return ramp_and_hold(self.angle, self.rate, self.begin)

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures with the answers over one another."""
        return [figures.answers("Slowly increasing steer"), *figures.standard(vehicle)]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield angle at 0.3 g, gradients and the limit."""
        import numpy as np

        from vehicledyn.road.standards.gradients import initial_gradient
        from vehicledyn.road.standards.steering_shares import angle_at_third_g

        sign = 1.0 if self.angle >= 0.0 else -1.0
        lateral = sign * signals.lateral_acceleration
        words = "Largest lateral acceleration"
        yield from entry("limit_lateral_acceleration", float(lateral.max()), "m/s^2", words)
        try:
            yield from entry(
                "steering_angle_at_third_g", angle_at_third_g(signals), "rad",
                "Steering-wheel angle A at 0.3 g, from the line between 0.1 g and 0.375 g",
            )  # fmt: skip
            rising = (np.arange(len(lateral)) <= int(lateral.argmax())) & (lateral > 0.2)
            for name, unit, text in _GRADIENTS:
                values = sign * getattr(signals, name)[rising]
                slope = initial_gradient(lateral[rising], values, _INITIAL)
                words = f"{text} over lateral acceleration, up to {_INITIAL:g} m/s^2"
                yield from entry(f"{name}_gradient", slope, unit, words)
        except InputError:
            return


_GRADIENTS = (
    ("understeer", "rad*s^2/m", "Understeer angle at the front wheels"),
    ("sideslip", "rad*s^2/m", "Side-slip angle"),
    ("roll", "rad*s^2/m", "Roll angle"),
)
