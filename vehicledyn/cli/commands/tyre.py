"""The verb that looks at tyres."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vehicledyn.base.errors import InputError
from vehicledyn.base.units import to_si
from vehicledyn.cli.options import Json
from vehicledyn.cli.terminal import emit_report


def add_verbs(app: typer.Typer) -> None:
    """Add the verbs of this module to the command line."""
    app.command()(tyre)


def tyre(
    file: Annotated[
        Path,
        typer.Argument(metavar="FILE", help="Tyre property file (.tir), or one of the library."),
    ],
    *,
    compare: Annotated[
        Path | None, typer.Option(help="Second tyre property file to compare with.")
    ] = None,
    fit: Annotated[
        Path | None,
        typer.Option(help="Measured forces (CSV) to fit the coefficients of FILE to."),
    ] = None,
    coefficients: Annotated[
        str | None, typer.Option(help="Coefficients to fit, such as PCY1,PDY1; by the data.")
    ] = None,
    load: Annotated[
        list[str] | None, typer.Option(help='Load such as "4 kN"; may be repeated.')
    ] = None,
    convention: Annotated[
        str | None, typer.Option(help="Rules where public programs disagree, such as tangent.")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Table (CSV, HDF5), or fitted tyre (.tir)."),
    ] = None,
    plots: Annotated[Path | None, typer.Option(help="Folder for the figures.")] = None,
    as_json: Json = False,
) -> None:
    """Show the curves of a tyre, compare two tyres, or fit a Magic Formula to measurements."""
    loads = [_load(text) for text in load or []]
    if fit is not None:
        from vehicledyn.analyses.tyres.fit import fit_tyre

        names = [n.strip().upper() for n in (coefficients or "").split(",") if n.strip()]
        found = fit_tyre(file, fit, names=names, convention=convention, output=output, plots=plots)
        emit_report(found, as_json=as_json)
        return
    if coefficients is not None:
        raise InputError("--coefficients: only with --fit, which names the measured forces")
    from vehicledyn.analyses.tyres.curves import view_tyre

    report = view_tyre(
        file, other=compare, loads=loads, convention=convention, output=output, plots=plots
    )
    emit_report(report, as_json=as_json)


def _load(text: str) -> float:
    try:
        value = to_si(text, "N")
    except InputError as error:
        raise InputError(f"--load {text}: {error}") from None
    if value <= 0.0:
        raise InputError(f"--load {text}: must be above zero")
    return value
