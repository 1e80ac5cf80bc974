"""Sine with dwell at growing amplitudes, first to the left and first to the right (FMVSS 126)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from vehicledyn.analyses.handling.test_run import DrivenTest
from vehicledyn.analyses.handling.tested_car import TestedCar
from vehicledyn.results.tables.handling_table import TRUTH, KeyFigure
from vehicledyn.road.manoeuvres.sine_dwell_test import SineDwellTest
from vehicledyn.road.manoeuvres.speed_control import SpeedControl
from vehicledyn.road.standards.sine_dwell import Verdict

_NAME = "sine_with_dwell"
_LARGEST_ANGLE, _CAP = math.radians(270.0), math.radians(300.0)

_RESPONDS_FROM = 5.0
"""Amplitude over A from which the displacement counts [1]."""

_SIDES = {"left": 1.0, "right": -1.0}

Drive = Callable[[str, SineDwellTest], DrivenTest]


@dataclass(frozen=True)
class _Judged:
    """A run at an amplitude over A, what decides it, and whether it passes."""

    run: DrivenTest
    amplitude: float
    verdict: Verdict
    passes: bool


def dwell_series(
    car: TestedCar, third_g: float, *, control: SpeedControl, drive: Drive
) -> tuple[DrivenTest, list[KeyFigure], list[str]]:
    """Drive both series of runs, each until the car fails or the largest amplitude is reached.

    Parameters
    ----------
    car
        The car.
    third_g
        Steering angle A at 0.3 g [rad].
    control
        What drives the car until the throttle is released.
    drive
        Drives one test, which it is given with its name.

    Returns
    -------
    The last run of the side that fails first, the key figures, and notes.
    """
    sides = {side: list(_one_side(car, third_g, side, control, drive)) for side in _SIDES}
    shown = min((runs[-1] for runs in sides.values()), key=lambda run: (run.passes, run.amplitude))
    notes = [
        f"sine with dwell, first to the {side}: at {runs[-1].amplitude:.3g} A the yaw rate never "
        "follows the reversed steering, so that it has no peak and no ratio"
        for side, runs in sides.items()
        if math.isinf(runs[-1].verdict.first_ratio)
    ]
    return shown.run, list(_figures(sides)), notes


def _one_side(
    car: TestedCar, third_g: float, side: str, control: SpeedControl, drive: Drive
) -> Iterator[_Judged]:
    """Yield the runs to one side at growing amplitudes, the first that fails as the last."""
    has_wheel, ahead = car.has_steering_wheel, car.mass_ahead
    for part in _amplitudes(third_g, has_wheel=has_wheel):
        test = SineDwellTest(speed_control=control, amplitude=_SIDES[side] * part * third_g)
        run = drive(f"sine with dwell, {part:.3g} A, first to the {side}", test)
        verdict = test.verdict(run.signals, ahead=ahead, has_wheel=has_wheel)
        responds = part < _RESPONDS_FROM or verdict.is_responsive(car.mass)
        passes = not run.ended_by and verdict.is_stable and responds
        yield _Judged(run, part, verdict, passes)
        if not passes:
            return


def _amplitudes(third_g: float, *, has_wheel: bool) -> list[float]:
    """Return the amplitudes over A: from 1.5 in steps of 0.5 up to 6.5, or to 270 deg, S7.9."""
    largest = 6.5 * third_g
    if has_wheel:
        largest = min(max(largest, _LARGEST_ANGLE), _CAP)
    return [*np.arange(1.5, largest / third_g - 1e-9, 0.5).tolist(), largest / third_g]


def _figures(sides: dict[str, list[_Judged]]) -> Iterator[KeyFigure]:
    """Yield the verdicts, how far the runs went, and the worst of what decides."""
    last = {side: runs[-1] for side, runs in sides.items()}
    everything = [run for runs in sides.values() for run in runs]
    passed = all(run.passes for run in last.values())
    words = "Whether all amplitudes pass, first to the left and first to the right"
    yield KeyFigure(_NAME, "passed", passed, TRUTH, words)
    for side, run in last.items():
        words = f"Whether all amplitudes pass, first to the {side}"
        yield KeyFigure(_NAME, f"passed_{side}", run.passes, TRUTH, words)
        words = f"Largest amplitude over that at 0.3 g that was driven, first to the {side}"
        yield KeyFigure(_NAME, f"last_amplitude_{side}", run.amplitude, "1", words)
    yield KeyFigure(_NAME, "runs", len(everything), "1", "Number of runs to both sides")
    for name, words in (
        ("first", "Largest yaw rate 1 s after the end over its peak, at most 0.35 (S5.2.1)"),
        ("second", "Largest one 1.75 s after the end over its peak, at most 0.20 (S5.2.2)"),
    ):
        ratios = [getattr(run.verdict, f"{name}_ratio") for run in everything]
        known = [ratio for ratio in ratios if math.isfinite(ratio)]
        if known:
            yield KeyFigure(_NAME, f"{name}_yaw_rate_ratio", max(known), "1", words)
    aside = [run.verdict.displacement for run in everything if run.amplitude >= _RESPONDS_FROM]
    known = [displacement for displacement in aside if math.isfinite(displacement)]
    if known:
        words = "Least displacement of the centre of mass 1.07 s after the begin, from 5 A (S5.2.3)"
        yield KeyFigure(_NAME, "lateral_displacement", min(known), "m", words)
