"""The verb that looks at a railway track."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vehicledyn.base.errors import InputError
from vehicledyn.base.units import to_si
from vehicledyn.cli.finding import find_file
from vehicledyn.cli.options import Json
from vehicledyn.cli.terminal import emit_report


def add_verbs(app: typer.Typer) -> None:
    """Add the verbs of this module to the command line."""
    app.command()(track)


def track(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="Track, or a scenario or system that has one.")
    ],
    *,
    every: Annotated[
        str | None,
        typer.Option(help='Spacing of the table rows such as "5 m"; about 25 rows if absent.'),
    ] = None,
    speed: Annotated[
        str | None, typer.Option(help='Speed such as "80 km/h", to report cant deficiencies.')
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Table to write: CSV, or a result (.h5).")
    ] = None,
    plots: Annotated[Path | None, typer.Option(help="Folder for the figures.")] = None,
    as_json: Json = False,
) -> None:
    """Show a railway track: plan, curvature, cant, gradient and irregularities of its rails."""
    step = None if every is None else _positive("--every", every, "m")
    velocity = None if speed is None else _positive("--speed", speed, "m/s")
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.analyses.contact.track_view import view_track

    file = find_file(file, "scenario", "system")
    report = view_track(file, every=step, speed=velocity, output=output, plots=plots)
    emit_report(report, as_json=as_json)


def _positive(option: str, text: str, unit: str) -> float:
    try:
        value = to_si(text, unit)
    except InputError as error:
        raise InputError(f"{option} {text}: {error}") from None
    if value <= 0.0:
        raise InputError(f"{option} {text}: must be above zero")
    return value
