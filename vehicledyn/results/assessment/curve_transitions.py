"""Comfort on curve transitions, P_CT of EN 12299: the part of passengers who feel disturbed.

P_CT = 100 (max(A |ÿ| + B |y⃛| - C, 0) + (D |ϑ̇|)^E) in per cent, from the largest of means over 1 s:
of the lateral acceleration ÿ in the plane of the floor, gravity included, between the begin of
the transition and 1.6 s after its end; of its jerk y⃛, the difference of two such means 1 s apart,
between 1 s before the begin and the end; and of the roll rate ϑ̇ between begin and end. All are
low-pass filtered at 2 Hz first.

A transition is where the curvature of the track changes; those that leave a curve do not count.

References
----------
EN 12299:2009, comfort on curve transitions. Its numbers A to E are recalled, not read; they
agree with the form in use for tilting trains, which is recalled too: 28.54 ÿ + 20.69 y⃛ - 11.1 +
0.185 ϑ̇^2.283 standing and 8.97 ÿ + 9.68 y⃛ - 5.9 + 0.120 ϑ̇^1.626 seated, ϑ̇ in degrees a second.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vehicledyn.results.assessment.even_samples import EvenSamples
from vehicledyn.results.assessment.filters import butterworth, filtered_section
from vehicledyn.results.assessment.signal import BLOCK, Floats, Signal
from vehicledyn.results.assessment.sliding import integral_between

SHORTEST = 2.0
"""Duration of a transition that the standard asks for [s]."""

_CUT_OFF, _ORDER = 2.0, 4
_MEAN, _BEFORE, _AFTER = 1.0, 1.0, 1.6
_STEEPNESS = 1e-4
_GAP = 0.2


@dataclass(frozen=True)
class Passenger:
    """Constants A [s²/m], B [s³/m], C [1], D [s/rad] and E [1] of the formula."""

    acceleration: float
    jerk: float
    threshold: float
    roll: float
    exponent: float

    def disturbed(self, acceleration: float, jerk: float, roll_rate: float) -> float:
        """Return P_CT [%] for the largest values [m/s², m/s³, rad/s]."""
        lateral = self.acceleration * acceleration + self.jerk * jerk - self.threshold
        return 100.0 * (max(lateral, 0.0) + math.pow(self.roll * roll_rate, self.exponent))


STANDING = Passenger(0.2854, 0.2069, 0.111, 3.64, 2.283)
SEATED = Passenger(0.0897, 0.0968, 0.059, 0.916, 1.626)


@dataclass(frozen=True)
class Transition:
    """A stretch of time in which the curvature grows or changes its side [s]."""

    begin: float
    end: float


@dataclass(frozen=True)
class TransitionComfort:
    """Comfort of one floor on one transition.

    ``begin`` and ``end`` are those of the transition [s]; ``acceleration``, ``jerk`` and
    ``roll_rate`` the largest means [m/s², m/s³, rad/s]; ``standing`` and ``seated`` P_CT [%].
    """

    name: str
    begin: float
    end: float
    acceleration: float
    jerk: float
    roll_rate: float
    standing: float
    seated: float


def find_transitions(time: Signal, curvature: Signal, distance: Signal) -> list[Transition]:
    """Return where a vehicle enters curves; what the samples do not hold whole is left out.

    Parameters
    ----------
    time
        Even samples, shape (n,) [s].
    curvature
        Of the track, shape (n,) [1/m].
    distance
        Way along the track, not falling, shape (n,) [m].
    """
    largest = max(curvature.highest()[1], -curvature.smallest())
    found: list[Transition] = []
    if largest <= 0.0:
        return found
    changes = _changes(curvature, distance, _STEEPNESS * largest)
    for first, last in _runs(changes, round(_GAP / (time.at(1) - time.at(0)))):
        if first == 0 or last == time.count - 1:
            continue
        before, after = curvature.at(first), curvature.at(last)
        if abs(after) > abs(before) or before * after < 0.0:
            found.append(Transition(time.at(first), time.at(last)))
    return found


def assess_transitions(
    name: str, samples: EvenSamples, transitions: list[Transition]
) -> Iterator[TransitionComfort]:
    """Yield the comfort of a floor with channels "name.lateral" and "name.roll_rate".

    Transitions of which the run does not hold all that counts are left out.
    """
    low_pass = butterworth(_CUT_OFF, _ORDER)
    lateral, roll = (
        filtered_section(
            samples.channels[f"{name}.{word}"], samples.step, low_pass, slice(0, samples.time.count)
        )
        for word in ("lateral", "roll_rate")
    )
    half, run_begin, run_end = 0.5 * _MEAN, samples.time.at(0), samples.time.at(-1)
    for transition in transitions:
        begin, end = transition.begin, transition.end
        if begin - _BEFORE - _MEAN < run_begin or end + _AFTER + half > run_end:
            continue
        step = samples.step
        acceleration = _largest_mean(samples, lateral, _span(begin, end + _AFTER, step), [0.0])
        change = _largest_mean(samples, lateral, _span(begin - _BEFORE, end, step), [half, -half])
        rate = _largest_mean(samples, roll, _span(begin, end, step), [0.0])
        worst = (acceleration, change / _MEAN, rate)
        yield TransitionComfort(
            name, begin, end, *worst, STANDING.disturbed(*worst), SEATED.disturbed(*worst)
        )


def _span(begin: float, end: float, step: float) -> Floats:
    return np.linspace(begin, end, max(2, 1 + round((end - begin) / step)))


def _largest_mean(
    samples: EvenSamples, values: Signal, middles: Floats, shifts: list[float]
) -> float:
    """Return the largest mean over 1 s about instants, or difference of two shifted ones."""
    largest, start = 0.0, samples.time.at(0)
    for part in np.array_split(middles, -(-len(middles) // BLOCK)):
        reach = max(shifts) + _MEAN
        first = max(int((part[0] - reach - start) / samples.step) - 2, 0)
        last = int((part[-1] + reach - start) / samples.step) + 3
        time, own = samples.time.part(first, last), values.part(first, last)
        means = [_means(time, own, part + shift) for shift in shifts]
        difference = means[0] - means[1] if means[1:] else means[0]
        largest = max(largest, float(np.abs(difference).max()))
    return largest


def _means(time: Floats, values: Floats, middles: Floats) -> Floats:
    """Return means over 1 s about instants, shape (n,)."""
    ahead = integral_between(time, values, middles + 0.5 * _MEAN)
    return np.asarray((ahead - integral_between(time, values, middles - 0.5 * _MEAN)) / _MEAN)


def _changes(curvature: Signal, distance: Signal, steepest: float) -> Iterator[int]:
    """Yield the steps between samples in which the curvature changes, in their order."""
    for start in range(0, curvature.count - 1, BLOCK):
        stop = start + BLOCK + 1
        apart = np.abs(np.diff(curvature.part(start, stop)))
        changes = apart > steepest * np.diff(distance.part(start, stop))
        yield from (start + np.flatnonzero(changes)).tolist()


def _runs(steps: Iterator[int], gap: int) -> Iterator[tuple[int, int]]:
    """Yield first and last sample of runs of changing steps; shorter gaps do not part them."""
    first = last = -1
    for step in steps:
        if last >= 0 and step - last > gap + 1:
            yield first, last + 1
            first = step
        first, last = (step if first < 0 else first), step
    if last >= 0:
        yield first, last + 1
