"""The open-loop tests of the standards on one car, each scaled by its steady cornering."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeVar

import numpy as np

from vehicledyn.analyses.handling.circle import constant_speed
from vehicledyn.analyses.handling.cornering_modes import CorneringModes
from vehicledyn.analyses.handling.dwell_series import dwell_series
from vehicledyn.analyses.handling.response_sheets import (
    ANSWERS,
    measured_responses,
    response_sheet,
)
from vehicledyn.analyses.handling.steady_turn import SteadyTurn
from vehicledyn.analyses.handling.test_run import DrivenTest, drive, figures_of, sheet_of
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.tip_up_search import tip_up_search
from vehicledyn.analyses.handling.turn_equations import TurnDemand
from vehicledyn.analyses.handling.turn_paths import reached
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.results.tables.handling_table import KeyFigure, Sheet
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.frequency_test import FREQUENCIES
from vehicledyn.road.manoeuvres.kinds.braking.braking_in_turn import BrakingInTurn
from vehicledyn.road.manoeuvres.kinds.braking.split_braking import SplitBraking
from vehicledyn.road.manoeuvres.kinds.braking.straight_braking import StraightBraking
from vehicledyn.road.manoeuvres.kinds.coast_down import CoastDown
from vehicledyn.road.manoeuvres.kinds.crosswind import Crosswind
from vehicledyn.road.manoeuvres.kinds.fishhook import Fishhook
from vehicledyn.road.manoeuvres.kinds.j_turn import JTurn
from vehicledyn.road.manoeuvres.kinds.pulse_steer import PulseSteer
from vehicledyn.road.manoeuvres.kinds.single_sine import SingleSine
from vehicledyn.road.manoeuvres.kinds.slowly_increasing_steer import SlowlyIncreasingSteer
from vehicledyn.road.manoeuvres.kinds.step_steer import StepSteer
from vehicledyn.road.manoeuvres.kinds.swept_sine import SweptSine
from vehicledyn.road.manoeuvres.kinds.trailer_sway import TrailerSway
from vehicledyn.road.manoeuvres.kinds.weave import Weave
from vehicledyn.road.manoeuvres.sine_dwell_test import SineDwellTest
from vehicledyn.road.manoeuvres.speed_control import SpeedControl
from vehicledyn.road.standards.steering_shares import angle_at_third_g

T = TypeVar("T")

_TOWN, _MOTORWAY = 80.0 / 3.6, 100.0 / 3.6
_MILE = 0.44704
ROLLOVER_SPEEDS = tuple(speed * _MILE for speed in (35.0, 40.0, 45.0, 47.5, 50.0))
"""Entry speeds of the rollover tests, 35 to 50 mile/h [m/s]."""

_BRAKE_AFTER, _STOPPING_SHARE = 1.0, 0.7
"""When brakes are on [s], and the part of what they are to give that a test surely has [1]."""

SPLIT_SPEED, SPLIT_DECELERATION, SPLIT_DURATION = _MOTORWAY, 4.0, 12.0
"""Initial speed on split friction [m/s], what its brakes would give on even friction [m/s²], and
how long a run takes; a mean deceleration of 2.5 m/s² stops the car in it [s]."""

_STEP_RATE, _FISHHOOK_RATE, _J_TURN_RATE = (math.radians(rate) for rate in (500.0, 720.0, 1000.0))
"""Rates of the steering wheel in step steer, fishhook and J-turn [rad/s]."""

USUAL_RATIO = 16.0
"""Steering ratio by which these are divided for a model that has no steering wheel [1]."""

_JUST_BELOW = 0.995
"""Part of a wanted level that counts as it [1]."""

_PARTS_BRAKED = (1.0, 0.75, 0.5, 0.35)
"""Parts of the wanted deceleration that are tried where wheels lock before."""


@dataclass
class StandardTests:
    """Runs the tests and collects their key figures, sheets and notes."""

    solver: SteadyTurn
    progress: Callable[[str, float | None], None]
    figures: list[KeyFigure] = field(default_factory=list)
    sheets: dict[str, Sheet] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    split_torque: float | None = None
    """Brake torque of the test on split friction, once it is known [N m]."""
    split_duration: float = SPLIT_DURATION
    """How long that test takes, with brakes that give less than is wanted too [s]."""
    _straight: dict[float, CarPoint] = field(default_factory=dict)

    def run_all(self) -> None:
        """Run all open-loop tests."""
        third_g = self.tried("slowly increasing steer", self.slowly_increasing_steer)
        self.tried("transients", self.transients)
        self.tried("frequency responses", self.frequency_responses)
        self.tried("weave", self.weave)
        if third_g is None:
            self.notes.append("tests scaled by the steering angle at 0.3 g are left out")
        else:
            self.tried("sine with dwell", lambda: self.sine_with_dwell(third_g))
            self.tried("fishhook", lambda: self.fishhook(third_g))
            self.tried("J-turn", lambda: self.j_turn(third_g))
        self.tried("braking", self.braking)
        self.tried("crosswind", self.crosswind)
        self.tried("coast-down", self.coast_down)
        if self.solver.car.vehicle.articulation is not None:
            self.tried("trailer sway", self.trailer_sway)

    def tried(self, words: str, test: Callable[[], T]) -> T | None:
        """Run a test; note why it cannot be done, so that the others are kept."""
        try:
            return test()
        except NumericalError as error:
            self.notes.append(f"{words}: left out: {error}")
            return None

    def slowly_increasing_steer(self) -> float | None:
        """Run the slowly increasing steer to both sides; return the mean angle at 0.3 g [rad]."""
        last = 1.05 * self._angle(_TOWN, self._level("slowly increasing steer", 4.8, 0.95))
        rate = math.radians(13.5) if self.solver.car.has_steering_wheel else last / 15.75
        name, duration = "slowly_increasing_steer", 0.5 + last / rate + 0.5

        def test(angle: float) -> SlowlyIncreasingSteer:
            return SlowlyIncreasingSteer(speed_control=self._control, angle=angle, rate=rate)

        runs = [
            self._run(name, test(last), _TOWN, duration),
            self._drive(f"{name.replace('_', ' ')} to the right", test(-last), _TOWN, duration),
        ]
        try:
            angles = [angle_at_third_g(run.signals) for run in runs]
        except InputError as error:
            self.notes.append(f"slowly increasing steer: {error}")
            return None
        words = "Steering-wheel angle A at 0.3 g, mean of both sides"
        self.figures.append(KeyFigure(name, "mean_angle_at_third_g", sum(angles) / 2, "rad", words))
        return sum(angles) / 2

    def transients(self) -> None:
        """Run ISO 7401's step and single sine at 4 m/s²."""
        angle = self._angle(_TOWN, self._level("step steer and single sine", 4.0, 0.6))
        step = StepSteer(speed_control=self._control, angle=angle, rate=self._rate(_STEP_RATE))
        self._run("step_steer", step, _TOWN, 4.5)
        sine = SingleSine(speed_control=self._control, amplitude=angle)
        self._run("single_sine", sine, _TOWN, 4.5)

    def frequency_responses(self) -> None:
        """Run swept sine and pulse with small angles, beside the linearised response."""
        small = self._angle(_TOWN, 0.4)
        control = self._control
        tests = {
            "swept_sine": (
                SweptSine(speed_control=control, amplitude=small, sweep_time=30.0),
                34.0,
            ),
            "pulse_steer": (PulseSteer(speed_control=control, amplitude=2.0 * small), 6.0),
        }
        frequencies, point = np.array(FREQUENCIES), self.straight_at(_TOWN)
        linear = CorneringModes(self.solver).about(point, held_speed=True)
        exact = {n: linear.response(w[-1], frequencies) for n, w in ANSWERS.items()}
        self.sheets["linear_response"] = response_sheet(frequencies, exact)
        unit, text = "1", "Largest deviation of the yaw response from the linearised one"
        for name, (test, duration) in tests.items():
            signals = self._run(name, test, _TOWN, duration).signals
            found = measured_responses(signals, frequencies)
            self.sheets[f"{name}_response"] = response_sheet(frequencies, found)
            if self.solver.states.sticking:
                continue
            worst = float(np.abs(found["yaw_rate"] / exact["yaw_rate"] - 1.0).max())
            self.figures.append(KeyFigure(name, "from_linear", worst, unit, text))
        if self.solver.states.sticking:
            self.notes.append(
                "linear response: it is that of motions so small that friction sticks "
                f"({', '.join(self.solver.states.sticking)}), which the tests make slide"
            )

    def weave(self) -> None:
        """Run ISO 13674's weave at 100 km/h and 2 m/s²."""
        angle = self._angle(_MOTORWAY, 2.0)
        test = Weave(speed_control=self._control, amplitude=angle, periods=2)
        self._run("weave", test, _MOTORWAY, 11.0)

    def sine_with_dwell(self, third_g: float) -> None:
        """Run the sine with dwell to both sides, from 1.5 A in steps of 0.5 A."""

        def run(words: str, test: SineDwellTest) -> DrivenTest:
            return self._drive(words, test, _TOWN, 5.0)

        shown, figures, notes = dwell_series(
            self.solver.car, third_g, control=self._control, drive=run
        )
        self.sheets["sine_with_dwell"] = sheet_of(shown)
        self.figures += figures
        self.notes += notes

    def fishhook(self, third_g: float) -> None:
        """Run the fishhook with roll-rate feedback at growing speeds until the car tips up."""

        def test_at(speed: float, side: float) -> DrivingTest:
            quick = {"angle": side * 6.5 * third_g, "rate": self._rate(_FISHHOOK_RATE)}
            test = Fishhook(speed_control=self._control, hold=2.0, **quick)
            first = self._drive("fishhook, first turn", test, speed, 3.0)
            settled = test.roll_settled(first.signals)
            hold = max(settled, 0.01) if math.isfinite(settled) else 2.0
            return Fishhook(speed_control=self._control, hold=hold, **quick)

        self._tip_up("fishhook", test_at, 5.0)

    def j_turn(self, third_g: float) -> None:
        """Run the J-turn at growing speeds until the car tips up."""

        def test_at(_: float, side: float) -> DrivingTest:
            angle, rate = side * 8.0 * third_g, self._rate(_J_TURN_RATE)
            return JTurn(speed_control=self._control, angle=angle, rate=rate)

        self._tip_up("j_turn", test_at, 3.5)

    def braking(self) -> None:
        """Brake in a turn of 100 m at 5 m/s², and on the straight from 100 km/h."""
        speed = math.sqrt(self._level("braking in a turn", 5.0, 0.7) * 100.0)
        start = self._near(speed, TurnDemand(speed, "curvature", 0.01))
        torque = self._brake_torque(speed, 4.0)
        angle = float(start.parameters[self.solver.car.table_places("test.steering.angle")[0]])
        test = BrakingInTurn(
            speed_control=self._control, angle=angle, brake_at=0.5, torque=torque, build_up=0.2
        )
        held = {f"test.steering.angle.value_{k}": angle for k in range(8)}
        self._run("braking_in_turn", test, speed, 2.5, (start, held))
        torque, size = self._braked(_MOTORWAY, 6.0)
        straight = StraightBraking(speed_control=self._control, torque=torque)
        duration = _BRAKE_AFTER + _MOTORWAY / (_STOPPING_SHARE * size)
        self._run("straight_braking", straight, _MOTORWAY, duration)
        if not self.solver.car.has_slippery_side:
            self.notes.append("split braking: left out: the tyres' law has no friction")
            return
        self.split_torque, size = self._braked(SPLIT_SPEED, SPLIT_DECELERATION)
        self.split_duration *= SPLIT_DECELERATION / size
        split = SplitBraking(speed_control=self._control, torque=self.split_torque)
        self._run("split_braking", split, SPLIT_SPEED, self.split_duration)

    def crosswind(self) -> None:
        """Let a gust of 1 kN, 0.5 m ahead of the origin, act at 100 km/h."""
        test = Crosswind(speed_control=self._control, force=1000.0, ahead=0.5)
        self._run("crosswind", test, _MOTORWAY, 4.0)

    def coast_down(self) -> None:
        """Let the car roll from 100 km/h without throttle."""
        self._run("coast_down", CoastDown(speed_control=self._control), _MOTORWAY, 10.0)

    def trailer_sway(self) -> None:
        """Turn the steering wheel to and back at 100 km/h, by what a turn of 3 m/s² needs."""
        test = TrailerSway(
            speed_control=self._control,
            amplitude=self._angle(_MOTORWAY, 3.0),
            width=0.4,
            articulation=self.solver.car.vehicle.articulation,
        )
        self._run("trailer_sway", test, _MOTORWAY, 8.0)

    def _tip_up(
        self, name: str, test_at: Callable[[float, float], DrivingTest], duration: float
    ) -> None:
        def drives_at(speed: float) -> Iterator[DrivenTest]:
            words = f"{name.replace('_', ' ')}, {speed / _MILE:.4g} mile/h"
            for side, way in ((1.0, "left"), (-1.0, "right")):
                test = test_at(speed, side)
                yield self._drive(f"{words}, first to the {way}", test, speed, duration)

        run, figures = tip_up_search(self.solver.car, name, drives_at, ROLLOVER_SPEEDS)
        self.sheets[name] = sheet_of(run)
        self.figures += figures

    def _run(
        self,
        name: str,
        test: DrivingTest,
        speed: float,
        duration: float,
        start: tuple[CarPoint, dict[str, float]] | None = None,
    ) -> DrivenTest:
        run = self._drive(name.replace("_", " "), test, speed, duration, start)
        if not run.ended_by:
            found = figures_of(self.solver.car, name, run)
            self.figures += found
            names = {figure.name for figure in found}
            if "initial_speed" in names and "stopping_distance" not in names:
                self.notes.append(
                    f"{name.replace('_', ' ')}: no stopping distance: after {run.end:.3g} s the "
                    f"car still moves at {run.signals.speed[-1]:.2g} m/s"
                )
        self.sheets[name] = sheet_of(run)
        return run

    def _drive(
        self,
        words: str,
        test: DrivingTest,
        speed: float,
        duration: float,
        start: tuple[CarPoint, dict[str, float]] | None = None,
    ) -> DrivenTest:
        self.progress(words, None)
        point, changes = start or (self.straight_at(speed), {})
        run = drive(self.solver.car, test, point, duration, changes)
        if run.ended_by:
            self.notes.append(f"{words}: {run.note()}; recorded until then")
        self.notes.extend(f"{words}: {remark}" for remark in test.conditions(run.signals))
        return run

    def straight_at(self, speed: float) -> CarPoint:
        """Return straight running at a speed [m/s], found once."""
        if speed not in self._straight:
            self._straight[speed] = self.solver.straight(speed)
        return self._straight[speed]

    def _near(self, speed: float, turn: TurnDemand) -> CarPoint:
        """Return a turn, reached from straight running in steps."""

        def part(value: float) -> TurnDemand:
            return TurnDemand(turn.speed, turn.demand, value, turn.acceleration)

        return reached(self.solver, part, turn.value, self.straight_at(speed), steps=5)

    def _level(self, words: str, wanted: float, share: float) -> float:
        """Return the lateral acceleration of a test, a share of the largest steady one at most."""
        level = min(wanted, share * self._limit)
        if level < _JUST_BELOW * wanted:
            self.notes.append(
                f"{words}: at {level:.3g} m/s^2 in place of {wanted:g} m/s^2, since no steady turn "
                f"exceeds {self._limit:.3g} m/s^2"
            )
        return level

    @cached_property
    def _limit(self) -> float:
        """Largest lateral acceleration of a steady turn at 80 km/h [m/s²]."""
        return float(constant_speed(self.solver, _TOWN).values["lateral_acceleration"].max())

    def _angle(self, speed: float, lateral: float) -> float:
        """Return the steering-wheel angle of a steady turn beyond that of straight running."""
        point = self._near(speed, TurnDemand(speed, "lateral_acceleration", lateral))
        ratio = self.solver.car.table_places("test.steering.angle")[0]
        return float(point.parameters[ratio])

    def _brake_torque(self, speed: float, deceleration: float) -> float:
        return self._braked(speed, deceleration)[0]

    def _braked(
        self, speed: float, deceleration: float, parts: tuple[float, ...] = _PARTS_BRAKED
    ) -> tuple[float, float]:
        """Return the torque for a deceleration, or for the part that brakes reach, and that."""

        def turn(size: float) -> TurnDemand:
            return TurnDemand(speed, "steering", 0.0, -size)

        size = parts[0] * deceleration
        try:
            point = reached(self.solver, turn, size, self.straight_at(speed), steps=3)
        except NumericalError:
            if len(parts) == 1:
                raise
            return self._braked(speed, deceleration, parts[1:])
        if size < deceleration:
            self.notes.append(
                f"braking from {speed * 3.6:.3g} km/h: for {size:.3g} m/s^2 in place of "
                f"{deceleration:g} m/s^2, for which wheels lock"
            )
        place = self.solver.car.table_places("test.brake_torque")[0]
        return float(point.parameters[place]), size

    def _rate(self, of_wheel: float) -> float:
        """Return a rate of the steering wheel, or of the front wheels where there is none."""
        return of_wheel if self.solver.car.has_steering_wheel else of_wheel / USUAL_RATIO

    @property
    def _control(self) -> SpeedControl:
        return self.solver.car.control
