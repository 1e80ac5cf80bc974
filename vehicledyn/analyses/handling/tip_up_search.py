"""Between which entry speeds of a rollover test a car begins to tip up."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from vehicledyn.analyses.handling.test_run import DrivenTest, figures_of
from vehicledyn.analyses.handling.tested_car import TestedCar
from vehicledyn.results.tables.handling_table import TRUTH, KeyFigure

_SHARE = 0.01
"""Part of the speed at which a car tips up that the highest one without lies below it."""

_OF_HEIGHT = frozenset({"two_wheel_height", "two_wheel_lift", "two_wheel_lift_at"})
"""Figures that say nothing of a car which lies on its side or roof."""


def tip_up_search(
    car: TestedCar,
    name: str,
    drives_at: Callable[[float], Iterator[DrivenTest]],
    speeds: tuple[float, ...],
) -> tuple[DrivenTest, list[KeyFigure]]:
    """Drive at growing speeds until the car tips up, then between the last two.

    Parameters
    ----------
    car, name
        The car and the name of its test.
    drives_at
        Drives the test at an entry speed, first to one side, then to the other [m/s].
    speeds
        Growing entry speeds that are tried first [m/s].

    Returns
    -------
    The run at the lowest speed at which the car tips up, else at the last one, with its figures,
    among them the highest speed at which it does not, ``safe_speed``, and ``tip_up_speed``.
    """
    safe, tipped = math.nan, math.nan
    for speed in speeds:
        run, figures, tips = _driven(car, name, drives_at(speed))
        if tips:
            tipped = speed
            break
        safe = speed
    while tipped - safe > _SHARE * tipped:
        middle = 0.5 * (safe + tipped)
        other, found, tips = _driven(car, name, drives_at(middle))
        if tips:
            run, figures, tipped = other, found, middle
        else:
            safe = middle
    words = f"Whether the car tips up at or below {speeds[-1] / 0.44704:g} mile/h"
    figures.append(KeyFigure(name, "tips_up", not math.isnan(tipped), TRUTH, words))
    if not math.isnan(safe):
        words = "Highest entry speed at which it does not"
        figures.append(KeyFigure(name, "safe_speed", safe, "m/s", words))
    if not math.isnan(tipped):
        words = "Lowest entry speed at which it does"
        figures.append(KeyFigure(name, "tip_up_speed", tipped, "m/s", words))
    return run, figures


def _driven(
    car: TestedCar, name: str, runs: Iterator[DrivenTest]
) -> tuple[DrivenTest, list[KeyFigure], bool]:
    """Return the first run in which the car tips up, else the first, and what shows it."""
    shown = None
    for run in runs:
        figures, tips = _judged(car, name, run)
        if tips:
            return run, figures, True
        shown = shown or (run, figures, False)
    if shown is None:
        raise ValueError(f"{name}: no run")
    return shown


def _judged(car: TestedCar, name: str, run: DrivenTest) -> tuple[list[KeyFigure], bool]:
    """Return the figures of a run, and whether the car tips up."""
    figures = figures_of(car, name, run)
    if run.ended_by == f"{car.vehicle.chassis}.overturned":
        return [f for f in figures if f.name not in _OF_HEIGHT], True
    return figures, any(f.name == "two_wheel_lift" and bool(f.value) for f in figures)
