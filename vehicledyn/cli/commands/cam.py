"""The verb that designs cams."""

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
    app.command()(cam)


def cam(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Description of a cam (YAML).")],
    *,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Table (CSV, HDF5) to write.")
    ] = None,
    profile: Annotated[
        Path | None, typer.Option(help="Profile for machining (DXF, CSV), in mm.")
    ] = None,
    tolerance: Annotated[
        str, typer.Option(help='Distance of the profile\'s chords from the curve, as "1 um".')
    ] = "1 um",
    plots: Annotated[Path | None, typer.Option(help="Folder for the figures.")] = None,
    as_json: Json = False,
) -> None:
    """Show a cam: motion, profile, pressure angle, curvature, undercut and forces."""
    try:
        allowed = to_si(tolerance, "m")
    except InputError as error:
        raise InputError(f"--tolerance {tolerance}: {error}") from None
    if allowed <= 0.0:
        raise InputError(f"--tolerance {tolerance}: must be above zero")
    if profile is not None and profile.suffix.lower() not in (".dxf", ".csv"):
        raise InputError(f"--profile {profile}: the name must end in .dxf or .csv")
    if output is not None and output.suffix.lower() not in (".h5", ".csv"):
        raise InputError(f"--output {output}: the name must end in .h5 or .csv")
    from vehicledyn.analyses.cams.view import view_cam
    from vehicledyn.cams.cam_file import read_cam

    report = view_cam(
        read_cam(file), output=output, plots=plots, profile=profile, tolerance=allowed
    )
    emit_report(report, as_json=as_json)
