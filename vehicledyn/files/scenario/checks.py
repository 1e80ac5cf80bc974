"""Checks over several fields: times, coordinates that the model has, tyres that can relax."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.problems import Place, Problem
from vehicledyn.base.units import to_si
from vehicledyn.files.scenario.sets import Scenario
from vehicledyn.files.scenario.sources import Sources

_DURATION: Place = ("duration",)
_INTERVAL: Place = ("output", "interval")
_STEP: Place = ("solver", "step")
_ROUNDING = 1e-9
MOST_SAMPLES = 1e8


def check_times(data: dict[str, Any], scenario: Scenario | None, sources: Sources) -> list[Problem]:
    """Return the problems of duration, output interval and fixed step with each other.

    Parameters
    ----------
    data
        Content of the file; used where the scenario as a whole is not valid, so that these
        problems are reported together with the others.
    scenario
        The valid scenario, or None.
    sources
        Where each value came from.
    """
    duration, interval, step = (
        _seconds(scenario if scenario is not None else data, place)
        for place in (_DURATION, _INTERVAL, _STEP)
    )
    return [sources.problem(place, words) for place, words in _mismatches(duration, interval, step)]


def named_coordinates(scenario: Scenario, known: Mapping[str, Any]) -> list[tuple[Place, str]]:
    """Return what is wrong with coordinates that the manoeuvre names.

    Parameters
    ----------
    scenario
        The valid scenario.
    known
        Coordinates of its model; nothing is checked where none are known.
    """
    fields = getattr(scenario.manoeuvre, "coordinate_fields", ()) if known else ()
    named = ((field, getattr(scenario.manoeuvre, field)) for field in fields)
    return [
        (("manoeuvre", field), unknown_name("coordinate", name, known))
        for field, name in named
        if name is not None and name not in known
    ]


def refused_tyres(scenario: Scenario, folder: Path) -> list[tuple[Place, str]]:
    """Return why a relaxation does not go with the tyres beside it.

    Parameters
    ----------
    scenario
        The valid scenario, whose files are valid, too.
    folder
        Its folder, where the files of tyres are looked for.
    """
    check, problems = getattr(scenario.relaxation, "check_tyre", None), []
    if check is None or scenario.tyres is None:
        return []
    for law in (scenario.tyres.front, scenario.tyres.rear):
        placed = getattr(law, "placed", None)
        try:
            check(law if placed is None else placed(folder))
        except InputError as error:
            problems.append((("relaxation",), str(error)))
    return list(dict.fromkeys(problems))


def _mismatches(
    duration: float | None, interval: float | None, step: float | None
) -> Iterator[tuple[Place, str]]:
    if interval is not None and duration is not None:
        yield from _sampling(duration, interval)
    if interval is not None and step is not None:
        yield from ((_STEP, words) for words in _stepping(interval, step))


def _sampling(duration: float, interval: float) -> Iterator[tuple[Place, str]]:
    if interval > duration * (1.0 + _ROUNDING):
        yield _INTERVAL, f"{interval:g} s is longer than the duration of {duration:g} s"
    elif duration > MOST_SAMPLES * interval:
        yield (
            _INTERVAL,
            f"{interval:g} s gives {duration / interval:.1e} samples; take a longer one",
        )
    elif not _divides(interval, duration):
        nearest = round(duration / interval) * interval
        interval_text = f"output intervals of {interval:g} s"
        yield _DURATION, f"{duration:g} s is no whole number of {interval_text}; take {nearest:g} s"


def _stepping(interval: float, step: float) -> Iterator[str]:
    if interval > MOST_SAMPLES * step:
        yield f"{step:g} s is too short for the output interval of {interval:g} s"
    elif not _divides(step, interval):
        better = _dividing_step(interval, step)
        yield f"{step:g} s does not divide the output interval of {interval:g} s; take {better} s"


def _dividing_step(interval: float, step: float) -> str:
    """Return the longest step below this one that divides the interval and is short to write."""
    fewest = math.ceil(interval / step)
    steps = (f"{interval / count:g}" for count in range(fewest, 10 * fewest + 1))
    return next((text for text in steps if _divides(float(text), interval)), f"{interval:g}")


def _divides(part: float, whole: float) -> bool:
    count = round(whole / part)
    return count >= 1 and abs(count * part - whole) <= _ROUNDING * whole


def _seconds(holder: Any, place: Place) -> float | None:
    """Return a positive time in seconds, or None if there is none that can be read."""
    for step in place:
        if isinstance(holder, ParameterSet):
            holder = getattr(holder, str(step), None)
        else:
            holder = holder.get(step) if isinstance(holder, dict) else None
    try:
        value = None if holder is None else to_si(holder, "s")
    except InputError:
        return None
    return value if value is not None and 0.0 < value < float("inf") else None
