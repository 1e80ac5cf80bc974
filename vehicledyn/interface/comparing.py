"""Comparison of results from Python."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from vehicledyn.base.checked_arguments import checked
from vehicledyn.base.errors import InputError
from vehicledyn.interface.quantities import texts
from vehicledyn.results.compare.any_compare import compare_results
from vehicledyn.results.compare.comparison import Comparison
from vehicledyn.results.labelled.data import LabelledData

Result = str | Path | LabelledData


@checked
def compare(
    result: Result,
    reference: Result,
    *,
    relative: float = 1e-6,
    absolute: float = 1e-12,
    tolerances: Mapping[str, float] | None = None,
    channels: str | Iterable[str] | None = None,
    allow_missing: bool = False,
    interpolate: bool = False,
) -> Comparison:
    """Return how a result differs from a reference; ``is_equal`` says whether within tolerances.

    Parameters
    ----------
    result, reference
        Results, or their files.
    relative
        Tolerance relative to the range of each channel of the reference [1].
    absolute
        Tolerance added to it, in the unit of each channel.
    tolerances
        Relative tolerances by pattern of channel names.
    channels
        Names or patterns to compare; all of the reference if None.
    allow_missing
        Whether the result may lack channels.
    interpolate
        Whether sample times may differ.

    Raises
    ------
    UnusableResultError
        If a result cannot be used, such as a run that did not finish.
    """
    found = compare_results(
        _path(result),
        _path(reference),
        relative=relative,
        absolute=absolute,
        channel_tolerances=tolerances,
        channels=None if channels is None else texts("channels", channels),
        allow_missing=allow_missing,
        interpolate=interpolate,
    )
    named = replace(
        found,
        result=_name(result, "result"),
        reference=_name(reference, "reference"),
    )
    if found.problems:
        raise UnusableResultError(named)
    return named


class UnusableResultError(InputError):
    """A result that cannot be compared; ``comparison`` holds the problems."""

    def __init__(self, comparison: Comparison) -> None:
        super().__init__("\n".join(comparison.problems))
        self.comparison = comparison


def _path(result: Result) -> Path:
    return result.path if isinstance(result, LabelledData) else Path(result)


def _name(result: Result, what: str) -> str:
    """Return a file, or what takes its place for a value that has none of its own."""
    if isinstance(result, LabelledData) and result.is_temporary:
        return what
    return str(_path(result))
