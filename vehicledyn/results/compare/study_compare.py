"""Comparing the files of two studies: cases, what varied, key figures and samples."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError
from vehicledyn.results.compare.comparison import ChannelComparison, Comparison
from vehicledyn.results.compare.patterns import is_chosen, unmatched
from vehicledyn.results.compare.tolerances import Tolerances
from vehicledyn.results.store.study_layout import STATUS_NAMES
from vehicledyn.results.store.study_reader import StudyFile, open_study

_CASES = 64
"""Cases that are read at a time."""


def compare_studies(
    result: Path,
    reference: Path,
    *,
    tolerances: Tolerances,
    channels: Sequence[str] | None = None,
    allow_missing: bool = False,
) -> Comparison:
    """Compare the file of a study with a reference, case by case.

    Tolerances are relative to the range that a quantity of the reference has over all cases;
    key figures are compared as ``figures.NAME``, what varies as ``cases.KEY``.

    Returns
    -------
    Comparison
        Its ``verdict`` says how it went; unusable files are reported in it, not raised.
    """
    names = (str(result), str(reference))
    problems = tolerances.problems()
    with ExitStack() as stack:
        files = []
        for path in (result, reference):
            try:
                files.append(stack.enter_context(open_study(path)))
            except InputError as error:
                problems.append(str(error))
        problems += [
            f"{file.path}: not a complete study ({file.state}); go on with it by "
            f"{argument('resume')}"
            for file in files
            if not file.is_whole
        ]
        if not problems:
            problems = unmatched(_names(files[1]), channels, tolerances)
        if problems:
            return Comparison(*names, problems=tuple(problems))
        differences = list(_whole_differences(files[0], files[1]))
        if differences:
            return Comparison(*names, differences=tuple(differences))
        compared = list(
            _compared(files[0], files[1], tolerances, channels, allow_missing=allow_missing)
        )
        return Comparison(
            *names,
            channels=tuple(compared),
            extra=tuple(sorted(set(_names(files[0])) - set(_names(files[1])))),
        )


def _names(file: StudyFile) -> list[str]:
    return [
        *(f"cases.{axis.name}" for axis in file.axes),
        *(f"figures.{name}" for name in file.figures),
        *(channel.name for channel in file.channels),
    ]


def _whole_differences(result: StudyFile, reference: StudyFile) -> Iterator[str]:
    if result.n_cases != reference.n_cases:
        yield f"{result.n_cases} cases, in the reference {reference.n_cases}"
        return
    ours, theirs = result.case_status(), reference.case_status()
    wrong = np.flatnonzero(ours != theirs)
    if wrong.size:
        case = int(wrong[0])
        yield (
            f"{wrong.size} cases ended otherwise; the first is case {case}: "
            f"{STATUS_NAMES[ours[case]]}, in the reference {STATUS_NAMES[theirs[case]]}"
        )
    if not (
        len(result.times) == len(reference.times)
        and np.allclose(result.times, reference.times, rtol=1e-9, atol=0.0)
    ):
        yield "the samples are taken at other times"


def _compared(
    result: StudyFile,
    reference: StudyFile,
    tolerances: Tolerances,
    patterns: Sequence[str] | None,
    *,
    allow_missing: bool,
) -> Iterator[ChannelComparison]:
    known = set(_names(result))
    for name in _names(reference):
        if not is_chosen(name, patterns):
            continue
        if name not in known:
            if not allow_missing:
                words = "missing from the result"
                yield ChannelComparison(name, "", passed=False, message=words)
            continue
        yield _compare(name, result, reference, tolerances)


def _compare(
    name: str, result: StudyFile, reference: StudyFile, tolerances: Tolerances
) -> ChannelComparison:
    head, _, rest = name.partition(".")
    if head == "figures" and rest in reference.figures:
        ours, theirs = result.figure(rest), reference.figure(rest)
        if result.figure_texts(rest) != reference.figure_texts(rest):
            return ChannelComparison(name, "", passed=False, message="other texts")
        units = (result.figures[rest].unit, reference.figures[rest].unit)
        return _judge(name, units, iter([(ours, theirs)]), tolerances)
    if head == "cases" and rest in [axis.name for axis in reference.axes]:
        mine, other = (_axis_of(file, rest) for file in (result, reference))
        if mine[1].choices != other[1].choices:
            return ChannelComparison(name, "", passed=False, message="other choices")
        pairs = iter([(result.axis(mine[0]), reference.axis(other[0]))])
        return _judge(name, (mine[1].unit, other[1].unit), pairs, tolerances)
    of_ours, of_theirs = (_unit_of(file, name) for file in (result, reference))
    pairs = (
        (result.channel(name, part), reference.channel(name, part))
        for part in (slice(k, k + _CASES) for k in range(0, reference.n_cases, _CASES))
    )
    return _judge(name, (of_ours, of_theirs), pairs, tolerances)


def _axis_of(file: StudyFile, name: str) -> tuple[int, Any]:
    return next((k, axis) for k, axis in enumerate(file.axes) if axis.name == name)


def _unit_of(file: StudyFile, name: str) -> str:
    return next(channel.unit for channel in file.channels if channel.name == name)


def _judge(
    name: str, units: tuple[str, str], pairs: Iterator[tuple[Any, Any]], tolerances: Tolerances
) -> ChannelComparison:
    """Compare pairs of arrays piece by piece; what is not a number must be so in both."""
    if units[0] != units[1]:
        words = f"unit is {units[0]}, in the reference {units[1]}"
        return ChannelComparison(name, units[1], passed=False, message=words)
    largest, values, ends, first, worst = -1.0, (0.0, 0.0), [np.inf, -np.inf], 0, 0
    for ours, theirs in pairs:
        if (np.isfinite(ours) != np.isfinite(theirs)).any():
            words = "values are missing in one of the two"
            return ChannelComparison(name, units[1], passed=False, message=words)
        known = np.isfinite(theirs)
        begin, first = first, first + len(theirs)
        if not known.any():
            continue
        mine, other = ours[known].astype(float), theirs[known].astype(float)
        ends = [min(ends[0], other.min()), max(ends[1], other.max())]
        distance = np.abs(mine - other)
        at = int(distance.argmax())
        if distance[at] > largest:
            largest, values = float(distance[at]), (float(mine[at]), float(other[at]))
            worst = begin + int(np.nonzero(known)[0][at])
    if largest < 0.0:
        return ChannelComparison(name, units[1], passed=True)
    tolerance = tolerances.of(name, np.array(ends))
    return ChannelComparison(
        name,
        units[1],
        passed=bool(largest <= tolerance < np.inf),
        difference=largest,
        tolerance=tolerance,
        value=values[0],
        reference=values[1],
        message=f"in case {worst}",
    )
