"""Lane changes between cones with a preview driver: a kernel of their own, since he steers."""

from __future__ import annotations

import math

from vehicledyn.analyses.handling.standard_tests import StandardTests
from vehicledyn.analyses.handling.test_run import DrivenTest, drive, figures_of, sheet_of
from vehicledyn.analyses.handling.tested_car import TestedCar
from vehicledyn.kernel.kernel import Backend
from vehicledyn.results.tables.handling_table import TRUTH, KeyFigure
from vehicledyn.road.drivers.preview import Preview
from vehicledyn.road.manoeuvres.double_lane_change import DoubleLaneChange
from vehicledyn.road.manoeuvres.lane_change_test import LaneChangeTest
from vehicledyn.road.manoeuvres.obstacle_avoidance import ObstacleAvoidance

ENTRY_SPEED = 80.0 / 3.6
"""Entry speed of the double lane change [m/s]."""

AVOIDANCE_SPEEDS = tuple(speed / 3.6 for speed in (40.0, 50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0))
"""Entry speeds at which the obstacle avoidance is tried, until one fails [m/s]."""

_LARGEST_WHEEL_ANGLE = 0.6
_BEGIN = 20.0


def run_lane_changes(tests: StandardTests, understeer: float, *, backend: Backend) -> None:
    """Drive ISO 3888-1 at 80 km/h, and ISO 3888-2 at growing speeds until a corner leaves.

    Parameters
    ----------
    tests
        The tests of the car, which take the key figures.
    understeer
        Understeer gradient that the driver makes up for [rad s²/m].
    backend
        As for a run.
    """
    car = tests.solver.car
    driver = Preview(
        preview_time=0.5,
        understeer=understeer,
        lag_frequency=30.0,
        lag_damping=0.8,
        rack_stop=_LARGEST_WHEEL_ANGLE / abs(car.worth(car.vehicle.steering_gain)),
    )
    test = DoubleLaneChange(speed_control=car.control, driver=driver, begin=_BEGIN)
    driven = TestedCar(car.target, backend=backend, progress=tests.progress, test=test)
    run = _drive(tests, driven, test, ENTRY_SPEED)
    tests.figures += figures_of(driven, "double_lane_change", run)
    tests.sheets["double_lane_change"] = sheet_of(run)
    passed = math.nan
    for speed in AVOIDANCE_SPEEDS:
        front = max(corner[0] for corner in car.vehicle.outline)
        release = (_BEGIN + 2.0 - front) / speed
        avoidance = ObstacleAvoidance(
            speed_control=car.control, driver=driver, begin=_BEGIN, release_at=release
        )
        tried = _drive(tests, driven, avoidance, speed)
        found = figures_of(driven, "obstacle_avoidance", tried)
        if not next(f.value for f in found if f.name == "passed"):
            break
        passed, kept, run = speed, found, tried
    if not math.isnan(passed):
        tests.figures += kept
        tests.sheets["obstacle_avoidance"] = sheet_of(run)
        words = "Largest entry speed that passes, of 40 and 50 to 80 km/h in steps of 5"
        tests.figures.append(KeyFigure("obstacle_avoidance", "largest_speed", passed, "m/s", words))
    else:
        words = "Whether it passes at 40 km/h"
        tests.figures.append(KeyFigure("obstacle_avoidance", "passed", 0.0, TRUTH, words))


def _drive(tests: StandardTests, car: TestedCar, test: LaneChangeTest, speed: float) -> DrivenTest:
    words = f"{test.kind.replace('_', ' ')} at {speed * 3.6:.0f} km/h"
    tests.progress(words, None)
    start = car.like(tests.solver.car, tests.straight_at(speed))
    end = test.lanes(car.vehicle)[2].end
    run = drive(car, test, start, (end + 8.0) / speed * 1.1)
    if run.ended_by:
        tests.notes.append(f"{words}: {run.note()}; recorded until then")
    return run
