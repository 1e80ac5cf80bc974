"""Comparing files without a time axis: modes, responses, contact geometry and hunting studies.

All of their numbers are compared, those of one dataset together; pairs of real and imaginary parts
as complex numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError
from vehicledyn.results.compare.comparison import ChannelComparison, Comparison
from vehicledyn.results.compare.patterns import is_chosen, unmatched
from vehicledyn.results.compare.tolerances import Tolerances
from vehicledyn.results.store.dimensions import is_bare
from vehicledyn.results.store.linear_file import format_of, old_file
from vehicledyn.results.tables import hunt_table
from vehicledyn.results.tables.kinds import held

_FIGURE = "figure_"
_ENDS = "_real", "_imag"
_OF_ANY_LENGTH = ("cycle_direction",)
"""Directions whose length and sign mean nothing."""
_ENDING = "status"
_LISTED = 3
"""Names that are listed of those that only one file has."""

_HOW = "notes"
"""Texts on how a result came about, such as how many runs were known from before a kill."""


def other_kinds(result: Path, reference: Path) -> str:
    """Return why two files cannot be compared, empty if they are of the same kind."""
    ours, theirs = (format_of(path) for path in (result, reference))
    if ours == theirs or not (ours and theirs):
        return ""
    return f"{result}: holds {held(ours)}, the reference {held(theirs)}: compare files of one kind"


def compare_tables(
    result: Path,
    reference: Path,
    *,
    tolerances: Tolerances,
    channels: Sequence[str] | None = None,
    allow_missing: bool = False,
) -> Comparison:
    """Compare such a file with a reference of the same kind.

    Tolerances are relative to the range of each dataset of the reference, or to its largest
    magnitude where it is constant; critical values are compared as ``figures.NAME``.

    Returns
    -------
    Comparison
        Its ``verdict`` says how it went; unusable files are reported in it, not raised.
    """
    names = (str(result), str(reference))
    problems = [*tolerances.problems(), *filter(None, [other_kinds(result, reference)])]
    if problems:
        return Comparison(*names, problems=tuple(problems))
    kind = format_of(reference)
    try:
        problems = [words for p in (result, reference) for words in _unfinished(p, kind)]
        if problems:
            return Comparison(*names, problems=tuple(problems))
        with old_file(result, kind) as ours, old_file(reference, kind) as theirs:
            own, other = dict(_numbers(ours)), dict(_numbers(theirs))
            problems = unmatched(other, channels, tolerances)
            if problems:
                return Comparison(*names, problems=tuple(problems))
            wanted = {n: v for n, v in other.items() if is_chosen(n, channels)}
            missing = [name for name in wanted if name not in own]
            compared = [
                _compared(name, own.get(name), wanted[name], tolerances)
                for name in wanted
                if name in own or not allow_missing
            ]
            return Comparison(
                *names,
                differences=tuple(_texts_differ(ours, theirs, channels)),
                channels=tuple(compared),
                skipped=tuple(missing) if allow_missing else (),
                extra=tuple(name for name in own if name not in other),
                notes=tuple(_notes(ours, theirs)),
            )
    except InputError as error:
        return Comparison(*names, problems=(str(error),))


def _unfinished(path: Path, kind: str) -> Iterator[str]:
    if kind == hunt_table.FORMAT and not (table := hunt_table.read_hunt(path)).is_finished:
        yield (
            f"{path}: not a finished study ({table.status}); go on with it by 'hunt "
            f"{argument('resume')}'"
        )


def _numbers(file: h5py.File) -> Iterator[tuple[str, tuple[str, Any]]]:
    """Yield names, units and values of all that a file holds in numbers."""
    for key, value in file.attrs.items():
        if key.startswith(_FIGURE):
            yield f"figures.{key.removeprefix(_FIGURE)}", ("", np.array([float(value)]))
    found: dict[str, h5py.Dataset] = {}

    def note(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu" and not is_bare(item):
            if name in _OF_ANY_LENGTH:
                return
            found[name.replace("/", ".")] = item

    file.visititems(note)
    for name, dataset in found.items():
        head, end = name[: -len(_ENDS[0])], name[-len(_ENDS[0]) :]
        unit = str(dataset.attrs.get("units", ""))
        if end == _ENDS[0] and head + _ENDS[1] in found:
            imaginary = np.asarray(found[head + _ENDS[1]][()], dtype=float)
            values = np.asarray(dataset[()], dtype=complex)
            values.imag = imaginary  # 1j * infinity would be no number
            yield head, (unit, values)
        elif not (end == _ENDS[1] and head + _ENDS[0] in found):
            yield name, (unit, np.asarray(dataset[()], dtype=float))


def _compared(
    name: str, ours: tuple[str, Any] | None, theirs: tuple[str, Any], tolerances: Tolerances
) -> ChannelComparison:
    unit, wanted = theirs
    obstacle = _obstacle(ours, theirs)
    if ours is None or obstacle:
        return ChannelComparison(name, unit, passed=False, message=obstacle)
    known = np.isfinite(wanted)
    if not known.any():
        return ChannelComparison(name, unit, passed=True)
    own, other = ours[1][known], wanted[known]
    distance = np.abs(own - other)
    at = int(distance.argmax())
    sizes = np.concatenate([other.real, other.imag]) if np.iscomplexobj(other) else other
    tolerance = tolerances.of(name, sizes)
    place = [int(k) for k in np.argwhere(known)[at]]
    return ChannelComparison(
        name,
        unit,
        passed=bool(distance[at] <= tolerance < np.inf),
        difference=float(distance[at]),
        tolerance=tolerance,
        value=_size(own[at]),
        reference=_size(other[at]),
        message=f"at place {', '.join(map(str, place))}",
    )


def _obstacle(ours: tuple[str, Any] | None, theirs: tuple[str, Any]) -> str:
    if ours is None:
        return "missing from the result"
    if ours[0] != theirs[0]:
        return f"unit is {ours[0]}, in the reference {theirs[0]}"
    if ours[1].shape != theirs[1].shape:
        shapes = (" by ".join(map(str, values.shape)) for values in (ours[1], theirs[1]))
        return "holds {} numbers, in the reference {}".format(*shapes)
    if (np.isfinite(ours[1]) != np.isfinite(theirs[1])).any():
        return "values are missing in one of the two"
    return ""


def _size(value: Any) -> float:
    """Return a number, of complex ones the magnitude."""
    return float(abs(value)) if np.iscomplexobj(value) else float(value)


def _texts_differ(
    ours: h5py.File, theirs: h5py.File, patterns: Sequence[str] | None
) -> Iterator[str]:
    """Yield how the files differ as a whole: how they ended, and names they hold."""
    endings = [str(file.attrs.get(_ENDING, "")) for file in (ours, theirs)]
    if endings[0] != endings[1]:
        yield "{}, the reference is {}".format(*endings)
    texts = [_texts(file) for file in (ours, theirs)]
    for name in texts[1]:
        is_wanted = name != _HOW and is_chosen(name, patterns)
        if is_wanted and texts[0].get(name) != texts[1][name]:
            ours_only, theirs_only = (
                [item for item in texts[k].get(name, []) if item not in texts[1 - k].get(name, [])]
                for k in (0, 1)
            )
            yield f"other names in '{name}'{_named(ours_only, theirs_only)}"


def _named(ours_only: Sequence[str], theirs_only: Sequence[str]) -> str:
    """Return the names that only one of two files has; nothing where they differ in order."""
    sides = (("only here", ours_only), ("only in the reference", theirs_only))
    parts = [
        f"{words} {', '.join(names[:_LISTED])}{', ...' if len(names) > _LISTED else ''}"
        for words, names in sides
        if names
    ]
    return f": {'; '.join(parts)}" if parts else ", in another order"


def _texts(file: h5py.File) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}

    def note(name: str, item: Any) -> None:
        is_text = isinstance(item, h5py.Dataset) and item.dtype.kind == "O"
        if is_text and item.ndim == 1 and not name.endswith("long_name"):
            found[name] = [str(text) for text in item.asstr()[()]]

    file.visititems(note)
    return found


def _notes(ours: h5py.File, theirs: h5py.File) -> Iterator[str]:
    """Yield by what two files differ before numbers: model, notes, title, which names changes."""
    for name in ("model", "title"):
        texts = [str(file.attrs.get(name, "")) for file in (ours, theirs)]
        if texts[0] != texts[1]:
            yield f"{name} is '{texts[0]}', in the reference '{texts[1]}'"
    own, other = (_texts(file).get(_HOW, []) for file in (ours, theirs))
    yield from (f"only the result notes: {text}" for text in own if text not in other)
    yield from (f"only the reference notes: {text}" for text in other if text not in own)
