"""The verb that writes equations as functions of other languages or as an FMU."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

import vehicledyn
from vehicledyn.cli.commands.analyses import read_target
from vehicledyn.cli.options import Json, Overrides, Target
from vehicledyn.cli.terminal import emit_report, listen, show_progress


class Kind(StrEnum):
    """What equations are written as."""

    C = "c"
    PYTHON = "python"
    MATLAB = "matlab"
    FMU = "fmu"
    CUDA = "cuda"


def add_verbs(app: typer.Typer) -> None:
    """Add the verb of this module to the command line."""
    app.command()(export)


def export(
    target: Target,
    *,
    to: Annotated[Kind, typer.Option("--to", help="Target format.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="PATH", help="File or folder; the current folder if absent."
        ),
    ] = None,
    overrides: Overrides = None,
    as_json: Json = False,
) -> None:
    """Export the equations as C, Python or MATLAB functions, as an FMU or for CUDA."""
    loaded = read_target(target, overrides)
    listen(quiet=False, verbose=False)
    with show_progress() as progress:
        report = vehicledyn.write_equations(loaded, to.value, output, progress=progress)
    emit_report(report, as_json=as_json)
