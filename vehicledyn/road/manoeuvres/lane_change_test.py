"""Base of the lane changes between cones: a driver follows a path through the lanes."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, ClassVar

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import part, quantity
from vehicledyn.road.drivers.driver import Driver
from vehicledyn.road.manoeuvres import figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.driving_test import PREFIX, DrivingTest
from vehicledyn.road.manoeuvres.step_path import StepPath
from vehicledyn.road.standards.entries import entry
from vehicledyn.road.standards.evasion import Lane, cones, passage

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SceneItem, SummaryEntry
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle

_CONE_RADIUS = 0.1
_PATH_ERROR = "driver.path_error"

_SECTIONS = (1, 3, 5)

LOST = 5.0
"""Distance from the path at which a driver has lost the car [m]."""


class LaneChangeTest(DrivingTest):
    """Base: the lanes follow from the vehicle's width, the corners of its outline must keep them.

    The path joins the lanes by steps of continuous curvature: their middles, or with cut corners.
    """

    standard: ClassVar[str]
    """The standard that the lanes are of."""

    corner: ClassVar[float] = 0.0
    """How far a step begins before the end of a lane, and ends behind the begin of the next [m]."""

    inner: ClassVar[float] = 0.5
    """Place of the path in the room that the third lane leaves beside the car, from the inside."""

    driver: Driver = part("driver", "Who steers")
    begin: float = quantity("m", "Position x where the first lane begins", default=20.0)

    @abstractmethod
    def lanes(self, vehicle: RoadVehicle) -> tuple[Lane, Lane, Lane]:
        """Return the three lanes."""

    def path(self, vehicle: RoadVehicle) -> StepPath:
        """Return the path through the lanes."""
        first, third, fifth = self.lanes(vehicle)
        sides = [corner[1] for corner in vehicle.outline]
        room = third.width - (max(sides) - min(sides))
        aside, cut = third.middle + (self.inner - 0.5) * room, self.corner
        return StepPath(
            (first.end - cut, third.begin + cut, third.end - cut, fifth.begin + cut),
            (first.middle, aside, aside, fifth.middle),
        )

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with its driver, pedals and sensors.

        Raises
        ------
        InputError
            If the path has a corner that the driver's rack stop does not let the car take.
        """
        self._refuse_tight_corner(vehicle)
        path = self.path(vehicle).enter(vehicle.system.table, f"{PREFIX}.path")
        fitted = self.with_pedals(vehicle)
        return fitted.with_parts(self.driver.part(fitted, path))

    def settings_for(self, vehicle: RoadVehicle) -> dict[str, float]:
        """Return the parameters of the test and of its path by name; the driver steers."""
        settings = self.settings()
        own = {n: v for n, v in settings.items() if not n.startswith(f"{PREFIX}.steering.")}
        return {**own, **dict(self.path(vehicle).settings(f"{PREFIX}.path"))}

    def _refuse_tight_corner(self, vehicle: RoadVehicle) -> None:
        stop = getattr(self.driver, "rack_stop", None)
        if stop is None:
            return
        radius, place = self.path(vehicle).tightest()
        needed = math.atan(vehicle.worth(vehicle.wheelbase) / radius)
        most = abs(vehicle.worth(vehicle.steering_gain)) * stop
        if needed > most:
            raise InputError(
                f"manoeuvre: the path turns with a radius of {radius:.3g} m behind "
                f"x = {place:.4g} m, which needs {math.degrees(needed):.3g} deg at the front "
                f"wheels; the driver's rack_stop lets them turn by {math.degrees(most):.3g} deg"
            )

    def holds_speed(self) -> bool:
        """Return that the speed may fall on the way, or follow a profile."""
        return False

    def channels(self, vehicle: RoadVehicle) -> list[str]:
        """Return also the channel that shows how far the car is from its path."""
        return [*super().channels(vehicle), _PATH_ERROR]

    def scene(self, vehicle: RoadVehicle) -> dict[str, SceneItem]:
        """Return the cones and the outline of the body."""
        from vehicledyn.results.store.layout import SceneItem

        places = cones(self.lanes(vehicle))
        item = SceneItem(places, "m", "Feet of the cones", {"radius": _CONE_RADIUS})
        return {**super().scene(vehicle), "cones": item}

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures with the path between the cones."""
        found = figures.standard(vehicle, path_title="Path between the cones")
        return [*found, figures.answers("Steering and answers")]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield pass or fail, clearances of the lanes and speeds at their ends."""
        import numpy as np

        pose = np.array([signals.x, signals.y, signals.yaw])
        lanes = self.lanes(vehicle)
        found = [passage(lane, vehicle.outline, pose) for lane in lanes]
        far = np.abs(np.asarray(recording.channels[_PATH_ERROR][:])) > LOST
        kept = [item.clearance > 0.0 for item in found if item.entered]
        if len(kept) == len(found) or not all(kept) or far.any():
            ok = len(kept) == len(found) and all(kept)
            words = f"Whether all corners kept all lanes ({self.standard})"
            yield from entry("passed", ok, "1", words)
        else:
            section = _SECTIONS[len(kept)]
            speed = float(signals.speed[-1])
            reason = f"the run ends before the car has left section {section}, at {speed:.2g} m/s"
            yield from entry("unfinished", reason, "", "Why there is no verdict")
        for number, item in zip(_SECTIONS, found, strict=True):
            words = f"Section {number}: smallest clearance of a corner"
            yield from entry(f"clearance_{number}", item.clearance, "m", words)
        front = max(corner[0] for corner in vehicle.outline)
        for name, x in (("entry_speed", lanes[0].begin), ("exit_speed", lanes[2].end)):
            if signals.x[-1] + front >= x >= signals.x[0] + front:
                speed = float(np.interp(x - front, signals.x, signals.speed))
                words = f"Speed when the front is at the {'begin' if 'entry' in name else 'end'}"
                yield from entry(name, speed, "m/s", words)
        if far.any():
            at = int(np.argmax(far))
            words = f"When the driver lost the car, {LOST:g} m from its path"
            yield from entry("lost_at_time", float(signals.time[at]), "s", words)
            words = "Position x at which he lost it"
            yield from entry("lost_at_x", float(signals.x[at]), "m", words)
        largest = float(np.abs(signals.steering).max())
        yield from entry("largest_steering_angle", largest, "rad", "Largest steering angle")
