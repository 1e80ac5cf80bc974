"""Comparing a result with a reference, fit for continuous integration.

Verdicts: "equal" within tolerance; "different" in a value, a missing channel, a unit, a shorter
run, other sample times, NaN or infinity; "unusable": a file that is not readable, has another
format, holds an incomplete run or no channels, or a pattern that matches nothing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.results.compare.comparison import ChannelComparison, Comparison
from vehicledyn.results.compare.sampling_grids import grid_difference, range_difference
from vehicledyn.results.compare.setting_notes import setting_notes
from vehicledyn.results.compare.tolerances import Tolerances
from vehicledyn.results.store.reader import Result, open_result
from vehicledyn.results.store.values import Series

Floats = NDArray[np.float64]


def compare_files(
    result: str | Path,
    reference: str | Path,
    *,
    relative: float = 1e-6,
    absolute: float = 0.0,
    channel_tolerances: Mapping[str, float] | None = None,
    channels: Sequence[str] | None = None,
    allow_missing: bool = False,
    interpolate: bool = False,
) -> Comparison:
    """Compare a result with a reference, channel by channel.

    Parameters
    ----------
    result, reference
        Result files, both of runs that reached their planned end.
    relative
        Tolerance relative to the reference channel's range, see :class:`Tolerances` [1].
    absolute
        Tolerance added to it, in the unit of each channel.
    channel_tolerances
        Relative tolerances by pattern of channel names.
    channels
        Patterns of the channels to compare; all of the reference if None.
    allow_missing
        Whether a channel of the reference may be missing from the result.
    interpolate
        Whether to interpolate a result with other sample times linearly.

    Returns
    -------
    Comparison
        Its ``verdict`` says how it went; unusable files are reported in it, not raised.
    """
    names = (str(result), str(reference))
    tolerances = Tolerances(relative, absolute, dict(channel_tolerances or {}))
    problems = tolerances.problems()
    opened: list[Result] = []
    try:
        for path in (result, reference):
            try:
                opened.append(open_result(path))
            except InputError as error:
                problems.append(str(error))
        for file in opened:
            problems += _unusable(file)
        if len(opened) == 2:
            problems += _bad_patterns(opened[1], [*(channels or []), *tolerances.by_channel])
        if problems:
            return Comparison(*names, problems=tuple(problems))
        return _compare(
            opened[0],
            opened[1],
            chosen=_chosen(opened[1], channels),
            tolerances=tolerances,
            allow_missing=allow_missing,
            interpolate=interpolate,
        )
    except InputError as error:
        return Comparison(*names, problems=(str(error),))
    finally:
        for file in opened:
            file.close()


class _Pair(NamedTuple):
    result: Result
    reference: Result
    interpolated: bool


def _compare(
    result: Result,
    reference: Result,
    *,
    chosen: list[str],
    tolerances: Tolerances,
    allow_missing: bool,
    interpolate: bool,
) -> Comparison:
    missing = [name for name in chosen if name not in result.channels]
    if allow_missing and len(missing) == len(chosen):
        raise InputError(f"{result.path}: has none of the channels to compare")
    short = range_difference(result.time, reference.time)
    other_grid = grid_difference(result.time, reference.time)
    difference = _other_ending(result, reference) or short or ("" if interpolate else other_grid)
    compared: list[ChannelComparison] = []
    for name in chosen:
        if name in missing:
            if not allow_missing:
                compared.append(_missing(name, result, reference))
        elif not difference:
            pair = _Pair(result, reference, interpolated=bool(other_grid))
            compared.append(_compare_channel(name, pair, tolerances))
    return Comparison(
        str(result.path),
        str(reference.path),
        differences=(difference,) if difference else (),
        channels=tuple(compared),
        skipped=tuple(missing) if allow_missing else (),
        extra=tuple(name for name in result.channels if name not in reference.channels),
        notes=tuple(setting_notes(result, reference)),
    )


def _other_ending(result: Result, reference: Result) -> str:
    if result.status == reference.status:
        return ""
    return f"{result.status}, the reference is {reference.status} ({result.state_of_run})"


def _unusable(file: Result) -> list[str]:
    if not file.has_ended:
        return [f"{file.path}: not a complete run ({file.state_of_run}); run it again"]
    if not file.channels:
        return [f"{file.path}: holds no channels"]
    if not len(file.time):
        return [f"{file.path}: holds no samples"]
    if not np.all(np.isfinite(file.time)) or np.any(np.diff(file.time) < 0.0):
        return [f"{file.path}: its times do not rise; the file is damaged"]
    return []


def _bad_patterns(reference: Result, patterns: Sequence[str]) -> list[str]:
    problems = []
    for pattern in patterns:
        if not any(fnmatchcase(name, pattern) for name in reference.channels):
            guess = nearest_name(pattern, reference.channels)
            hint = f"; did you mean '{guess}'?" if guess else ""
            problems.append(f"{reference.path}: no channel matches '{pattern}'{hint}")
    return problems


def _chosen(reference: Result, patterns: Sequence[str] | None) -> list[str]:
    return [
        name
        for name in reference.channels
        if patterns is None or any(fnmatchcase(name, pattern) for pattern in patterns)
    ]


def _compare_channel(name: str, pair: _Pair, tolerances: Tolerances) -> ChannelComparison:
    computed, wanted = pair.result.channel(name), pair.reference.channel(name)
    undefined = _undefined_in_both(pair, computed.values, wanted.values)
    obstacle = (
        _unit_difference(computed, wanted)
        or _not_finite(computed.values, undefined, "the result", pair.result.time)
        or _not_finite(wanted.values, undefined, "the reference", pair.reference.time)
    )
    if obstacle:
        return ChannelComparison(name, wanted.unit, passed=False, message=obstacle)
    if undefined is not None and undefined.all():
        return ChannelComparison(name, wanted.unit, passed=True)
    time, values = pair.reference.time, computed.values
    if pair.interpolated:
        values = np.interp(time, pair.result.time, values)
    differences = np.abs(values - wanted.values)
    if undefined is not None:
        differences[undefined] = 0.0
    at = int(np.argmax(differences))
    tolerance = tolerances.of(name, wanted.values[np.isfinite(wanted.values)])
    return ChannelComparison(
        name,
        wanted.unit,
        passed=bool(differences[at] <= tolerance < np.inf),
        difference=float(differences[at]),
        tolerance=tolerance,
        value=float(values[at]),
        reference=float(wanted.values[at]),
        time=float(time[at]),
    )


def _unit_difference(computed: Series, wanted: Series) -> str:
    if computed.unit == wanted.unit:
        return ""
    return f"unit is {computed.unit}, in the reference {wanted.unit}"


def _undefined_in_both(pair: _Pair, computed: Floats, wanted: Floats) -> NDArray[np.bool_] | None:
    """Return where a quantity is undefined (NaN) in both files, which agree there; else None.

    Of positions only: a motion ratio has no value where the wheel does not move. A motion that is
    no number has failed, in both files too.
    """
    if pair.interpolated or pair.reference.is_timed:
        return None
    undefined: NDArray[np.bool_] = np.isnan(computed) & np.isnan(wanted)
    return undefined


def _not_finite(
    values: Floats, undefined: NDArray[np.bool_] | None, place: str, time: Floats
) -> str:
    wrong = ~np.isfinite(values)
    if undefined is not None:
        wrong &= ~undefined
    bad = np.flatnonzero(wrong)
    return f"{values[bad[0]]} in {place} at t = {time[bad[0]]:.9g} s" if bad.size else ""


def _missing(name: str, result: Result, reference: Result) -> ChannelComparison:
    guess = nearest_name(name, result.channels)
    hint = f"; the nearest it has is '{guess}'" if guess else ""
    unit = reference.channel(name).unit
    return ChannelComparison(name, unit, passed=False, message=f"missing from the result{hint}")
