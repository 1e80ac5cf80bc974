"""Tests with MacAdam's driver: lane changes and split friction, with a kernel of their own."""

from __future__ import annotations

import math
from collections.abc import Callable

from vehicledyn.analyses.handling.standard_tests import SPLIT_SPEED, StandardTests
from vehicledyn.analyses.handling.test_run import DrivenTest, drive, figures_of, sheet_of
from vehicledyn.analyses.handling.tested_car import TestedCar
from vehicledyn.analyses.handling.turn_equations import TurnDemand
from vehicledyn.analyses.handling.turn_paths import reached
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.tables.handling_table import KeyFigure
from vehicledyn.road.drivers.macadam import MacAdam
from vehicledyn.road.manoeuvres.kinds.braking.split_braking import SplitBraking
from vehicledyn.road.manoeuvres.kinds.double_lane_change import DoubleLaneChange
from vehicledyn.road.manoeuvres.kinds.obstacle_avoidance import ObstacleAvoidance
from vehicledyn.road.manoeuvres.lane_change_test import LaneChangeTest
from vehicledyn.road.standards.steering_shares import STANDARD_GRAVITY

SPEEDS = {
    "double_lane_change": tuple(speed / 3.6 for speed in range(60, 105, 5)),
    "obstacle_avoidance": tuple(speed / 3.6 for speed in range(40, 85, 5)),
}
"""Entry speeds that are tried, until a corner leaves its lane [m/s]."""

_LARGEST_WHEEL_ANGLE = 0.6
_BEGIN = 20.0
_PREVIEW_TIME, _LONG_PREVIEW, _SHORT_PREVIEW = 0.8, 0.7, 0.5
"""Preview times on the straight, in the double lane change and in the quicker one [s]."""
_MOST_TRIES, _AT_REST = 4, 0.5
"""Runs of growing duration for a car that slows down, and the speed that is rest [m/s]."""

_GENTLE = 0.5
"""Lateral acceleration of the turn that shows the stiffness [m/s²]."""


def run_lane_changes(tests: StandardTests, *, backend: Backend) -> None:
    """Drive ISO 3888-1 and ISO 3888-2 at growing entry speeds, until a corner leaves its lane.

    Parameters
    ----------
    tests
        The tests of the car, which take the key figures.
    backend
        As for a run.
    """
    car = tests.solver.car
    front = max(corner[0] for corner in car.vehicle.outline)

    def double(speed: float) -> LaneChangeTest:
        driver = driver_of(tests, speed, _LONG_PREVIEW)
        return DoubleLaneChange(speed_control=car.control, driver=driver, begin=_BEGIN)

    def avoidance(speed: float) -> LaneChangeTest:
        driver, release = driver_of(tests, speed, _SHORT_PREVIEW), (_BEGIN + 2.0 - front) / speed
        return ObstacleAvoidance(
            speed_control=car.control, driver=driver, begin=_BEGIN, release_at=release
        )

    first = double(SPEEDS["double_lane_change"][0])
    driven = TestedCar(car.target, backend=backend, progress=tests.progress, test=first)
    driven.memory = car.memory
    for name, make in (("double_lane_change", double), ("obstacle_avoidance", avoidance)):
        _until_left(tests, driven, name, make)
    if tests.split_torque is not None and driven.has_slippery_side:
        _steer_on_split_friction(tests, driven, tests.split_torque)


def _steer_on_split_friction(tests: StandardTests, car: TestedCar, torque: float) -> None:
    """Brake with one side of the road slippery while the driver keeps the path (ISO 14512)."""
    driver = driver_of(tests, SPLIT_SPEED)
    test = SplitBraking(speed_control=car.control, torque=torque, driver=driver)
    name, words = "split_braking_steered", "split braking, steered"
    tests.progress(words, None)
    start = car.like(tests.solver.car, tests.straight_at(SPLIT_SPEED))
    run = drive(car, test, start, tests.split_duration, driver.numbers())
    if run.ended_by:
        tests.notes.append(f"{words}: {run.note()}; recorded until then")
    tests.figures += figures_of(car, name, run)
    tests.sheets[name] = sheet_of(run)


def _until_left(
    tests: StandardTests, car: TestedCar, name: str, make: Callable[[float], LaneChangeTest]
) -> None:
    """Drive a lane change at growing speeds; keep the last run that passes, or the first.

    A run in which the car comes to rest before the end, as with much recuperation, shows nothing.
    """
    passed, kept, figures = math.nan, None, []
    for speed in SPEEDS[name]:
        run = _drive(tests, car, make(speed), speed)
        found = figures_of(car, name, run)
        verdict = [bool(f.value) for f in found if f.name == "passed"]
        is_good = any(verdict) and not run.ended_by
        if kept is None or is_good or (math.isnan(passed) and verdict):
            kept, figures = run, found
        if not is_good and (verdict or run.ended_by):
            break
        if is_good:
            passed = speed
        else:
            words = f"{name.replace('_', ' ')} at {speed * 3.6:.0f} km/h"
            tests.notes.append(f"{words}: no verdict: {_unfinished(car, run)}")
    tests.figures += figures
    if kept is not None:
        tests.sheets[name] = sheet_of(kept)
    if not math.isnan(passed):
        low, high = (round(SPEEDS[name][k] * 3.6) for k in (0, -1))
        words = f"Largest entry speed that passes, of {low} to {high} km/h in steps of 5"
        tests.figures.append(KeyFigure(name, "largest_speed", passed, "m/s", words))


def _unfinished(car: TestedCar, run: DrivenTest) -> str:
    """Return why a run of a lane change has no verdict, empty if it has one."""
    entries = run.test.quantities(run.signals, run.recording, car.vehicle)
    return next((str(e.value) for e in entries if e.name == "unfinished"), "")


def driver_of(tests: StandardTests, speed: float, preview: float = _PREVIEW_TIME) -> MacAdam:
    """Return a driver who knows the car's axle loads and cornering stiffness.

    The stiffness is that of a gentle turn; the yaw inertia is taken as the mass times both axle
    distances, which is near that of usual cars.
    """
    solver, vehicle = tests.solver, tests.solver.car.vehicle
    straight = solver.car.outputs(tests.straight_at(speed))

    def turn(lateral: float) -> TurnDemand:
        return TurnDemand(speed, "lateral_acceleration", lateral)

    start = tests.straight_at(speed)
    gentle = solver.car.outputs(reached(solver, turn, _GENTLE, start, steps=1))
    loads, stiffness = {}, {}
    for is_front in (True, False):
        names = [f"{c.name}.tyre" for c in vehicle.corners if c.is_front == is_front]
        loads[is_front] = sum(straight[f"{name}.normal_force"] for name in names)
        gained = [
            sum(after[f"{n}.{what}"] - straight[f"{n}.{what}"] for n in names)
            for what in ("lateral_force", "slip_angle")
            for after in (gentle,)
        ]
        stiffness[is_front] = abs(gained[0] / gained[1]) * len(names)
    wheelbase, whole = solver.car.worth(vehicle.wheelbase), loads[True] + loads[False]
    front, rear = (wheelbase * loads[not is_front] / whole for is_front in (True, False))
    mass = whole / STANDARD_GRAVITY
    return MacAdam(
        preview_time=preview, points=10, speed=speed, mass=mass,
        yaw_inertia=mass * front * rear, front_distance=front, rear_distance=rear,
        front_stiffness=stiffness[True], rear_stiffness=stiffness[False], lag_frequency=30.0,
        lag_damping=0.8,
        rack_stop=_LARGEST_WHEEL_ANGLE / abs(solver.car.worth(vehicle.steering_gain)),
    )  # fmt: skip


def _drive(tests: StandardTests, car: TestedCar, test: LaneChangeTest, speed: float) -> DrivenTest:
    words = f"{test.kind.replace('_', ' ')} at {speed * 3.6:.0f} km/h"
    tests.progress(words, None)
    start = car.like(tests.solver.car, tests.straight_at(speed))
    end = test.lanes(car.vehicle)[2].end
    numbers = test.driver.numbers()  # type: ignore[attr-defined]
    duration = (end + 8.0) / speed * 1.1
    run = drive(car, test, start, duration, numbers)
    for _ in range(_MOST_TRIES):
        if run.ended_by or run.signals.speed[-1] < _AT_REST or not _unfinished(car, run):
            break
        duration *= 1.5
        run = drive(car, test, start, duration, numbers)
    if run.ended_by:
        tests.notes.append(f"{words}: {run.note()}; recorded until then")
    return run
