"""Constant radius: the speed grows on a circle until the car leaves it (ISO 4138)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.course_test import PATH_ERROR, CourseTest
from vehicledyn.road.manoeuvres.driving_test import PREFIX
from vehicledyn.road.manoeuvres.time_table import TimeTable
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.courses.course import Course
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle

    Floats = NDArray[np.float64]


@register("manoeuvre", "constant_radius")
class ConstantRadius(CourseTest):
    """Raise the speed slowly on a circle until the car leaves it.

    The circle touches the x axis at the start, where the car begins. It is left where the car is
    farther from it than ``tolerance``, or two wheels have no load, or the speed is 2 m/s below its
    target. The summary has the largest lateral acceleration until then, the speed there and what
    limits it: the axle of the larger slip angle, lifted wheels, the drive, which no longer raises
    the speed, or oscillation of driver and car, which a longer preview time may settle. Between 2
    and 4 m/s² it has the understeer gradient, of the angle beyond wheelbase times curvature.

    References
    ----------
    ISO 4138, Passenger cars - Steady-state circular driving behaviour - Open-loop test methods,
    constant-radius method.
    """

    radius: float = quantity("m", "Radius of the circle, to the left if positive", default=100.0)
    begin: float = quantity("s", "When the speed begins to grow", default=5.0, ge=0)
    acceleration: float = quantity("m/s^2", "Growth of the speed", default=0.2, gt=0)
    last_speed_change: float = quantity("m/s", "Speed gained in the end", gt=0)
    tolerance: float = quantity("m", "Distance from the circle that leaves it", default=1.0, gt=0)

    def speed_change(self) -> TimeTable:
        """Return the slow growth of the target speed."""
        end = self.begin + self.last_speed_change / self.acceleration
        return TimeTable((self.begin, end), (0.0, self.last_speed_change))

    def course(self, vehicle: RoadVehicle) -> Course:
        """Return the circle.

        Raises
        ------
        InputError
            If the radius is zero.
        """
        return self._circle(self.radius)

    def course_in(self, vehicle: RoadVehicle) -> Course:
        """Return the circle with its radius as a parameter."""
        words = "Radius of the circle"
        return self._circle(vehicle.system.table.add(f"{PREFIX}.radius", self.radius, "m", words))

    def _circle(self, radius: Any) -> Course:
        from vehicledyn.road.courses.course import CircleCourse

        if self.radius == 0.0:
            raise InputError("manoeuvre: radius: a circle has a radius other than zero")
        return CircleCourse(radius, self.radius)

    def settings(self) -> dict[str, float]:
        """Return the parameters of the test by name."""
        return {**super().settings(), f"{PREFIX}.radius": self.radius}

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield the limit and what limits it."""
        import numpy as np

        from vehicledyn.road.standards.gradients import gradient_at

        yield from super().quantities(signals, recording, vehicle)
        sign = 1.0 if self.radius > 0.0 else -1.0
        error = np.asarray(recording.channels[PATH_ERROR][:])
        lifted = _lifted(recording, vehicle)
        missing = self._target(signals) - signals.forward_speed
        gone = (np.abs(error) > self.tolerance) | (lifted >= _TWO) | (missing > _SLOW)
        gone &= signals.time >= self.begin
        lateral = _mean(signals.time, sign * signals.yaw_rate * signals.speed)
        end = int(np.argmax(gone)) if gone.any() else len(lateral) - 1
        steady = signals.time <= signals.time[end] + 1e-9
        at = int(np.argmax(np.where(steady & (signals.time >= self.begin), lateral, -np.inf)))
        if gone.any():
            words = "Largest lateral acceleration on the circle, speed times yaw rate over 1 s"
            yield from entry("limit_lateral_acceleration", float(lateral[at]), "m/s^2", words)
            yield from entry("limit_speed", float(signals.speed[at]), "m/s", "Speed there")
            words = "When the car left the circle, or lifted, or the speed no longer grew"
            yield from entry("limit_at_time", float(signals.time[end]), "s", words)
            cause = self._cause(recording, vehicle, end, error[end], lifted[end])
            before = signals.between(signals.time[end] - _JUDGED, signals.time[end])
            if np.std(before.yaw_rate) > _UNSTEADY * abs(before.yaw_rate.mean()):
                cause = "oscillation"
            words = "What limits: front or rear axle, lifted wheels, drive, or oscillation"
            yield from entry("limited_by", cause, "", words)
        else:
            words = "Largest lateral acceleration; the circle was not left"
            yield from entry("reached_lateral_acceleration", float(lateral[at]), "m/s^2", words)
        kept = steady & (signals.time >= self.begin)
        try:
            slope = gradient_at(lateral[kept], sign * signals.understeer[kept], 3.0, width=1.0)
        except InputError:
            return
        words = "Understeer angle over lateral acceleration, from 2 to 4 m/s^2"
        yield from entry("understeer_gradient", slope, "rad*s^2/m", words)

    def _target(self, signals: Signals) -> Floats:
        import numpy as np

        table = self.speed_change()
        gained: Floats = np.interp(signals.time, table.times, table.values)
        target: Floats = signals.forward_speed[0] + gained
        return target

    def _cause(
        self, recording: Recording, vehicle: RoadVehicle, at: int, error: float, lifted: int
    ) -> str:
        if lifted >= _TWO:
            return "lifted wheels"
        if abs(error) <= self.tolerance:
            return "drive"
        slip = {True: 0.0, False: 0.0}
        for corner in vehicle.corners:
            angle = float(recording.channels[f"{corner.name}.tyre.slip_angle"][at : at + 1][0])
            slip[corner.is_front] += angle
        return "front axle" if abs(slip[True]) > abs(slip[False]) else "rear axle"


def _mean(time: Floats, values: Floats) -> Floats:
    """Return the mean of a second around each time, shorter at the ends."""
    import numpy as np

    step = 0.5 * _SMOOTHED
    whole = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(time) * (values[1:] + values[:-1]))])
    first, last = np.maximum(time - step, time[0]), np.minimum(time + step, time[-1])
    found: Floats = np.interp(last, time, whole) - np.interp(first, time, whole)
    mean: Floats = found / (last - first)
    return mean


def _lifted(recording: Recording, vehicle: RoadVehicle) -> Any:
    """Return how many wheels have no load, by sample."""
    import numpy as np

    loads = [
        np.asarray(recording.channels[f"{corner.name}.tyre.normal_force"][:])
        for corner in vehicle.corners
    ]
    return sum((load <= 0.0).astype(int) for load in loads)


_SMOOTHED, _JUDGED, _UNSTEADY = 1.0, 2.0, 0.25
"""Times of the mean and before the end [s], and deviation over mean of the yaw rate there [1]."""

_TWO = 2
"""Wheels without load that count as the limit."""

_SLOW = 2.0
"""Speed below the target at which the drive limits [m/s]."""
