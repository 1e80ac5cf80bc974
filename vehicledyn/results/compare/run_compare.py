"""Comparing a result with a reference, fit for continuous integration.

Verdicts: "equal" within tolerance; "different" in a value, a missing channel, a unit, a shorter
run, other sample times, NaN or infinity; "unusable": a file that is not readable, has another
format, holds an incomplete run or no channels, or a pattern that matches nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.results.compare.comparison import ChannelComparison, Comparison
from vehicledyn.results.compare.patterns import is_chosen, unmatched
from vehicledyn.results.compare.sampling_grids import (
    Resampling,
    grid_difference,
    range_difference,
)
from vehicledyn.results.compare.setting_notes import setting_notes
from vehicledyn.results.compare.tolerances import Tolerances
from vehicledyn.results.store.decimation import PORTION
from vehicledyn.results.store.reader import ENDS, Result, open_result

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
                opened.append(open_result(path, ENDS))
            except InputError as error:
                problems.append(str(error))
        for file in opened:
            problems += _unusable(file)
        if len(opened) == 2:
            problems += unmatched(opened[1].channels, channels, tolerances)
        if problems:
            return Comparison(*names, problems=tuple(problems))
        return _compare(
            opened[0],
            opened[1],
            chosen=[name for name in opened[1].channels if is_chosen(name, channels)],
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
    times = (result.column("time"), reference.column("time"))
    short, other_grid = range_difference(*times), grid_difference(*times)
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
    return []


def _compare_channel(name: str, pair: _Pair, tolerances: Tolerances) -> ChannelComparison:
    units = [file.facts(name)[0] for file in (pair.result, pair.reference)]
    if units[0] != units[1]:
        message = f"unit is {units[0]}, in the reference {units[1]}"
        return ChannelComparison(name, units[1], passed=False, message=message)
    worst = _Worst()
    for block in _blocks(name, pair):
        worst.see(block, is_path=not pair.reference.is_timed and not pair.interpolated)
    wrong = (
        worst.wrong_result
        or worst.wrong_reference
        or (_first_not_finite(name, pair.result) if pair.interpolated else "")
    )
    if wrong:
        return ChannelComparison(name, units[1], passed=False, message=wrong)
    if not worst.seen:
        return ChannelComparison(name, units[1], passed=True)
    tolerance = tolerances.of(name, np.array(worst.ends))
    return ChannelComparison(
        name,
        units[1],
        passed=bool(worst.difference <= tolerance < np.inf),
        difference=worst.difference,
        tolerance=tolerance,
        value=worst.value,
        reference=worst.reference,
        time=worst.time,
    )


class _Block(NamedTuple):
    """Some samples of a channel in both files."""

    times: Floats
    computed: Floats
    wanted: Floats


def _blocks(name: str, pair: _Pair) -> Iterator[_Block]:
    """Yield the samples of the reference, and the result at their times, block by block."""
    times, wanted = pair.reference.column("time"), pair.reference.column(name)
    computed = pair.result.column(name)
    at = Resampling(pair.result.column("time")) if pair.interpolated else None
    for start in range(0, len(times), PORTION):
        part = slice(start, start + PORTION)
        instants = times[part]
        values = computed[part] if at is None else at.values(computed, instants)
        yield _Block(instants, values, wanted[part])


def _first_not_finite(name: str, result: Result) -> str:
    """Return where a result that is interpolated holds what is no number, empty for nowhere."""
    times, column = result.column("time"), result.column(name)
    for start in range(0, len(times), PORTION):
        part = slice(start, start + PORTION)
        if wrong := _not_finite(column[part], None, "the result", times[part]):
            return wrong
    return ""


class _Worst:
    """What comparing block by block has found so far."""

    def __init__(self) -> None:
        self.wrong_result = self.wrong_reference = ""
        self.seen, self.difference = False, -1.0
        self.value = self.reference = self.time = 0.0
        self.ends = (np.inf, -np.inf)

    def see(self, block: _Block, *, is_path: bool) -> None:
        """Take a block into account; ``is_path`` says that NaN in both files agree.

        Of positions only: a motion ratio has no value where the wheel does not move. A motion that
        is no number has failed, in both files too.
        """
        times, computed, wanted = block
        undefined = np.isnan(computed) & np.isnan(wanted) if is_path else None
        self.wrong_result = self.wrong_result or _not_finite(
            computed, undefined, "the result", times
        )
        self.wrong_reference = self.wrong_reference or _not_finite(
            wanted, undefined, "the reference", times
        )
        known = slice(None) if undefined is None else ~undefined
        if self.wrong_result or self.wrong_reference or not wanted[known].size:
            return
        self.seen = True
        low, high = float(wanted[known].min()), float(wanted[known].max())
        self.ends = (min(self.ends[0], low), max(self.ends[1], high))
        differences = np.abs(computed - wanted)
        if undefined is not None:
            differences[undefined] = 0.0
        at = int(np.argmax(differences))
        if differences[at] > self.difference:
            self.difference, self.time = float(differences[at]), float(times[at])
            self.value, self.reference = float(computed[at]), float(wanted[at])


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
    unit = reference.facts(name)[0]
    return ChannelComparison(name, unit, passed=False, message=f"missing from the result{hint}")
