"""The verb "uncertainty": how figures scatter with their parameters."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import vehicledyn
from vehicledyn.cli.finding import find_file
from vehicledyn.cli.options import Json, Overrides
from vehicledyn.cli.performing import perform, show
from vehicledyn.cli.replacing import UNCERTAINTY, Overwrite, Resume, check_replacing


def add_verbs(app: typer.Typer) -> None:
    """Add the verb of this module to the command line."""
    app.command()(uncertainty)


def uncertainty(
    study: Annotated[Path, typer.Argument(metavar="STUDY", help="Uncertainty study file.")],
    *,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Result file; the study's name with .h5 if absent."),
    ] = None,
    overrides: Overrides = None,
    resume: Resume = False,
    plots: Annotated[Path | None, typer.Option(help="Folder to draw figures into.")] = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Find how figures scatter whose parameters have distributions."""
    from vehicledyn.files.scenario.overrides import read_overrides

    path = find_file(study, "study")
    result = output or Path(f"{study.stem}.h5")
    check_replacing(result, UNCERTAINTY, overwrite=overwrite, resume=resume)
    changes = read_overrides(overrides or ())
    data = perform(
        vehicledyn.uncertainty_study,
        path,
        plots=plots,
        set=changes,
        save_to=result,
        overwrite=True,
        resume=resume,
    )
    show(data, as_json=as_json, plots=plots)
