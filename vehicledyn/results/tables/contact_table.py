"""Contact geometry of a wheelset on a track as a table and as a result file."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.base.slope_text import slope_text
from vehicledyn.results.store.consistency import Sizes
from vehicledyn.results.store.linear_file import (
    new_file,
    old_file,
    read_texts,
    write_axis,
    write_numbers,
    write_texts,
)

FORMAT = "vehicledyn-profiles"
SIDES = ("left", "right")


@dataclass(frozen=True)
class ContactColumns:
    """What is known of every contact, arrays of shape (n_shifts, 2, n_points), nan where none.

    Sides are left and right; points are ordered by their gap: the first touches, further ones are
    local minima of the gap, which touch too where their gap is zero.
    """

    place: Any
    rail_place: Any
    x: Any
    y: Any
    z: Any
    radius: Any
    angle: Any
    gap: Any


@dataclass(frozen=True)
class ContactCurves:
    """Contact at close shifts and conicity at close amplitudes, for pictures.

    ``shift`` is of shape (n,) with one value close before and one close behind each jump,
    ``place`` on the wheels and ``angle`` of shape (n, 2), ``radius_difference`` (n,) [m, rad];
    ``amplitude``, ``conicity`` and ``conicity_with_roll`` of shape (k,) [m, 1].
    """

    shift: Any
    place: Any
    angle: Any
    radius_difference: Any
    amplitude: Any
    conicity: Any
    conicity_with_roll: Any


@dataclass(frozen=True)
class MeasuredProfile:
    """What a profile from a file was made of, in its own axes.

    ``points`` are those that the curve follows, shape (n, 2), ``distance`` how far each lies
    from it, shape (n,), ``outliers`` those left out, shape (k, 2), ``bridges`` the lateral
    coordinates of both ends of each bridged gap, shape (m, 2), ``averaged`` the points of the file
    that a mean stands for, as noise puts them out of order, shape (j, 2) [m].
    """

    points: Any
    distance: Any
    outliers: Any
    bridges: Any
    averaged: Any


_MEASURED = {
    "points": ("m", "Lateral coordinate and height of the points used"),
    "distance": ("m", "Distance of the points from the curve"),
    "outliers": ("m", "Lateral coordinate and height of the points left out"),
    "bridges": ("m", "Lateral coordinates of both ends of bridged gaps"),
    "averaged": ("m", "Lateral coordinate and height of points that a mean stands for"),
}

COLUMNS = {
    "place": ("m", "Lateral coordinate on the wheel, outwards from the tape circle"),
    "rail_place": ("m", "Lateral coordinate on the rail's profile, outwards from its axis"),
    "x": ("m", "Contact point forward of the axle"),
    "y": ("m", "Contact point outwards from the middle of the track"),
    "z": ("m", "Contact point over the rails' highest points"),
    "radius": ("m", "Rolling radius"),
    "angle": ("rad", "Contact angle, positive where the rail rises outwards"),
    "gap": ("m", "Vertical gap"),
}


@dataclass(frozen=True)
class ContactTable:
    """Contact points against lateral shift, equivalent conicity against amplitude.

    ``shift`` is positive to the left, ``roll`` when the left side is up, ``height`` is that of
    the axle over the rails' highest points, each of shape (n_shifts,) [m, rad, m].
    ``radius_difference`` is left less right [m]. Conicities have the shape of ``amplitude`` [m]:
    ``conicity`` after EN 15302, which neglects roll, ``conicity_with_roll`` with it,
    ``conicity_harmonic`` and ``conicity_regression`` by linearisation, without roll. ``jumps``
    hold shift, side, place before and after. ``curves`` are as close as pictures need.
    ``outlines`` are the profiles as placed at no shift, lateral distance from the middle of the
    track and height, each of shape (n, 2) [m]. ``measured`` are the profiles from files.
    """

    title: str
    wheel: str
    rail: str
    settings: dict[str, float]
    shift: Any
    roll: Any
    height: Any
    radius_difference: Any
    contacts: ContactColumns
    amplitude: Any
    conicity: Any
    conicity_with_roll: Any
    conicity_harmonic: Any
    conicity_regression: Any
    jumps: tuple[tuple[float, str, float, float], ...]
    curves: ContactCurves
    outlines: dict[str, Any]
    notes: tuple[str, ...]
    measured: dict[str, MeasuredProfile] = field(default_factory=dict)
    inclination_text: str = ""

    @property
    def lean(self) -> str:
        """The inclination of the rails as it was written, else as railways write it."""
        return self.inclination_text or slope_text(self.settings["inclination"])


_HEAD = {
    "title",
    "inclination_text",
    "wheel",
    "rail",
    "format",
    "format_version",
    "created",
    "vehicledyn_version",
}
_SHIFT = ("m", "Lateral shift, positive to the left")
_AMPLITUDE = ("m", "Amplitude of the lateral motion")
_BY_SHIFT = {
    "roll": ("rad", "Roll, positive when the left side is up"),
    "height": ("m", "Height of the axle over the rails' highest points"),
    "radius_difference": ("m", "Rolling radius difference, left less right"),
}
_BY_AMPLITUDE = {
    "conicity": ("1", "Equivalent conicity after EN 15302, roll neglected"),
    "conicity_with_roll": ("1", "Equivalent conicity with the roll of the wheelset"),
    "conicity_harmonic": ("1", "Conicity by harmonic linearisation, roll neglected"),
    "conicity_regression": ("1", "Conicity by linear regression, roll neglected"),
}


def write_contacts(path: Path, table: ContactTable) -> None:
    """Write a table to a file.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    head = {"title": table.title, "wheel": table.wheel, "rail": table.rail}
    if table.inclination_text:
        head["inclination_text"] = table.inclination_text
    with new_file(path, FORMAT, head | table.settings) as file:
        shift = write_axis(file, "shift", np.asarray(table.shift, float), _SHIFT)
        amplitude = write_axis(file, "amplitude", np.asarray(table.amplitude, float), _AMPLITUDE)
        side = write_texts(file, "side", SIDES)
        side.make_scale("side")
        for name, words in _BY_SHIFT.items():
            write_numbers(file, name, getattr(table, name), (shift,), words)
        for name, words in _BY_AMPLITUDE.items():
            write_numbers(file, name, getattr(table, name), (amplitude,), words)
        contacts = file.create_group("contact")
        for name, words in COLUMNS.items():
            write_numbers(contacts, name, getattr(table.contacts, name), (shift, side), words)
        jumps = file.create_group("jumps")
        for name, column in (("shift", 0), ("from", 2), ("to", 3)):
            values = [jump[column] for jump in table.jumps]
            words = ("m", "Shift" if column == 0 else f"Place on the wheel, {name}")
            write_numbers(jumps, name, values, (), words)
        write_texts(jumps, "side", [jump[1] for jump in table.jumps])
        _write_curves(file.create_group("curves"), table.curves)
        outlines = file.create_group("outlines")
        for name, points in table.outlines.items():
            write_numbers(outlines, name, points, (), ("m", "Lateral distance and height"))
        _write_measured(file.create_group("measured"), table.measured)
        write_texts(file, "notes", table.notes)


def read_contacts(path: Path) -> ContactTable:
    """Return the table in a file.

    Raises
    ------
    InputError
        If the file cannot be read or holds something else.
    """
    with old_file(path, FORMAT) as file:
        settings = {name: float(v) for name, v in file.attrs.items() if name not in _HEAD}
        sizes = Sizes()
        by_axis = {"shift": ("shift", *_BY_SHIFT), "amplitude": ("amplitude", *_BY_AMPLITUDE)}
        arrays: dict[str, Any] = {
            name: sizes.fit(name, file[name][()], f"{axis}s", gaps=name != axis)
            for axis, names in by_axis.items()
            for name in names
        }
        if not len(arrays["shift"]):
            raise ValueError("it holds no shift")
        columns = {
            f.name: sizes.fit(f.name, file["contact"][f.name][()], "shifts", 2, "points", gaps=True)
            for f in fields(ContactColumns)
        }
        contacts = ContactColumns(**columns)
        return ContactTable(
            title=str(file.attrs["title"]),
            wheel=str(file.attrs["wheel"]),
            rail=str(file.attrs["rail"]),
            settings=settings,
            contacts=contacts,
            curves=_read_curves(file, arrays, contacts),
            jumps=_read_jumps(file["jumps"]),
            outlines=_read_outlines(file["outlines"]),
            notes=tuple(read_texts(file, "notes")),
            measured=_read_measured(file["measured"]) if "measured" in file else {},
            inclination_text=str(file.attrs.get("inclination_text", "")),
            **arrays,
        )


def _write_measured(group: Any, profiles: dict[str, MeasuredProfile]) -> None:
    for name, profile in profiles.items():
        inner = group.create_group(name)
        for part, words in _MEASURED.items():
            write_numbers(inner, part, getattr(profile, part), (), words)


def _read_measured(group: Any) -> dict[str, MeasuredProfile]:
    return {
        name: MeasuredProfile(**{part: _part(inner, part) for part in _MEASURED})
        for name, inner in group.items()
    }


def _part(group: Any, name: str) -> Any:
    """Return a part of a measured profile; older files know of no points averaged."""
    if name == "averaged" and name not in group:
        return np.zeros((0, 2))
    return np.asarray(group[name][()])


_CURVES = {
    "place": ("m", "Lateral coordinate on the wheel, outwards from the tape circle"),
    "angle": ("rad", "Contact angle, positive where the rail rises outwards"),
    "radius_difference": _BY_SHIFT["radius_difference"],
    "conicity": _BY_AMPLITUDE["conicity"],
    "conicity_with_roll": _BY_AMPLITUDE["conicity_with_roll"],
}


_FINE = "fine_"
"""Begins the names of the axes of curves, which the tables have too, with other values."""


def _curve(group: Any, name: str) -> Any:
    """Return a dataset of the curves; in older files their axes have the names of the tables'."""
    return group[f"{_FINE}{name}" if f"{_FINE}{name}" in group else name]


def _write_curves(group: Any, curves: ContactCurves) -> None:
    shift = write_axis(group, f"{_FINE}shift", np.asarray(curves.shift, float), _SHIFT)
    amplitude = write_axis(
        group, f"{_FINE}amplitude", np.asarray(curves.amplitude, float), _AMPLITUDE
    )
    for name, words in _CURVES.items():
        scale = amplitude if name in _BY_AMPLITUDE else shift
        write_numbers(group, name, getattr(curves, name), (scale,), words)


_CURVE_AXES: dict[str, tuple[str | int, ...]] = {
    "shift": ("shifts",),
    "place": ("shifts", 2),
    "angle": ("shifts", 2),
    "radius_difference": ("shifts",),
    "amplitude": ("amplitudes",),
    "conicity": ("amplitudes",),
    "conicity_with_roll": ("amplitudes",),
}


def _read_outlines(group: Any) -> dict[str, Any]:
    outlines = {
        name: Sizes().fit(name, points[()], "points", 2, gaps=True)
        for name, points in group.items()
    }
    for side in SIDES:
        for part in ("wheel", "rail", "wheel_begin"):
            if not len(outlines[f"{side}_{part}"]):
                raise ValueError(f"the outline {side}_{part} has no points")
    return outlines


def _read_curves(file: Any, arrays: dict[str, Any], contacts: ContactColumns) -> ContactCurves:
    """Return the curves of a file; those of its table if it was written without."""
    if "curves" in file:
        group = file["curves"]
        sizes = Sizes()
        return ContactCurves(
            **{
                name: sizes.fit(name, _curve(group, name)[()], *axes, gaps=True)
                for name, axes in _CURVE_AXES.items()
            }
        )
    known = {f.name: arrays[f.name] for f in fields(ContactCurves) if f.name in arrays}
    return ContactCurves(place=contacts.place[:, :, 0], angle=contacts.angle[:, :, 0], **known)


def _read_jumps(group: Any) -> tuple[tuple[float, str, float, float], ...]:
    sizes, sides = Sizes(), read_texts(group, "side")
    sizes.count("side", sides, "jumps")
    columns = (sizes.read(group, name, "jumps").tolist() for name in ("shift", "from", "to"))
    shifts, before, after = columns
    return tuple(zip(shifts, sides, before, after, strict=True))
