"""Path: any path by points or along an OpenCRG road, with the speed over distance."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

from pydantic import Field, model_validator

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.course_test import ASKEW, STATION, CourseTest
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.multibody.model.parts import Situation
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.courses.course import Course
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle
    from vehicledyn.symbolic.ops import Scalar

_MOST_SPEEDS = 100

_TOLD_DIP = 0.05
"""Swing of the spline aside that is reported, a third of a tyre's width [m]."""


@register("manoeuvre", "path")
class Path(CourseTest):
    """Follow a path with a speed over distance.

    A cubic spline goes through the points ``xs``, ``ys``; without points the path is the reference
    line of the scenario's OpenCRG road. It begins at the origin along x, where the car starts (a
    spline whose first two points lead that way within 30 degrees begins exactly along x), and
    goes straight on beyond its end, or round and round if closed. A spline through points far apart
    swings aside before a bend; a note says by how much. The target speed is a polygon
    over the distance along the path, without ``speeds`` that of the start. The summary has the
    distance reached, the largest distance from path and target speed, the time at the end of the
    path and where the driver lost the car.
    """

    xs: tuple[float, ...] = quantity("m", "Places x of the points in order", default=())
    ys: tuple[float, ...] = quantity("m", "Places y of the points", default=())
    closed: bool = Field(default=False, description="Whether the last point leads to the first")
    distances: tuple[float, ...] = quantity(
        "m", f"Distances of the speeds along the path, growing, {_MOST_SPEEDS} at most", default=()
    )
    speeds: tuple[float, ...] = quantity("m/s", "Target speeds at the distances", default=())

    @model_validator(mode="after")
    def _fit_together(self) -> Path:
        """Refuse points and speeds that make no path and no profile."""
        for one, other in (("xs", "ys"), ("distances", "speeds")):
            counts = len(getattr(self, one)), len(getattr(self, other))
            if counts[0] != counts[1]:
                raise ValueError(f"{other}: {counts[1]} values and {counts[0]} {one}; give as many")
        points = list(zip(self.xs, self.ys, strict=True))
        if points and len(points) < (3 if self.closed else 2):
            raise ValueError("xs: a path has two points at least, a closed one three")
        for k, (a, b) in enumerate(pairwise(points), start=2):
            if a == b:
                raise ValueError(f"xs: point {k} is at the place of the one before; leave it out")
        if len(self.speeds) > _MOST_SPEEDS:
            raise ValueError(f"speeds: takes {_MOST_SPEEDS} speeds at most")
        if any(b <= a for a, b in pairwise(self.distances)):
            raise ValueError("distances: must grow; sort the profile")
        if any(speed < 0.0 for speed in self.speeds):
            raise ValueError("speeds: must not be negative; the car is driven forwards")
        return self

    def course(self, vehicle: RoadVehicle) -> Course:
        """Return the spline through the points, or along the road.

        Raises
        ------
        InputError
            If there are neither points nor an OpenCRG road.
        """
        import numpy as np

        from vehicledyn.road.courses.course import course_through
        from vehicledyn.road.surfaces.opencrg import OpenCrgRoad

        if self.xs:
            return course_through(
                np.array(self.xs),
                np.array(self.ys),
                is_closed=self.closed,
                along_x=self._begins_along_x(),
            )
        if not isinstance(vehicle.surface, OpenCrgRoad):
            raise InputError(
                "manoeuvre: a path needs points (xs, ys), or a road of the kind 'opencrg' whose "
                "reference line it follows"
            )
        line = vehicle.surface.ground().road.line
        stride = max(round(_SPACING / line.step), 1)
        kept = np.unique(np.append(np.arange(0, len(line.x), stride), len(line.x) - 1))
        return course_through(line.x[kept], line.y[kept])

    def _begins_along_x(self) -> bool:
        return abs(math.atan2(self.ys[1] - self.ys[0], self.xs[1] - self.xs[0])) < ASKEW

    def caution(self) -> str:
        """Return where the spline swings aside between points that do not bend so, else ""."""
        import numpy as np

        from vehicledyn.road.courses.course import largest_dip

        if not self.xs:
            return ""
        x, y = np.array(self.xs), np.array(self.ys)
        dip, at = largest_dip(x, y, is_closed=self.closed, along_x=self._begins_along_x())
        if dip < _TOLD_DIP:
            return ""
        after = (at + 1) % len(self.xs)
        return (
            f"manoeuvre: the spline through the points swings {dip:.2g} m aside between points "
            f"{at + 1} and {after + 1}, whose straight lines do not bend so; more points there "
            "keep it straight"
        )

    def target_speed(
        self, vehicle: RoadVehicle, change: Callable[[Scalar], Scalar]
    ) -> Callable[[Situation], Scalar]:
        """Return the speed over the distance along the path; that of the start until then.

        A start is balanced before the run, at rest where it is static: nothing drives there.
        """
        from vehicledyn.symbolic import ops

        if not self.speeds:
            return super().target_speed(vehicle, change)

        def target(seen: Situation) -> Scalar:
            wanted = self._profile(seen.all_states["driver"]["station"])
            return ops.where(seen.time < 0.0, vehicle.speed, wanted)

        return target

    def _profile(self, station: Scalar) -> Scalar:
        from vehicledyn.symbolic import ops

        found: Scalar = self.speeds[0]
        corners = list(zip(self.distances, self.speeds, strict=True))
        for (a, v), (b, w) in pairwise(corners):
            found = found + (w - v) * ops.minimum(ops.maximum((station - a) / (b - a), 0.0), 1.0)
        return found

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield distances from path and speed, and the time at the end."""
        import numpy as np

        yield from super().quantities(signals, recording, vehicle)
        station = np.asarray(recording.channels[STATION][:])
        if self.speeds:
            wanted = np.interp(station, self.distances, self.speeds)
            worst = float(np.abs(signals.forward_speed - wanted).max())
            yield from entry(
                "largest_speed_error", worst, "m/s", "Largest distance from the target speed"
            )
        length = self.course(vehicle).length
        words = "Length of the path, or of a round"
        yield from entry("path_length", length, "m", words)
        if station.max() >= length:
            at = int(np.argmax(station >= length))
            time = float(np.interp(length, station[: at + 1], signals.time[: at + 1]))
            yield from entry("time_at_end", time, "s", "Time at the end of the path or round")


_SPACING = 1.0
"""Distance of the points that are taken from a road's reference line [m]."""
