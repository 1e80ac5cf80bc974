"""The verb "report": pages for people to look at, and the validation table."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import vehicledyn
from vehicledyn.base.errors import InputError
from vehicledyn.cli.options import Quiet
from vehicledyn.cli.terminal import emit, show_progress, tell

if TYPE_CHECKING:
    from vehicledyn.cli.progress_bar import Progress


def add_verbs(app: typer.Typer) -> None:
    """Add the verb of this module to the command line."""
    app.command()(report)


def report(
    source: Annotated[
        Path | None,
        typer.Argument(metavar="RESULT|FOLDER", help="Result file, or a folder of them."),
    ] = None,
    *,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", help="Report to write; NAME_report.html, or report.html in a folder."
        ),
    ] = None,
    against: Annotated[
        Path | None, typer.Option(metavar="RESULT", help="Compare with this result.")
    ] = None,
    each: Annotated[
        bool, typer.Option("--each", help="For a folder: also write a report of each result.")
    ] = False,
    validation: Annotated[
        bool,
        typer.Option(
            "--validation",
            help="Compute reports/validation.md and its figures again, in a clone of the project.",
        ),
    ] = False,
    quiet: Quiet = False,
) -> None:
    """Write an HTML report of a result, of two compared, or of a folder; print its path."""
    if validation:
        if output is not None or against is not None or each:
            raise InputError("--validation goes with no other option but --quiet")
        from vehicledyn.cli.commands.validation import validate_again

        raise typer.Exit(validate_again(source, quiet=quiet))
    if source is None:
        raise InputError("report: name a result file or a folder of them, or give --validation")
    if each and not source.is_dir():
        raise InputError(f"--each: {source} is no folder")
    with show_progress(quiet=quiet) as progress:
        if each:
            _write_each(source, progress)
        page = vehicledyn.report(source, output, against=against, progress=progress)
    emit(str(page))


def _write_each(folder: Path, progress: Progress) -> None:
    """Write the page of every result of a folder; what cannot be read is reported and left out."""
    from vehicledyn.results.report import results_in

    for path in results_in(folder):
        try:
            vehicledyn.report(path, progress=progress)
        except InputError as error:
            tell(str(error))
