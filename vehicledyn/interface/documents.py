"""Pages, exported equations and the list of models from Python."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from vehicledyn.base.checked_arguments import checked
from vehicledyn.files.scenario.settings import Settings, override_texts
from vehicledyn.interface.running import Progress, reporter
from vehicledyn.interface.targets import Source, read_target
from vehicledyn.results.labelled.data import LabelledData

if TYPE_CHECKING:
    from vehicledyn.analyses.models.exporting import ExportReport


@checked
def report(
    result: LabelledData | str | Path,
    output: str | Path | None = None,
    *,
    against: LabelledData | str | Path | None = None,
    progress: Progress = False,
) -> Path:
    """Write a page that shows a result, compares two or lists a folder; return where it is.

    Parameters
    ----------
    result
        What an analysis returned, a result file, or a folder of result files.
    output
        The page; beside the result as NAME_report.html if None.
    against
        Another result of the same kind to compare it with.
    progress
        As for :func:`vehicledyn.simulate`.

    Raises
    ------
    InputError
        If a file cannot be read, the two are of different kinds, or the page cannot be written.
    """
    from vehicledyn.results.report import write_report

    paths = [_path(item) for item in (result, output, against)]
    source, page, other = paths
    assert source is not None
    if page is None and isinstance(result, LabelledData):
        page = Path(f"{result.kind}_report.html")
    return write_report(source, page, against=other, progress=reporter(progress))


@checked
def write_equations(
    model: Source,
    to: Literal["c", "python", "matlab", "fmu", "cuda"],
    output: str | Path | None = None,
    *,
    set: Settings | None = None,
    progress: Progress = False,
    **settings: Any,
) -> ExportReport:
    """Write the equations of a model as functions of another language or as an FMU.

    Parameters
    ----------
    model
        As ``source`` of :func:`vehicledyn.simulate`.
    to
        "c", "python", "matlab", "fmu" or "cuda".
    output
        File to write or folder for the files; the present folder if None.
    set, settings, progress
        As for :func:`vehicledyn.simulate`.

    Returns
    -------
    ExportReport
        Names of the files, states and parameters.

    Raises
    ------
    InputError
        If a file cannot be written.
    NumericalError
        If the loops cannot be assembled or there is no equilibrium to start from.
    """
    from vehicledyn.analyses.models.exporting import export_target

    target = read_target(model, override_texts(set, settings), ("scenario", "system"))
    return export_target(target, kind=to, path=_path(output), progress=reporter(progress))


@checked
def models() -> dict[str, str]:
    """Return the models that can be named, with a sentence each."""
    from vehicledyn.catalogue import first_lines
    from vehicledyn.library import entries

    systems = {entry.name: entry.sentence() for entry in entries("system")}
    return dict(sorted({**systems, **first_lines("model")}.items()))


def _path(item: LabelledData | str | Path | None) -> Path | None:
    if item is None:
        return None
    return item.path if isinstance(item, LabelledData) else Path(item)
