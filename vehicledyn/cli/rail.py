"""Verbs on wheels and rails."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vehicledyn.base.errors import InputError
from vehicledyn.base.ranges import read_range
from vehicledyn.base.units import to_si
from vehicledyn.cli.options import Json
from vehicledyn.cli.replacing import PROFILES, Overwrite, check_replacing
from vehicledyn.cli.terminal import emit_report, show_progress

if TYPE_CHECKING:
    from vehicledyn.rail.profiles.profile_reading import ProfileReading

_METRE = 1e3
_LONGEST_WAVE, _NEAREST_BACK, _FURTHEST_BACK = 0.1, 0.02, 0.15


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
        str, typer.Option("--back-to-back", help="Distance of the backs of the flanges.")
    ] = "1360",
    flange_back: Annotated[
        str, typer.Option("--flange-back", help="Tape circle from the back of its flange.")
    ] = "70",
    radius: Annotated[str, typer.Option(help="Radius of the tape circles.")] = "460",
    right_radius: Annotated[
        str | None, typer.Option("--right-radius", help="That of the right wheel, if another.")
    ] = None,
    right_wheel: Annotated[
        str | None, typer.Option("--right-wheel", help="Profile of the right wheel, if another.")
    ] = None,
    right_rail: Annotated[
        str | None, typer.Option("--right-rail", help="Profile of the right rail, if another.")
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
        str, typer.Option(help="Wavelength of which smoothing of files leaves half; 0 for none.")
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
    plots: Annotated[Path | None, typer.Option(help="Folder of the pictures.")] = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> None:
    """Find contact points, rolling radii, angles and equivalent conicity of profiles.

    Lengths without a unit are millimetres.
    """
    if output is not None:
        check_replacing(output, PROFILES, overwrite=overwrite)
    radii = (_length("--radius", radius), _length("--right-radius", right_radius or radius))
    values = {
        "gauge": _positive("--gauge", gauge),
        "gauge_depth": _positive("--gauge-depth", gauge_depth),
        "back_to_back": _positive("--back-to-back", back_to_back),
        "flange_back": _length("--flange-back", flange_back),
    }
    reading = _reading(smoothing, defects, tape_circle)
    if min(radii) <= 0.0:
        raise InputError("--radius: must be above zero")
    wanted = _lengths("--shift", shifts)
    found = [a for a in _lengths("--amplitude", amplitudes) if a > 0.0]
    angle = _angle(inclination)
    turn = _yaw(yaw)
    curvature = 0.0 if curve_radius is None else 1.0 / _curve(curve_radius)
    from vehicledyn.analyses.contact.contact_geometry import ContactWish, find_contact_geometry

    wish = ContactWish(
        wheels=(wheel, right_wheel or wheel),
        rails=(rail, right_rail or rail),
        radii=radii,
        inclination=angle,
        yaw=turn,
        curvature=curvature,
        reading=reading,
        shifts=wanted,
        amplitudes=found,
        **values,
    )
    with show_progress() as progress:
        report = find_contact_geometry(wish, output=output, plots=plots, progress=progress)
    emit_report(report, as_json=as_json)


def _reading(smoothing: str, defects: str, tape_circle: str | None) -> ProfileReading:
    from typing import get_args

    from vehicledyn.rail.profiles.profile_reading import Defects, ProfileReading

    wavelength = _length("--smoothing", smoothing)
    if not 0.0 <= wavelength <= _LONGEST_WAVE:
        words = "must not be negative" if wavelength < 0.0 else "must be 100 mm or less"
        raise InputError(f"--smoothing {smoothing}: {words}")
    if defects not in get_args(Defects):
        raise InputError(f"--defects {defects}: choose {', '.join(get_args(Defects))}")
    back = None if tape_circle is None else _length("--tape-circle", tape_circle)
    if back is not None and not _NEAREST_BACK < back < _FURTHEST_BACK:
        raise InputError(f"--tape-circle {tape_circle}: must be between 20 and 150 mm")
    return ProfileReading.model_validate(
        {"smoothing": wavelength, "defects": defects, "tape_circle": back}
    )


def _length(option: str, text: str) -> float:
    """Return a length in m; a number alone is in mm."""
    try:
        return float(text) / _METRE if _is_number(text) else to_si(text, "m")
    except InputError as error:
        raise InputError(f"{option} {text}: {error}") from None


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def _positive(option: str, text: str) -> float:
    value = _length(option, text)
    if value <= 0.0:
        raise InputError(f"{option} {text}: must be above zero")
    return value


def _lengths(option: str, text: str) -> list[float]:
    try:
        span = read_range(text)
    except InputError as error:
        raise InputError(f"{option} {error}") from None
    first, last = _length(option, span.first), _length(option, span.last)
    if span.steps == 0:
        return [first]
    if last <= first:
        raise InputError(f"{option} {text}: must rise")
    return [first + (last - first) * k / span.steps for k in range(span.steps + 1)]


def _angle(text: str) -> float:
    from vehicledyn.base.slope_text import slope_of

    slope = slope_of(text)
    if slope is None or not abs(slope) < 0.5:
        raise InputError(f"--inclination {text}: write a slope such as 1:40, 1/20 or 0")
    return math.atan(slope)


def _yaw(text: str) -> float:
    try:
        angle = to_si(float(text) if _is_number(text) else text, "rad")
    except InputError as error:
        raise InputError(f"--yaw {text}: {error}") from None
    if not abs(angle) < 0.2:
        raise InputError(f"--yaw {text}: must be below 0.2 rad")
    return angle


def _curve(text: str) -> float:
    radius = to_si(text, "m") if not _is_number(text) else float(text) / _METRE
    if abs(radius) < 5.0:
        raise InputError(f"--curve-radius {text}: must be 5 m or more; write its unit: '300 m'")
    return radius
