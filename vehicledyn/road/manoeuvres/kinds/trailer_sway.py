"""Trailer sway: a pulse of the steering wheel, and how the trailer's oscillation dies out."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres import figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.steering_signal import SteeringSignal
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle


@register("manoeuvre", "trailer_sway")
class TrailerSway(DrivingTest):
    """Turn the steering wheel through half a period of a sine, then hold it in the middle.

    The summary has damping ratio and frequency of the oscillation that remains: of the
    articulation angle where its coordinate is named, else of the yaw rate. The speed of zero
    damping is the critical speed.

    References
    ----------
    ISO 9815, Road vehicles - Passenger-car and trailer combinations - Lateral stability test.
    """

    coordinate_fields: ClassVar[tuple[str, ...]] = ("articulation",)

    amplitude: float = quantity("rad", "Largest steering-wheel angle")
    width: float = quantity("s", "How long the pulse lasts", default=0.3, gt=0)
    begin: float = quantity("s", "When the pulse begins", default=0.5, ge=0)
    free_after: float = quantity(
        "s", "After the pulse, when other motions have died out and the damping is read",
        default=1.0, ge=0,
    )  # fmt: skip
    articulation: str | None = Field(
        default=None, description="Coordinate of the angle between car and trailer"
    )

    def steering(self) -> SteeringSignal:
        """Return the pulse."""
        return SteeringSignal(
            amplitude=self.amplitude, frequency=0.5 / self.width, cycles=0.5, hold_at=1e6,
            begin=self.begin,
        )  # fmt: skip

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with the parts of the test.

        Raises
        ------
        InputError
            If the vehicle has no coordinate of the name ``articulation``.
        """
        known = [joint.name for joint in vehicle.system.joints()]
        if self.articulation is not None and self.articulation not in known:
            raise InputError(
                f"manoeuvre.articulation: {unknown_name('coordinate', self.articulation, known)}"
            )
        return super().fit(vehicle)

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures with the answers over one another."""
        return [figures.answers("Trailer sway"), *figures.standard(vehicle)]

    def channels(self, vehicle: RoadVehicle) -> list[str]:
        """Return the channels of the test's quantities, the articulation angle among them."""
        own = [] if self.articulation is None else [self.articulation]
        return list(dict.fromkeys([*super().channels(vehicle), *own]))

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield damping ratio and frequency of the sway."""
        from vehicledyn.road.standards.decay import decay_of

        swaying = signals.yaw_rate
        if self.articulation is not None:
            swaying = recording.channels[self.articulation][:]
        free = signals.time >= self.begin + self.width + self.free_after
        found = decay_of(signals.time[free], swaying[free])
        words = "Damping ratio of the sway; negative where it grows"
        yield from entry("sway_damping_ratio", found.damping_ratio, "1", words)
        yield from entry("sway_frequency", found.frequency, "Hz", "Frequency of the sway")
