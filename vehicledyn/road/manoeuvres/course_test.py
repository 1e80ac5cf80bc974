"""Base of the tests on a course: a preview driver steers, the speed follows a target."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from pydantic import model_validator

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import part, quantity
from vehicledyn.road.drivers.driver import Driver
from vehicledyn.road.drivers.preview import Preview
from vehicledyn.road.manoeuvres import figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.driving_test import PREFIX, DrivingTest
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.multibody.model.parts import Situation
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.courses.course import Course
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle
    from vehicledyn.symbolic.ops import Scalar

PATH_ERROR, STATION = "driver.path_error", "driver.station"

LOST = 5.0
"""Distance from the path at which a driver has lost the car [m]."""

_BESIDE, ASKEW = 3.0, math.radians(30.0)
"""Distance [m] and angle [rad] from the car at the start beyond which a course is refused."""


class CourseTest(DrivingTest):
    """Base: the car starts at the course's first point, which is near the world's origin."""

    driver: Driver = part("driver", "Who steers; of the kind 'preview'")
    steering_integral_gain: float = quantity(
        "rad/(m*s)", "Growth of the front-wheel angle per metre off the path", default=0.0, ge=0
    )
    brake_gain: float = quantity(
        "N*s", "Brake torque of all wheels a speed above the target", default=0.0, ge=0
    )

    @model_validator(mode="after")
    def _drives_by_preview(self) -> CourseTest:
        if not isinstance(self.driver, Preview):
            raise ValueError("driver: a course is driven by the kind 'preview', the others steer")
        return self

    @abstractmethod
    def course(self, vehicle: RoadVehicle) -> Course:
        """Return the course; numbers of the scenario only."""

    def course_in(self, vehicle: RoadVehicle) -> Course:
        """Return the course with its parameters in the vehicle's table."""
        return self.course(vehicle)

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with its driver, pedals and sensors.

        Raises
        ------
        InputError
            If the course starts elsewhere, or has a corner that the car cannot take.
        """
        from vehicledyn.road.courses.course_driver import NAME, CourseDriver

        self._refuse_other_start(vehicle)
        self._refuse_tight_corner(vehicle)
        table = vehicle.system.table
        settings: Any = table.add_set("driver", self.driver)
        words = "Growth of the front-wheel angle per metre off the path"
        gain = table.add(
            f"{PREFIX}.steering_integral_gain", self.steering_integral_gain, "rad/(m*s)", words
        )
        fitted = self.with_pedals(vehicle)
        return fitted.with_parts(
            CourseDriver(NAME, fitted, settings, gain, self.course_in(vehicle))
        )

    def braking(
        self, vehicle: RoadVehicle, target: Callable[[Situation], Scalar]
    ) -> Callable[[Situation], Scalar] | None:
        """Return the brake torque of a speed above the target, as a function of the motion."""
        from vehicledyn.road.manoeuvres.pedals import forward_speed
        from vehicledyn.symbolic import ops

        if self.brake_gain == 0.0:
            return None
        gain = vehicle.system.table.add(
            f"{PREFIX}.brake_gain", self.brake_gain, "N*s", "Brake torque a speed above the target"
        )
        return lambda seen: (
            gain * ops.maximum(forward_speed(seen, vehicle.chassis) - target(seen), 0.0)
        )

    def _refuse_other_start(self, vehicle: RoadVehicle) -> None:
        course = self.course(vehicle)
        x, y = (float(v) for v in course.place(0.0))
        heading = math.remainder(float(course.heading(0.0)), math.tau)
        if math.hypot(x, y) > _BESIDE or abs(heading) > ASKEW:
            raise InputError(
                f"manoeuvre: the path begins at x = {x:.4g} m, y = {y:.4g} m with a heading of "
                f"{math.degrees(heading):.3g} deg; the car starts at the origin along x: begin "
                f"the path there, within {_BESIDE:g} m and {math.degrees(ASKEW):g} deg"
            )

    def _refuse_tight_corner(self, vehicle: RoadVehicle) -> None:
        stop: float = self.driver.rack_stop  # type: ignore[attr-defined]
        course = self.course(vehicle)
        radius, station = course.tightest()
        needed = math.atan(vehicle.worth(vehicle.wheelbase) / radius)
        most = abs(vehicle.worth(vehicle.steering_gain)) * stop
        if needed > most:
            x, y = (float(v) for v in course.place(station))
            raise InputError(
                f"manoeuvre: the path turns with a radius of {radius:.3g} m at x = {x:.4g} m, "
                f"y = {y:.4g} m, {station:.4g} m from its begin, which needs "
                f"{math.degrees(needed):.3g} deg at the front wheels; the driver's rack_stop lets "
                f"them turn by {math.degrees(most):.3g} deg"
            )

    def settings_for(self, vehicle: RoadVehicle) -> dict[str, float]:
        """Return the parameters of the test by name; the driver steers."""
        settings = self.settings()
        return {n: v for n, v in settings.items() if not n.startswith(f"{PREFIX}.steering.")}

    def holds_speed(self) -> bool:
        """Return that the speed may fall on the way, or follow a profile."""
        return False

    def channels(self, vehicle: RoadVehicle) -> list[str]:
        """Return also where the car is on its path and beside it."""
        return [*super().channels(vehicle), PATH_ERROR, STATION]

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures after speed and answers."""
        found = figures.standard(vehicle, path_title="Path")
        return [*found, figures.along("Speed", vehicle), figures.answers("Steering and answers")]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield how near the car was to its path, how far it came and where it was lost."""
        import numpy as np

        error = np.abs(np.asarray(recording.channels[PATH_ERROR][:]))
        station = np.asarray(recording.channels[STATION][:])
        way = float(station.max())
        yield from entry("distance_on_path", way, "m", "Distance along the path")
        far = error > LOST
        on = error if not far.any() else error[: max(int(np.argmax(far)), 1)]
        words = "Largest distance from the path, until the car was lost"
        yield from entry("largest_path_error", float(on.max()), "m", words)
        if far.any():
            at = int(np.argmax(far))
            words = f"When the driver lost the car, {LOST:g} m from its path"
            yield from entry("lost_at_time", float(signals.time[at]), "s", words)
            words = "Distance along the path at which he lost it"
            yield from entry("lost_at_distance", float(station[at]), "m", words)
        largest = float(np.abs(signals.steering).max())
        yield from entry("largest_steering_angle", largest, "rad", "Largest steering angle")
