"""What verbs do around an analysis: show progress, then messages, figures, report and exit code."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import typer

from vehicledyn.base.errors import InputError, Interrupted, ResultWarning, StoppedError
from vehicledyn.cli.exit_codes import INTERRUPTED, OK, code_of_error, code_of_result
from vehicledyn.cli.terminal import emit_report, show_progress, tell

if TYPE_CHECKING:
    from vehicledyn.results.labelled.data import LabelledData
    from vehicledyn.results.plots.drawing_process import Draw

_RUN = "run"


def perform(
    analysis: Callable[..., LabelledData],
    *arguments: Any,
    plots: Path | None = None,
    quiet: bool = False,
    verbose: bool = False,
    **options: Any,
) -> LabelledData:
    """Return the result of an analysis, of a stopped one what it had computed.

    Parameters
    ----------
    analysis
        Function of :mod:`vehicledyn`.
    plots
        Folder that figures will be drawn into, checked before anything is computed.
    quiet, verbose
        How much progress to show.
    arguments, options
        Of the analysis.
    """
    if plots is not None:
        from vehicledyn.results.hdf5.output import check_folder

        check_folder(plots)
    with show_progress(quiet=quiet, verbose=verbose) as progress, warnings.catch_warnings():
        warnings.simplefilter("ignore", ResultWarning)  # the report's messages say the same
        try:
            return analysis(*arguments, progress=progress, **options)
        except Interrupted as stopped:
            found: LabelledData = stopped.data
            return found


def conclude(
    data: LabelledData,
    *,
    plots: Path | None,
    as_json: bool,
    quiet: bool = False,
    draw: Draw | None = None,
) -> NoReturn:
    """Draw the figures, print messages and report, and leave with the exit code of the result.

    Figures that a result describes itself, as runs do, are drawn by ``draw`` where there is one.
    """
    report: Any = data.report
    code = code_of_result(data)
    messages = list(report.messages)
    if plots is not None:
        drawn, failure = _draw(data, plots, draw, quiet=quiet)
        messages += drawn
        code = code or failure
    for message in () if quiet and code == OK else messages:
        tell(message)
    if as_json or not quiet:
        emit_report(report, as_json=as_json, messages=messages)
    raise typer.Exit(code)


def show(
    data: LabelledData, *, as_json: bool, plots: Path | None = None, file: Path | None = None
) -> None:
    """Draw the figures and print the report, which goes to a file as JSON as well if one is given.

    For results that are either there or an error, such as eigenmodes.
    """
    if plots is not None:
        _draw_tables(data, plots)
    report: Any = data.report
    emit_report(report, as_json=as_json, file=file)


def _draw_tables(data: LabelledData, folder: Path) -> None:
    """Draw the standard figures of eigenmodes, responses, cycles or contacts into a folder."""
    from vehicledyn.results.plots.picture_files import save_figures
    from vehicledyn.results.plots.table_results import table_figures

    with show_progress() as progress:
        progress("drawing", None)
        save_figures(table_figures(data.path), folder, ("png", "svg"))


def _draw(
    data: LabelledData, folder: Path, draw: Draw | None, *, quiet: bool
) -> tuple[list[str], int]:
    """Draw figures; return what to say and an exit code. A failure leaves the result whole."""
    from vehicledyn.results.plots.drawing_process import draw_here

    try:
        if data.kind != _RUN:
            _draw_tables(data, folder)
            return [], OK
        with show_progress(quiet=quiet) as progress:
            progress("drawing the figures", None)
            number = (draw or draw_here)(data.path, folder)
    except StoppedError:
        return [f"stopped while drawing; the result {data.path} is whole"], INTERRUPTED
    except InputError as error:
        words = f"the result {data.path} is whole, but not its figures: {error}"
        return [words], code_of_error(error)
    return [f"{number} figures in {folder}"] if number else [], OK
