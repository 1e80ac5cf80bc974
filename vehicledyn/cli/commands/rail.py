"""Verbs on wheels and rails."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

import vehicledyn
from vehicledyn.base.errors import InputError
from vehicledyn.base.ranges import read_range
from vehicledyn.base.units import to_si
from vehicledyn.cli.options import Json
from vehicledyn.cli.performing import perform, show
from vehicledyn.cli.replacing import PROFILES, Overwrite, Resume, check_replacing
from vehicledyn.cli.terminal import emit


def add_verbs(app: typer.Typer) -> None:
    """Add the verbs of this module to the command line."""
    app.command()(profiles)


def profiles(
    wheel: Annotated[
        str, typer.Argument(metavar="WHEEL", help="S1002, cone:1/40, arc:RADIUS or a file.")
    ],
    rail: Annotated[
        str, typer.Argument(metavar="RAIL", help="60E1, 60E1_manchester, arc:RADIUS or a file.")
    ],
    *,
    gauge: Annotated[str, typer.Option(help="Gauge; numbers are mm.")] = "1435",
    inclination: Annotated[
        str, typer.Option(help="Inclination of the rails such as 1:40; 0 if the file has it.")
    ] = "1:40",
    back_to_back: Annotated[
        str, typer.Option("--back-to-back", help="Back-to-back distance of the wheels.")
    ] = "1360",
    flange_back: Annotated[
        str, typer.Option("--flange-back", help="Tape circle from the back of its flange.")
    ] = "70",
    radius: Annotated[str, typer.Option(help="Radius of the tape circles.")] = "460",
    right_radius: Annotated[
        str | None, typer.Option("--right-radius", help="Radius of the right wheel, if different.")
    ] = None,
    right_wheel: Annotated[
        str | None, typer.Option("--right-wheel", help="Profile of the right wheel, if different.")
    ] = None,
    right_rail: Annotated[
        str | None, typer.Option("--right-rail", help="Profile of the right rail, if different.")
    ] = None,
    gauge_depth: Annotated[
        str, typer.Option("--gauge-depth", help="Depth below the top at which gauge is measured.")
    ] = "14",
    yaw: Annotated[str, typer.Option(help='Yaw of the wheelset such as "5 mrad".')] = "0",
    curve_radius: Annotated[
        str | None,
        typer.Option("--curve-radius", help='Radius such as "300 m", positive to the left.'),
    ] = None,
    shifts: Annotated[
        str, typer.Option("--shift", help="Lateral shift, or FROM:TO:STEPS, left positive.")
    ] = "-8:8:16",
    amplitudes: Annotated[
        str, typer.Option("--amplitude", help="Amplitudes of the conicity, FROM:TO:STEPS.")
    ] = "1:7:6",
    smoothing: Annotated[
        str, typer.Option(help="Smoothing: wavelength whose amplitude is halved; 0 for none.")
    ] = "0",
    defects: Annotated[
        str, typer.Option(help="Outliers and gaps of files: refuse, mend or keep.")
    ] = "refuse",
    tape_circle: Annotated[
        str | None,
        typer.Option("--tape-circle", help="Tape circle from the back of the flange in files."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Result file (HDF5) to write.")
    ] = None,
    plots: Annotated[Path | None, typer.Option(help="Folder for the figures.")] = None,
    resume: Resume = False,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Compute contact points, rolling radii, contact angles and equivalent conicity.

    Lengths without a unit are millimetres.
    """
    if output is not None:
        check_replacing(output, PROFILES, overwrite=overwrite, resume=resume)
    data = perform(
        vehicledyn.contact_geometry,
        wheel,
        rail,
        gauge=_length(gauge),
        gauge_depth=_length(gauge_depth),
        inclination=inclination,
        back_to_back=_length(back_to_back),
        flange_back=_length(flange_back),
        radius=_length(radius),
        right_wheel=right_wheel,
        right_rail=right_rail,
        right_radius=None if right_radius is None else _length(right_radius),
        yaw=yaw,
        curve_radius=None if curve_radius is None else _length(curve_radius),
        smoothing=_length(smoothing),
        defects=defects,
        tape_circle=None if tape_circle is None else _length(tape_circle),
        shifts=_lengths("--shift", shifts),
        amplitudes=[a for a in _lengths("--amplitude", amplitudes) if a > 0.0],
        save_to=output,
        overwrite=True,
        resume=resume,
        plots=plots,
    )
    show(data, as_json=as_json, plots=plots)
    for place in filter(None, () if as_json else (output, plots)):
        emit(f"written to {place}")


def _length(text: str) -> str:
    """Return a length with its unit; a number alone is in mm."""
    return f"{text} mm" if _is_number(text) else text


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def _lengths(option: str, text: str) -> list[float]:
    """Return the lengths that a value or FROM:TO:STEPS means [m]."""
    try:
        span = read_range(text)
        first, last = (to_si(_length(end), "m") for end in (span.first, span.last))
    except InputError as error:
        raise InputError(f"{option} {text}: {error}") from None
    if span.steps == 0:
        return [first]
    if last <= first:
        raise InputError(f"{option} {text}: must rise")
    return [first + (last - first) * k / span.steps for k in range(span.steps + 1)]
