"""A run with half the step, or a part of it: how far key figures move, or extremes and means."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.accuracy_windows import Place, operations_of_step, order_of
from vehicledyn.integrate.channel_ranges import Ranges
from vehicledyn.integrate.judged_quantities import Sizes, figure_errors
from vehicledyn.kernel.engine import Method, Vector

if TYPE_CHECKING:
    from vehicledyn.integrate.accuracy_watch import AccuracyWatch

_CHEAP = 2.5e9
"""Operations of a whole run with half the step that are always worth their price."""

_PART, _LEAST = 0.05, 200
"""Part of an expensive run that is taken again, and the fewest steps of that part."""

_MOST_HALVINGS = 10
"""How often a step is halved to find one that is short enough."""

_FINEST = 256
"""Most parts of a step when the early end of a run is looked at again."""

Samples = list[tuple[Vector, Vector]]


@dataclass(frozen=True)
class Moved:
    """How far half the step leads: error of the worst figure or channel, and steps it took.

    ``goes_on`` says that half the step does not end where the run ended.
    """

    error: float
    worst: str
    extra_steps: int
    goes_on: bool = False


@dataclass
class _Again:
    """A part of a run taken again: ranges of its channels, and samples where they are wanted."""

    ranges: Ranges
    samples: Samples = field(default_factory=list)
    steps: int = 0
    got_through: bool = False
    failed: bool = False


def look_again(
    watch: AccuracyWatch, places: list[Place], errors: Vector, *, ended_early: bool
) -> Moved:
    """Return how far a run moves with half its step.

    Parameters
    ----------
    watch
        The run, what it is judged by, and its ranges.
    places
        Where its windows begin.
    errors
        What they found, shape (n_windows, n_channels).
    ended_early
        Whether an event ended the run before its time.
    """
    taken, grid = max(1, watch.taken - 1), watch.grid
    better = _better_way(watch, ended_early=ended_early)
    power = 2.0 ** order_of(grid.method)
    factor = power / (power - 1.0) if better.method == grid.method else 1.0
    if _is_cheap(watch, better, taken):
        half = _again(watch, watch.places[0], taken, better)
        if ended_early and half.got_through:
            return Moved(np.inf, "", half.steps, goes_on=True)
        own = _Again(watch.ranges, watch.history or [])
        error, name = _apart(watch, own, half)
        return Moved(factor * error, name, half.steps)
    count = min(taken, max(int(_PART * taken), -(-_LEAST // grid.per_interval)))
    largest = np.where([place.index <= taken - count for place in places], errors.max(axis=1), -1.0)
    place = places[int(np.argmax(largest))]
    whole, half = (_again(watch, place, count, way) for way in (_Way(grid.method, 1), better))
    error, name = _ranges_apart(watch, whole, half)
    usual = errors.mean(axis=0)
    if usual.max() > factor * error:
        error, name = float(usual.max()) / factor, _named(watch, int(np.argmax(usual)))
    return Moved(factor * error, name, whole.steps + half.steps)


def ends_without_reason(watch: AccuracyWatch) -> bool:
    """Return whether the event that ended a run early fails to come with a finer step.

    Only the last part of the run is taken again, and one interval behind it: a twelfth on average.
    """
    before = next(p for p in reversed(watch.places) if p.index < max(1, watch.taken - 2))
    count = max(1, watch.taken - 1 - before.index) + 1
    return _again(watch, before, count, _better_way(watch, ended_early=True)).got_through


def settled_step(watch: AccuracyWatch, allowed: float) -> tuple[float | None, int]:
    """Return the longest of the halved steps that half of it does not contradict [s].

    None where that cannot be found cheaply; and the steps it took.
    """
    taken, grid, spent = max(1, watch.taken - 1), watch.grid, 0
    before: _Again | None = None
    for halvings in range(1, _MOST_HALVINGS + 1):
        way = _Way(grid.method, 2**halvings)
        if not _is_cheap(watch, way, taken):
            break
        again = _again(watch, watch.places[0], taken, way)
        spent += again.steps
        if before is not None and _apart(watch, before, again)[0] <= allowed:
            return 2.0 * grid.step / way.divided, spent
        before = again
    return None, spent


@dataclass(frozen=True)
class _Way:
    """How a part of a run is taken again: the method, and the steps in one of the run's."""

    method: int
    divided: int


def _better_way(watch: AccuracyWatch, *, ended_early: bool) -> _Way:
    """Return a more accurate way: half the step, or a method of higher order.

    What ended a run early is taken again with a step that is known to be stable.
    """
    method, step = watch.grid.method, watch.grid.step
    if ended_early:
        stable = watch.stable_step()
        most = _FINEST if stable is None else math.ceil(step / stable)
        return _Way(method, max(2, min(_FINEST, most)))
    if method == Method.SYMPLECTIC_EULER:
        return _Way(Method.RK4, 1)
    return _Way(method, 2)


def _is_cheap(watch: AccuracyWatch, way: _Way, count: int) -> bool:
    steps = way.divided * count * watch.grid.per_interval
    operations = steps * operations_of_step(watch.kernel, way.method)
    return watch.kernel.backend == "compiled" and operations <= _CHEAP


def _again(watch: AccuracyWatch, place: Place, count: int, way: _Way) -> _Again:
    """Take some intervals again from a place."""
    from vehicledyn.integrate.fixed_step import run_fixed
    from vehicledyn.integrate.task import Task

    kernel, grid, channels = watch.kernel, watch.grid, watch.judged.channels
    again = _Again(Ranges.of(kernel.equations, channels))

    def take(times: Vector, states: Vector, unknowns: Vector, outputs: Vector) -> None:
        values = outputs[:, channels]
        again.ranges.take(values)
        if watch.history is not None:
            again.samples.append((times.copy(), values))

    own = (place.state.copy(), place.unknowns.copy())
    task = Task(kernel, place.time, grid.interval, count, *own, take, _silent, _silent)
    with np.errstate(all="ignore"):
        try:
            done = run_fixed(task, "", way.method, grid.step / way.divided, watched=False)
            again.got_through, again.steps = done.ended_by is None, done.steps
        except NumericalError:
            again.failed = True
    return again


def _apart(watch: AccuracyWatch, own: _Again, other: _Again) -> tuple[float, str]:
    """Return the error of the worst key figure, or channel where there are no figures."""
    make = watch.judged.figures
    if make is None or watch.history is None or own.failed or other.failed:
        return _ranges_apart(watch, own, other)
    with np.errstate(all="ignore"):
        figures = [
            make(*(np.concatenate(parts) for parts in zip(*again.samples, strict=True)))
            for again in (own, other)
        ]
    sizes = Sizes.of(watch.kernel.equations, watch.judged.channels, other.ranges)
    errors = figure_errors(figures[0], figures[1], sizes)
    if not errors:
        return _ranges_apart(watch, own, other)
    worst = max(errors, key=lambda name: errors[name])
    return errors[worst], f"'{worst}'"


def _ranges_apart(watch: AccuracyWatch, own: _Again, other: _Again) -> tuple[float, str]:
    """Return the error of the worst channel's extremes and mean."""
    if own.failed or other.failed:
        return np.inf, _named(watch, 0)
    distance = own.ranges.distance(other.ranges, watch.ranges.scales())
    worst = int(np.argmax(distance))
    return float(distance[worst]), _named(watch, worst)


def _named(watch: AccuracyWatch, number: int) -> str:
    return f"'{watch.kernel.equations.channels[watch.judged.channels[number]].name}'"


def _silent(*_: object) -> None:
    """Tell nobody."""
