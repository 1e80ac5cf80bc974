"""The verb that writes results as tables of other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vehicledyn.cli.completion import channel_names
from vehicledyn.cli.options import ResultFile
from vehicledyn.cli.terminal import emit


def add_verbs(app: typer.Typer) -> None:
    """Add the verb of this module to the command line."""
    app.command("export-data")(export_data)


def export_data(
    result: ResultFile,
    *,
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", metavar="FILE", help="File to write: .csv, .mat or .parquet."
        ),
    ],
    channels: Annotated[
        list[str] | None,
        typer.Option(
            "--channel",
            metavar="PATTERN",
            help="Write only these arrays; may be repeated.",
            autocompletion=channel_names,
        ),
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace an existing file.")
    ] = False,
) -> None:
    """Export a result as a table with units (CSV, MATLAB or Parquet) and print its path."""
    from vehicledyn.results.labelled.data import open_result

    emit(str(open_result(result).export(output, *(channels or ()), overwrite=overwrite)))
