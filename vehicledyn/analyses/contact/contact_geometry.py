"""Contact geometry of wheel and rail profiles: contact points against shift, conicity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.analyses.contact.contact_conicity import conicities
from vehicledyn.analyses.contact.contact_curves import (
    amplitude_grid,
    close_standings,
    curves,
    standings,
)
from vehicledyn.analyses.contact.contact_report import ContactReport
from vehicledyn.base.argument_names import argument, given
from vehicledyn.base.errors import InputError
from vehicledyn.rail.geometry.contact_geometry import GapMinima, MountedWheel, place_rail
from vehicledyn.rail.geometry.gauge_fit import check_fit
from vehicledyn.rail.geometry.wheelset_geometry import WheelsetOnTrack, WheelsetPosition, stand
from vehicledyn.rail.profiles.open_profile import open_profile
from vehicledyn.rail.profiles.profile import Profile
from vehicledyn.rail.profiles.profile_names import Kind
from vehicledyn.rail.profiles.profile_reading import AS_IT_IS, ProfileReading
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.tables.contact_table import (
    SIDES,
    ContactColumns,
    ContactTable,
    MeasuredProfile,
)

POINTS = 4
"""Local minima of the gap that are kept, a side and shift."""


LARGEST_AMPLITUDE = 0.1
"""Largest amplitude of an equivalent conicity, far beyond what any flange allows [m]."""


@dataclass(frozen=True)
class ContactRequest:
    """Which wheels stand on which track, and what is asked for; lengths in m, angles in rad.

    ``wheels`` and ``rails`` name profile or file of left and right side, ``radii`` are those of
    the tape circles, ``flange_back`` is the distance of a tape circle from the back of its flange.
    ``inclination_text`` is the slope as it was written, empty where there is only a number.
    """

    wheels: tuple[str, str]
    rails: tuple[str, str]
    radii: tuple[float, float] = (0.46, 0.46)
    gauge: float = 1.435
    gauge_depth: float = 0.014
    inclination: float = 0.0
    inclination_text: str = ""
    back_to_back: float = 1.36
    flange_back: float = 0.07
    yaw: float = 0.0
    curvature: float = 0.0
    reading: ProfileReading = AS_IT_IS
    shifts: Sequence[float] = tuple(1e-3 * k for k in range(-8, 9))
    amplitudes: Sequence[float] = tuple(1e-3 * k for k in range(1, 8))


def find_contact_geometry(
    request: ContactRequest, *, progress: Any, kept: KeptWork | None = None
) -> ContactReport:
    """Return contact points, rolling radii, angles and conicity.

    Parameters
    ----------
    request
        What is asked for.
    progress
        Called with what is being done.
    kept
        What is kept of it meanwhile.

    Raises
    ------
    InputError
        If a profile cannot be read, the wheelset does not fit the gauge or an amplitude is
        beyond 100 mm.
    """
    _check_amplitudes(request.amplitudes)
    progress("reading profiles")
    wheelset, wheels, rails = placed(request)
    facts = replace(request, reading=request.reading.model_dump_json())  # type: ignore[arg-type]
    measured = [profile.measured and profile.measured.points for profile in (*wheels, *rails)]
    memory = (kept or KeptWork()).memory(
        "profiles", facts, measured, kinds=(WheelsetPosition, GapMinima)
    )
    wheelset = replace(wheelset, memory=memory)
    progress("finding contact points")
    standing, lost = standings(wheelset, request.shifts, request.yaw)
    table = _table(request, wheelset, standing, lost, profiles=(*wheels, *rails), progress=progress)
    return ContactReport(table)


def placed(request: ContactRequest) -> tuple[WheelsetOnTrack, list[Profile], list[Profile]]:
    """Return wheels on their rails, and the profiles of wheels and rails, left before right.

    Raises
    ------
    InputError
        If a profile cannot be read, or the wheelset does not fit the gauge.
    """
    wheels = _opened(request.wheels, "wheel", request.reading)
    rails = _opened(request.rails, "rail", request.reading)
    wheelset = _placed(request, wheels, rails)
    try:
        check_fit(wheelset, request.gauge)
    except InputError as error:
        raise InputError(
            f"{error}; {given('back_to_back', 1e3 * request.back_to_back)} and "
            f"{argument('flange_back')} "
            f"{1e3 * request.flange_back:g} are taken: give what belongs to the gauge, in mm"
        ) from None
    return wheelset, wheels, rails


def _check_amplitudes(amplitudes: Sequence[float]) -> None:
    far = [each for each in amplitudes if not each <= LARGEST_AMPLITUDE]
    if far:
        raise InputError(
            f"an amplitude of {1e3 * far[0]:g} mm: at most {1e3 * LARGEST_AMPLITUDE:g} mm"
        )


def _opened(texts: Sequence[str], kind: Kind, reading: ProfileReading) -> list[Profile]:
    """Return the profiles of both sides, one and the same where they are named alike."""
    known = {text: open_profile(text, kind, reading) for text in dict.fromkeys(texts)}
    return [known[text] for text in texts]


def _placed(
    request: ContactRequest, wheels: Sequence[Profile], rails: Sequence[Profile]
) -> WheelsetOnTrack:
    half = 0.5 * request.back_to_back + request.flange_back
    placed = [
        place_rail(rail, request.inclination, request.gauge, request.gauge_depth) for rail in rails
    ]
    left, right = (MountedWheel(w, r, half) for w, r in zip(wheels, request.radii, strict=True))
    return WheelsetOnTrack(left, right, placed[0], placed[1], request.curvature)


def _table(
    request: ContactRequest,
    wheelset: WheelsetOnTrack,
    standing: list[WheelsetPosition],
    lost: list[str],
    *,
    profiles: Sequence[Profile],
    progress: Any,
) -> ContactTable:
    columns = _columns(wheelset, standing)
    progress("finding jumps")
    close, jumps = close_standings(wheelset, standing)
    progress("finding the equivalent conicity")
    amplitudes = np.array(request.amplitudes, dtype=float)
    radius = 0.5 * (request.radii[0] + request.radii[1])
    base = wheelset.left_wheel.half_distance + wheelset.right_wheel.half_distance
    grid = amplitude_grid(amplitudes)
    cones, said = conicities(
        wheelset, request.yaw, np.concatenate([amplitudes, grid]), radius, base
    )
    notes = dict.fromkeys(f"{p.name}: {note}" for p in profiles for note in p.notes)
    wheel, rail = (
        " / ".join(dict.fromkeys(p.name for p in pair)) for pair in (profiles[:2], profiles[2:])
    )
    return ContactTable(
        title=f"{wheel} on {rail}, gauge {1e3 * request.gauge:g} mm",
        wheel=wheel,
        rail=rail,
        settings={
            "gauge": request.gauge,
            "gauge_depth": request.gauge_depth,
            "inclination": request.inclination,
            "back_to_back": request.back_to_back,
            "flange_back": request.flange_back,
            "radius_left": request.radii[0],
            "radius_right": request.radii[1],
            "yaw": request.yaw,
            "curvature": request.curvature,
            "smoothing": request.reading.smoothing,
        },
        shift=np.array([s.lateral for s in standing]),
        roll=np.array([s.roll for s in standing]),
        height=np.array([s.height for s in standing]),
        radius_difference=columns.radius[:, 0, 0] - columns.radius[:, 1, 0],
        contacts=columns,
        amplitude=amplitudes,
        **{name: values[: len(amplitudes)] for name, values in cones.items()},
        jumps=tuple((j.lateral, j.side, *j.places) for j in jumps),
        curves=curves(
            wheelset, close, grid, {name: v[len(amplitudes) :] for name, v in cones.items()}
        ),
        outlines=_outlines(wheelset, request),
        notes=(*notes, *_on_bridges(columns, profiles), *lost, *said),
        measured=_measured(profiles),
        inclination_text=request.inclination_text,
    )


def _measured(profiles: Sequence[Profile]) -> dict[str, MeasuredProfile]:
    """Return the profiles from files by their place, one and the same once."""
    names = ("left_wheel", "right_wheel", "left_rail", "right_rail")
    found: dict[str, MeasuredProfile] = {}
    drawn: list[Profile] = []
    for name, profile in zip(names, profiles, strict=True):
        given = profile.measured
        if given is None or any(profile is other for other in drawn):
            continue
        drawn.append(profile)
        parts = (given.points, given.distance, given.outliers, given.bridges, given.averaged)
        found[name] = MeasuredProfile(*parts)
    return found


def _on_bridges(columns: ContactColumns, profiles: Sequence[Profile]) -> list[str]:
    """Return where contact lies on a stretch of a profile that was not measured."""
    said = []
    for k, side in enumerate(SIDES):
        touching = (
            (profiles[k], columns.place, "wheel"),
            (profiles[k + 2], columns.rail_place, "rail"),
        )
        for profile, places, what in touching:
            for begin, end in [] if profile.measured is None else np.sort(profile.measured.bridges):
                inside = (places[:, k, 0] > begin) & (places[:, k, 0] < end)
                if inside.any():
                    said.append(
                        f"{int(inside.sum())} of {len(inside)} contacts of the {side} {what} lie "
                        f"on a bridged gap, y = {1e3 * begin:.4g} to {1e3 * end:.4g} mm: nothing "
                        "was measured there"
                    )
    return said


def _columns(wheelset: WheelsetOnTrack, standing: list[WheelsetPosition]) -> ContactColumns:
    shape = (len(standing), len(SIDES), POINTS)
    names = ("place", "rail_place", "x", "y", "z", "radius", "angle", "gap")
    found = {name: np.full(shape, np.nan) for name in names}
    pairs = (
        (wheelset.left_wheel, wheelset.left_rail),
        (wheelset.right_wheel, wheelset.right_rail),
    )
    for n, position in enumerate(standing):
        for k, (wheel, rail) in enumerate(pairs):
            touch: GapMinima = getattr(position, SIDES[k])
            count = min(POINTS, len(touch.gap))
            for name in ("place", "x", "y", "z", "gap"):
                found[name][n, k, :count] = getattr(touch, name)[:count]
            place, y, z = found["place"][n, k], found["y"][n, k], found["z"][n, k]
            found["rail_place"][n, k] = rail.on_profile(y, z - found["gap"][n, k])
            found["radius"][n, k] = wheel.radius + wheel.table.height(place)
            found["angle"][n, k, :count] = np.arctan(touch.slope[:count])
    return ContactColumns(**found)


def _outlines(wheelset: WheelsetOnTrack, request: ContactRequest) -> dict[str, Any]:
    """Return the profiles as they stand at no shift, for pictures."""
    position = stand(wheelset, 0.0, request.yaw)
    outlines = {}
    for side in SIDES:
        wheel: MountedWheel = getattr(wheelset, f"{side}_wheel")
        surface = getattr(wheelset, f"{side}_rail").surface
        places = np.linspace(wheel.table.begin, wheel.table.end, 400)
        heights = position.height - wheel.radius - wheel.table.height(places)
        outlines[f"{side}_wheel"] = np.column_stack([wheel.half_distance + places, heights])
        outlines[f"{side}_wheel_begin"] = np.array([[places[0], heights[0]]])
        y = np.linspace(surface.begin, surface.end, 300)
        outlines[f"{side}_rail"] = np.column_stack([y, surface.height(y)])
    return outlines


def _draw(table: ContactTable, folder: Path) -> None:
    from vehicledyn.results.plots.contact_figures import contact_figures
    from vehicledyn.results.plots.picture_files import save_figures

    save_figures(contact_figures(table), folder, ("png", "svg"))
