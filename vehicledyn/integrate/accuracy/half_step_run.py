"""A run with half the step, or a part of it: how far key figures move, or extremes and means."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.accuracy.curves import curves_apart
from vehicledyn.integrate.accuracy.monitored_run import KINETIC, MethodAndStep, MonitoredRun
from vehicledyn.integrate.accuracy.windows import WindowStart, is_cheap, may_be_repeated, order_of
from vehicledyn.integrate.channel_ranges import Ranges
from vehicledyn.integrate.estimated_accuracy import ENERGY
from vehicledyn.integrate.judged_quantities import EnergyBalance, FigureSizes, figure_errors
from vehicledyn.integrate.kept_samples import KeptSamples
from vehicledyn.kernel.engine import Method, Vector

_PART, _LONG_PART, _LEAST, _LEAST_AT_START = 0.006, 0.1, 200, 100
"""Parts of an expensive run that are taken again, and the fewest steps of such a part and of one
that begins with the run.
"""

_DOUBT, _DEAR = 0.005, 20.0
"""Error in the short part from which a longer one is taken, all of a run that costs no more than
so many times what is cheap."""

_STILL, _ROUNDING = 0.1, 1e-9
"""Part of the kinetic energy between samples below which samples meet it standing still, and the
part of the largest energy that exchanges are no smaller than.
"""

_FINEST = 256
"""Most parts of a step when the early end of a run is looked at again."""

_LOST = 0.3
"""Energy from nowhere that no second look can explain, as a part of what is exchanged."""

MOVED = 0.04
"""Error that a second look may find without a warning."""

_ELSEWHERE = 0.1
"""Distance of curves, in parts of their ranges, from which on they count: above what transients
that fade leave, and far below that of a run that goes another way."""

_DRIFTED = 0.1 * MOVED
"""Energy from nowhere that asks for a second look, as a part of what is exchanged: motions may
amplify what goes wrong tenfold, and much more where they drive errors apart."""


@dataclass(frozen=True)
class Moved:
    """How far half the step leads: error of the worst figure or channel, and steps it took.

    ``goes_on`` says that half the step does not end where the run ended, ``failure`` why a run
    with half the step cannot go on.
    """

    error: float
    worst: str
    extra_steps: int
    goes_on: bool = False
    failure: str = ""


@dataclass
class RepeatedPart:
    """A part of a run taken again: ranges of its channels, and samples where they are wanted.

    ``last`` are the judged channels at its end, ``failure`` says why it could not be taken there.
    """

    ranges: Ranges
    samples: KeptSamples | None = None
    steps: int = 0
    got_through: bool = False
    failure: str = ""
    last: Vector = field(default_factory=lambda: np.zeros(0))


def look_again(
    watch: MonitoredRun, places: list[WindowStart], errors: Vector, *, ended_early: bool
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
    better = _better_way(watch, ended_early=ended_early)
    if may_be_taken(watch, better, intervals_of(watch)):
        return _all_again(watch, better, ended_early=ended_early)
    short = _part_again(watch, places, errors, better, _PART)
    if short.error <= _DOUBT:
        return short
    if may_be_taken(watch, better, intervals_of(watch), times=_DEAR):
        longer = _all_again(watch, better, ended_early=ended_early)
    else:
        longer = _part_again(watch, places, errors, better, _LONG_PART)
    return replace(longer, extra_steps=longer.extra_steps + short.extra_steps)


def look_at_start(watch: MonitoredRun, place: WindowStart) -> Moved:
    """Return how far the first part of a run moves with half its step, and what is left of that.

    What a start sets off may be coarse as long as it fades: beside extremes and means, the channels
    at the end of the part count, as parts of their ranges.
    """
    better = _better_way(watch, ended_early=False)
    own, half = _both(watch, place, _length_of_part(watch, _PART, _LEAST_AT_START), better)
    error, name = _ranges_apart(watch, own, half)
    if math.isfinite(error):
        left = _ends_apart(watch, own, half)
        worst = int(np.argmax(left))
        if left[worst] > error:
            error, name = float(left[worst]), f"'{watch.names[worst]}'"
    return Moved(_richardson(watch, better) * error, name, own.steps + half.steps)


def _all_again(watch: MonitoredRun, better: MethodAndStep, *, ended_early: bool) -> Moved:
    """Return how far the figures of the whole run move."""
    half = taken_again(watch, watch.places[0], intervals_of(watch), better)
    if ended_early and half.got_through:
        return Moved(np.inf, "", half.steps, goes_on=True)
    own = RepeatedPart(watch.ranges, watch.kept)
    error, name = apart(watch, own, half)
    return Moved(_richardson(watch, better) * error, name, half.steps, failure=half.failure)


def _part_again(
    watch: MonitoredRun,
    places: list[WindowStart],
    errors: Vector,
    better: MethodAndStep,
    share: float,
) -> Moved:
    """Return how far the channels move in a part of the run, where windows differ most."""
    count = _length_of_part(watch, share, _LEAST)
    latest = intervals_of(watch) - count
    largest = np.where([place.index <= latest for place in places], errors.max(axis=1), -1.0)
    own, half = _both(watch, places[int(np.argmax(largest))], count, better)
    factor = _richardson(watch, better)
    error, name = _ranges_apart(watch, own, half)
    usual = errors.mean(axis=0)
    if usual.max() > factor * error:
        error, name = float(usual.max()) / factor, f"'{watch.names[int(np.argmax(usual))]}'"
    failure = "" if own.failure else half.failure
    return Moved(factor * error, name, own.steps + half.steps, failure=failure)


def _length_of_part(watch: MonitoredRun, share: float, least: int) -> int:
    """Return the intervals of a part of the run, which has so many steps at least."""
    taken = intervals_of(watch)
    return min(taken, max(int(share * taken), -(-least // watch.grid.per_interval)))


def _both(
    watch: MonitoredRun, place: WindowStart, count: int, better: MethodAndStep
) -> tuple[RepeatedPart, RepeatedPart]:
    """Return a part of the run as it was, and taken again in a better way."""
    own = _known_part(watch, place, count)
    if own is None:
        own = taken_again(watch, place, count, MethodAndStep(watch.grid.method, watch.grid.step))
    return own, taken_again(watch, place, count, better)


def _known_part(watch: MonitoredRun, place: WindowStart, count: int) -> RepeatedPart | None:
    """Return a part of the run from its own samples, None if they are not kept."""
    if watch.kept is None:
        return None
    values = watch.kept.values[place.index :][: count + 1]
    again = RepeatedPart(Ranges.of(watch.equations, watch.judged.channels), last=values[-1])
    again.ranges.take(values)
    return again


def _richardson(watch: MonitoredRun, better: MethodAndStep) -> float:
    """Return the error of the run in parts of how far a better way leads elsewhere."""
    power = (watch.grid.step / better.step) ** order_of(watch.grid.method)
    return power / (power - 1.0) if better.method == watch.grid.method else 1.0


def ends_without_reason(watch: MonitoredRun) -> bool:
    """Return whether the event that ended a run early fails to come with a finer step.

    Only the last part of the run is taken again, and one interval behind it: a twelfth on average.
    """
    before = next(p for p in reversed(watch.places) if p.index < max(1, watch.taken - 2))
    count = max(1, watch.taken - 1 - before.index) + 1
    better = _better_way(watch, ended_early=True)
    return taken_again(watch, before, count, better).got_through


def _better_way(watch: MonitoredRun, *, ended_early: bool) -> MethodAndStep:
    """Return a more accurate way: half the step, or a method of higher order.

    What ended a run early is taken again with a step that is known to be stable.
    """
    method, step = watch.grid.method, watch.grid.step
    if ended_early:
        stable = watch.stable_step()
        most = _FINEST if stable is None else math.ceil(step / stable)
        return MethodAndStep(method, step / max(2, min(_FINEST, most)))
    if method == Method.SYMPLECTIC_EULER:
        return MethodAndStep(Method.RK4, step if watch.divided == 2 else step / watch.divided)
    return MethodAndStep(method, step / watch.divided)


def intervals_of(watch: MonitoredRun) -> int:
    """Return how many sampling intervals the run has taken."""
    return max(1, watch.taken - 1)


def may_be_taken(
    watch: MonitoredRun, way: MethodAndStep, count: int, *, times: float = 1.0
) -> bool:
    """Return whether so many intervals may be taken again in some way at any time.

    They may cost so many ``times`` what is cheap.
    """
    return is_cheap(watch.kernel, way.method, count * watch.grid.interval / way.step / times)


def taken_again(
    watch: MonitoredRun, place: WindowStart, count: int, way: MethodAndStep
) -> RepeatedPart:
    """Take some intervals again from a place."""
    channels = watch.judged.channels
    kept = watch.judged.kept(count) if watch.kept is not None else None
    again = RepeatedPart(Ranges.of(watch.equations, channels), kept)
    again.ranges.likes = watch.ranges.likes

    def take(times: Vector, states: Vector, unknowns: Vector, outputs: Vector) -> None:
        values = outputs[:, channels] if kept is None else kept.take(times, outputs)
        again.ranges.take(values)
        again.last = values[-1]

    with np.errstate(all="ignore"):
        try:
            done = watch.rerun(place, watch.grid.interval, count, way, take)
            again.got_through, again.steps = done.ended_by is None, done.steps
        except NumericalError as error:
            again.failure = str(error)
    return again


def apart(
    watch: MonitoredRun, own: RepeatedPart, other: RepeatedPart, *, scales: Vector | None = None
) -> tuple[float, str]:
    """Return the error of the worst key figure, or channel where no figure is of the motion.

    The balance of the energy counts as one, but stands for no motion: a large mass hides in it what
    small ones do. Curves that go another way count, too, where figures are their extremes, or none
    is of the motion. Channels are measured by ``scales`` (n_channels,), by those of the run if
    there are none.
    """
    make = watch.judged.figures
    samples = [again.samples for again in (own, other) if again.samples and not again.failure]
    if make is None or len(samples) < 2:
        return _ranges_apart(watch, own, other, scales)
    with np.errstate(all="ignore"):
        figures = [make(part.times, part.values) for part in samples]
        balances = [balance_of(watch, part) for part in samples]
    sizes = FigureSizes.of(watch.equations, watch.judged.channels, other.ranges)
    errors = figure_errors(figures[0], figures[1], sizes)
    shown = {name.rpartition(".")[0] for name in errors} if errors else set(watch.names)
    found = [] if errors else [_ranges_apart(watch, own, other, scales)]
    if balances[0] is not None and balances[1] is not None:
        errors[ENERGY] = balances[0].distance(balances[1])
    found += [(error, f"'{name}'") for name, error in errors.items()]
    worst = max(found, key=lambda one: one[0])
    if worst[0] > MOVED:
        return worst
    values = [part.values for part in samples]
    return max(worst, _curves_elsewhere(watch, shown, values, scales), key=lambda one: one[0])


def _curves_elsewhere(
    watch: MonitoredRun, shown: set[str], values: list[Vector], scales: Vector | None
) -> tuple[float, str]:
    """Return the distance of the curves by name that lie farthest apart, none where it is small."""
    columns = [k for k, name in enumerate(watch.names) if name in shown]
    if not columns or values[0].shape != values[1].shape:
        return 0.0, ""
    span = watch.ranges.scales() if scales is None else scales
    distance = curves_apart(*[part[:, columns] for part in values]) / span[columns]
    worst = int(np.argmax(distance))
    if not distance[worst] > _ELSEWHERE:
        return 0.0, ""
    return float(distance[worst]), f"'{watch.names[columns[worst]]}'"


def energy_is_off(watch: MonitoredRun) -> bool:
    """Return whether the balance of the energy, as far as the samples tell, asks for a look."""
    if watch.kept is None or not may_be_repeated(watch.kernel, watch.grid):
        return False
    with np.errstate(all="ignore"):
        rough = balance_of(watch, watch.kept, rough=True)
        if rough is None or rough.part <= _DRIFTED:
            return False
        if rough.error > rough.uncertainty + _DRIFTED * rough.exchanged:
            return True
        found = balance_of(watch, watch.kept) if rough.part > 0.75 * MOVED else None
    return found is not None and found.part > MOVED


def lost_energy(watch: MonitoredRun) -> float:
    """Return which part of the energy exchanged a run loses or gains that is too long to repeat.

    Zero where that is a small part, or may come from what lies between the samples.
    """
    if watch.kept is None or may_be_repeated(watch.kernel, watch.grid):
        return 0.0
    with np.errstate(all="ignore"):
        found = balance_of(watch, watch.kept)
        if found is None or not found.error > found.uncertainty + _LOST * found.exchanged:
            return 0.0
    return found.part


def balance_of(
    watch: MonitoredRun, samples: KeptSamples, *, rough: bool = False
) -> EnergyBalance | None:
    """Return the balance of the energy, None where there is none or it says nothing.

    Symplectic Euler's places and velocities belong to instants half a step apart. Samples that meet
    the motion where it stands still show no exchange; what is exchanged is above rounding.
    """
    make = watch.judged.balance
    if make is None or watch.grid.method == Method.SYMPLECTIC_EULER:
        return None
    if KINETIC in watch.names and watch.kept is not None:
        seen = float(watch.kept.values[:, watch.names.index(KINETIC)].max(initial=0.0))
        if seen < _STILL * watch.between:
            return None
    found = make(samples.times, samples.values, rough=rough)
    unit = watch.ranges.known.get("J")
    if found is None or unit is None:
        return found
    least = _ROUNDING * float(watch.ranges.likes[unit])
    return found._replace(exchanged=max(found.exchanged, least))


def _ranges_apart(
    watch: MonitoredRun, own: RepeatedPart, other: RepeatedPart, scales: Vector | None = None
) -> tuple[float, str]:
    """Return the error of the worst channel's extremes and mean."""
    if own.failure or other.failure:
        return np.inf, f"'{watch.names[0]}'"
    distance = own.ranges.distance(
        other.ranges, watch.ranges.scales() if scales is None else scales
    )
    worst = int(np.argmax(distance))
    return float(distance[worst]), f"'{watch.names[worst]}'"


def _ends_apart(watch: MonitoredRun, own: RepeatedPart, other: RepeatedPart) -> Vector:
    """Return how far two ways lie apart at their end, shape (n_channels,), as parts of ranges."""
    with np.errstate(all="ignore"):
        distance = np.abs(own.last - other.last) / watch.ranges.scales()
    same = np.isnan(own.last) & np.isnan(other.last)
    return np.where(same, 0.0, np.nan_to_num(distance, nan=np.inf, posinf=np.inf))
