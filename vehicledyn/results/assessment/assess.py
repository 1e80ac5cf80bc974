"""The assessment of a run: safety of wheels and axles, comfort, vibration, wear, remarks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from vehicledyn.results.assessment.comfort import (
    DIRECTIONS,
    WINDOW,
    WINDOWS,
    Comfort,
    assess_comfort,
)
from vehicledyn.results.assessment.curve_transitions import (
    SHORTEST,
    TransitionComfort,
    assess_transitions,
    find_transitions,
)
from vehicledyn.results.assessment.even_samples import EvenSamples, LazyChannels, even_samples
from vehicledyn.results.assessment.running_behaviour import (
    DIRECTIONS as ASIDE_AND_UP,
)
from vehicledyn.results.assessment.running_behaviour import (
    BodyAcceleration,
    assess_acceleration,
)
from vehicledyn.results.assessment.running_safety import (
    CUT_OFF,
    AxleSafety,
    WheelSafety,
    assess_axle,
    assess_wheel,
    static_load,
    static_samples,
)
from vehicledyn.results.assessment.running_safety import WINDOW as WAY
from vehicledyn.results.assessment.signal import BLOCK, Floats, Signal, signal_of, stored
from vehicledyn.results.assessment.stability import WINDOW as STRETCH
from vehicledyn.results.assessment.stability import AxleStability, assess_stability
from vehicledyn.results.assessment.subjects import Subjects, find_subjects
from vehicledyn.results.assessment.vibration import Vibration, assess_vibration
from vehicledyn.results.assessment.wear import WheelWear, assess_wear

FASTEST_RATE = 200e3
"""Samples a second above which filters over seconds would take gigabytes [Hz]."""

SLOWEST_RATE = 100.0
"""Samples a second below which nothing is filtered: five a period of the low-pass filter [Hz]."""
COMFORT_RATE = 200.0
"""Samples a second that EN 12299 asks for [Hz]."""

_ROUNDING = 1e-6


@dataclass
class Assessment:
    """Key figures and verdicts of a run.

    ``begin`` and ``end`` limit the section that was assessed [s]; ``way`` is the distance run in
    it, None if unknown [m]; ``rate`` the samples a second [Hz]. ``remarks`` say what was left out
    and why.
    """

    begin: float
    end: float
    rate: float
    way: float | None = None
    wheels: list[WheelSafety] = field(default_factory=list)
    axles: list[AxleSafety] = field(default_factory=list)
    stability: list[AxleStability] = field(default_factory=list)
    behaviour: list[BodyAcceleration] = field(default_factory=list)
    comfort: list[Comfort] = field(default_factory=list)
    vibration: list[Vibration] = field(default_factory=list)
    transitions: list[TransitionComfort] = field(default_factory=list)
    wear: list[WheelWear] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)


def assess(
    time: Any,
    channels: Mapping[str, Any],
    units: Mapping[str, str],
    *,
    begin: float | None = None,
    end: float | None = None,
    vibration: bool = False,
) -> Assessment:
    """Return the assessment of a run, or of a section of it.

    Parameters
    ----------
    time
        Not falling, an array of n values [s] or what slices like one, as datasets of files do.
    channels
        The like by name, SI; a block of one is read at a time.
    units
        SI units by name.
    begin, end
        Limits of the section; the whole run if absent [s].
    vibration
        Whether vibration at sensors is assessed by ISO 2631-1 as well.

    Raises
    ------
    InputError
        If the section holds fewer than two samples.
    """
    subjects = find_subjects({name: units[name] for name in channels})
    whole = LazyChannels(
        [name for name in channels if _is_finite(channels[name])], channels.__getitem__
    )
    samples = even_samples(time, whole, begin=begin, end=end)
    section = samples.time.section(samples.kept)
    found = Assessment(section.at(0), section.at(-1), samples.rate)
    for name in sorted(set(subjects.channels(channels)) - set(whole)):
        found.remarks.append(f"{name} holds values that are not finite; what needs it is left out")
    distance = _distance(subjects, samples)
    found.way = None if distance is None else distance.at(-1) - distance.at(0)
    _assess_wear(found, subjects, samples, distance)
    if samples.rate < SLOWEST_RATE * (1.0 - _ROUNDING):
        found.remarks.append(
            f"forces and comfort are left out: {samples.rate:.4g} samples a second are too few for "
            f"a filter at {CUT_OFF:g} Hz; set output.interval to 5 ms, {1e3 / SLOWEST_RATE:g} ms "
            "at most"
        )
        return found
    if samples.rate > FASTEST_RATE:
        found.remarks.append(
            f"forces and comfort are left out: the section has {samples.rate:.3g} samples a "
            f"second, more than {FASTEST_RATE:g}; take a longer output.interval"
        )
        return found
    _assess_safety(found, subjects, samples, distance)
    _assess_ride(found, subjects, samples)
    if vibration:
        found.vibration.extend(assess_vibration(s, samples) for s in _sensors(subjects, samples))
    _assess_transitions(found, subjects, samples, distance)
    return found


def _is_finite(column: Any) -> bool:
    return all(bool(np.isfinite(block).all()) for block in signal_of(column).blocks())


def _distance(subjects: Subjects, samples: EvenSamples) -> Signal | None:
    """Return the way from the start of the run at the section's samples; None if unknown.

    All bodies of a vehicle go the same way; coordinates relative to another body hardly move. So
    the channel that goes farthest gives it, arc coordinates along the track before others.
    """
    known = [name for name in subjects.ways if name in samples.channels]
    along = [name for name in known if name.endswith(".track_position")]
    lengths = {
        name: sum(float(part.sum()) for part in _steps(samples, name, _moved))
        for name in along or known
    }
    speeds = [name for name in subjects.speeds if name in samples.channels]
    if lengths:
        farthest = _steps(samples, max(lengths, key=lambda name: lengths[name]), _moved)
    elif speeds:
        step = samples.step
        farthest = _steps(
            samples, speeds[0], lambda speed: step * np.abs(0.5 * (speed[:-1] + speed[1:]))
        )
    else:
        return None
    return stored(_sums(farthest)).section(samples.kept)


def _moved(way: Floats) -> Floats:
    return np.asarray(np.abs(np.diff(way)))


def _steps(samples: EvenSamples, name: str, length: Callable[[Floats], Floats]) -> Iterator[Floats]:
    """Yield how far it is from sample to sample, block by block."""
    channel = samples.channels[name]
    for start in range(0, channel.count - 1, BLOCK):
        yield length(channel.part(start, start + BLOCK + 1))


def _sums(steps: Iterator[Floats]) -> Iterator[Floats]:
    """Yield 0 and the sums of the steps so far, block by block."""
    last = np.zeros(1)
    for number, part in enumerate(steps):
        whole = np.cumsum(np.concatenate([last, part]))
        yield whole[1:] if number else whole
        last = whole[-1:]


def _assess_safety(
    found: Assessment, subjects: Subjects, samples: EvenSamples, distance: Signal | None
) -> None:
    if subjects.axles and distance is None:
        found.remarks.append(
            "sliding means over the track are left out: no channel gives the distance run; keep "
            "a 'track_position', a coordinate 'x' or a 'forward_speed'"
        )
    elif subjects.axles and found.way is not None and found.way < WAY:
        found.remarks.append(
            f"sliding means over {WAY:g} m of track are left out: only {found.way:.3g} m were run"
        )
        distance = None
    bends = [name for name in subjects.bends if name in samples.channels]
    curvature = samples.channels[bends[0]] if bends else None
    curved: list[str] = []
    for axle, all_wheels in subjects.axles.items():
        wheels = tuple(wheel for wheel in all_wheels if _has(samples, wheel, "Y", "Q"))
        even = static_samples(samples, axle, curvature)
        static = static_load(samples, wheels, even) if wheels else 0.0
        if even is None and _bends(samples, axle, curvature):
            curved.append(axle)
        if static <= 0.0:
            if wheels:
                found.remarks.append(f"{axle} carries no load: its forces are left out")
            continue
        for wheel in wheels:
            safety = assess_wheel(wheel, samples, distance, static)
            found.wheels.append(safety)
            if safety.lifted > 0.0:
                found.remarks.append(
                    f"{wheel} has no load for {100.0 * safety.lifted:.2g} % of the time: its Y/Q "
                    "is left out"
                )
        if distance is not None and len(wheels) == 2:
            total = assess_axle(axle, samples, distance, static, wheels)
            found.axles.extend([] if total is None else [total])
            sways = assess_stability(axle, samples, distance, static, wheels)
            found.stability.extend([] if sways is None else [sways])
    if curved:
        found.remarks.append(
            f"static loads of {', '.join(curved)} are medians of the section, as these axles are "
            "on straight, level track for less than 0.2 s: let the run begin there"
        )
    if found.axles and not found.stability:
        found.remarks.append(
            f"instability is left out: {found.way:.3g} m are shorter than a window of {STRETCH:g} m"
        )


def _bends(samples: EvenSamples, axle: str, curvature: Signal | None) -> bool:
    bend = samples.channels.get(f"{axle}.curvature", curvature)
    return bend is not None and any(bool(np.any(block)) for block in bend.blocks())


def _assess_ride(found: Assessment, subjects: Subjects, samples: EvenSamples) -> None:
    sensors = _sensors(subjects, samples)
    if not sensors:
        if subjects.axles:
            found.remarks.append("comfort is left out: there is no accelerometer")
        return
    found.behaviour.extend(
        assess_acceleration(sensor, direction, samples)
        for sensor in sensors
        for direction in ASIDE_AND_UP
        if _has(samples, sensor, direction)
    )
    if samples.duration < WINDOW * (1.0 - _ROUNDING):
        found.remarks.append(
            f"comfort is left out: {samples.duration:.3g} s are shorter than a window of "
            f"{WINDOW:g} s; set a longer duration"
        )
        return
    found.comfort.extend(assess_comfort(sensor, samples) for sensor in sensors)
    found.remarks.extend(_comfort_remarks(found.comfort, samples))


def _sensors(subjects: Subjects, samples: EvenSamples) -> list[str]:
    return [s for s in subjects.sensors if any(_has(samples, s, d) for d in DIRECTIONS)]


def _assess_transitions(
    found: Assessment, subjects: Subjects, samples: EvenSamples, distance: Signal | None
) -> None:
    known = [name for name in subjects.bends if name in samples.channels]
    if not known or distance is None or not subjects.sensors:
        return
    section = samples.time.section(samples.kept)
    transitions = find_transitions(section, samples.section(known[0]), distance)
    if not transitions:
        return
    floors = [floor for floor in subjects.floors if _has(samples, floor, "lateral", "roll_rate")]
    for floor in floors:
        found.transitions.extend(assess_transitions(floor, samples, transitions))
    if not floors:
        found.remarks.append(
            "comfort on curve transitions is left out: there is no sensor of kind 'floor', which "
            "says what is felt along the floor and how fast it rolls"
        )
    elif len(found.transitions) < len(floors) * len(transitions):
        found.remarks.append(
            "comfort on curve transitions: those at the begin or the end of the run are left out"
        )
    short = min((t.end - t.begin for t in found.transitions), default=SHORTEST)
    if short < SHORTEST * (1.0 - _ROUNDING):
        found.remarks.append(
            f"comfort on curve transitions: one takes {short:.2g} s; EN 12299 is for "
            f"{SHORTEST:g} s or more"
        )


def _comfort_remarks(comfort: list[Comfort], samples: EvenSamples) -> Iterator[str]:
    for one in comfort:
        missing = [f"{one.name}.{d}" for d in DIRECTIONS if d not in one.continuous]
        if missing:
            yield f"N_MV of {one.name} is left out: there is no {' and no '.join(missing)}"
    count = max(len(values) for one in comfort for values in one.continuous.values())
    if count < WINDOWS:
        yield f"comfort: {count} windows of {WINDOW:g} s; EN 12299 asks for {WINDOWS}"
    if samples.rate < COMFORT_RATE * (1.0 - _ROUNDING):
        yield (
            f"comfort: {samples.rate:.4g} samples a second; EN 12299 asks for {COMFORT_RATE:g}, "
            f"an output.interval of {1e3 / COMFORT_RATE:g} ms"
        )


def _assess_wear(
    found: Assessment, subjects: Subjects, samples: EvenSamples, distance: Signal | None
) -> None:
    worn = [wheel for wheel in subjects.worn if _has(samples, wheel, "wear_number")]
    if distance is None or not found.way:
        if worn:
            found.remarks.append("wear is left out: no way along the track is known")
        return
    found.wear.extend(
        assess_wear(wheel, distance, samples.section(f"{wheel}.wear_number")) for wheel in worn
    )


def _has(samples: EvenSamples, name: str, *words: str) -> bool:
    return all(f"{name}.{word}" in samples.channels for word in words)
