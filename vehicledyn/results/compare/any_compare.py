"""Comparing two results of whatever kind."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from vehicledyn.results.compare.comparison import Comparison
from vehicledyn.results.compare.run_compare import compare_files
from vehicledyn.results.compare.study_compare import compare_studies
from vehicledyn.results.compare.table_compare import compare_tables, other_kinds
from vehicledyn.results.compare.tolerances import Tolerances
from vehicledyn.results.plots.table_results import holds_table
from vehicledyn.results.store.study_reader import is_study_file


def compare_results(
    result: Path,
    reference: Path,
    *,
    relative: float = 1e-6,
    absolute: float = 1e-12,
    channel_tolerances: Mapping[str, float] | None = None,
    channels: Sequence[str] | None = None,
    allow_missing: bool = False,
    interpolate: bool = False,
) -> Comparison:
    """Compare a result with a reference of the same kind.

    Parameters are those of :func:`vehicledyn.results.compare.run_compare.compare_files`; unusable
    files are reported in the comparison, not raised.
    """
    missing = [path for path in (result, reference) if not path.exists()]
    if missing:
        words = tuple(f"{path}: there is no such file" for path in missing)
        return Comparison(str(result), str(reference), problems=words)
    if holds_table(reference) or other_kinds(result, reference):
        compare = compare_tables
    elif is_study_file(reference):
        compare = compare_studies
    else:
        return compare_files(
            result,
            reference,
            relative=relative,
            absolute=absolute,
            channel_tolerances=channel_tolerances,
            channels=channels,
            allow_missing=allow_missing,
            interpolate=interpolate,
        )
    return compare(
        result,
        reference,
        tolerances=Tolerances(relative, absolute, channel_tolerances or {}),
        channels=channels,
        allow_missing=allow_missing,
    )
