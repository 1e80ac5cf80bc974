"""A cam over a turn: table, key figures, pictures, and the profile for the milling machine."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.cams.second_cam import (
    pushing,
    second_columns,
    second_figures,
    second_items,
)
from vehicledyn.base.errors import InputError
from vehicledyn.cams.cam_file import CamFile
from vehicledyn.cams.follower import LineFollower
from vehicledyn.cams.forces import forces_of, lift_off_speed
from vehicledyn.cams.geometry import CamGeometry
from vehicledyn.results.tables.cam_drawing import Circle2, Path2, write_profile
from vehicledyn.results.tables.cam_table import CamTable, write_cam
from vehicledyn.results.tables.columns import Column

Array = NDArray[np.float64]
_FEWEST, _MOST = 360, 360_000
_STALLED, _STALLS = 0.9, 2
"""Part of the distance that is left after a doubling, and how often, where it stays."""


@dataclass(frozen=True)
class CamReport:
    """A cam over a turn, and where table, pictures and profile were written."""

    table: CamTable
    output: Path | None = None
    plots: Path | None = None
    profile: Path | None = None

    def as_text(self) -> str:
        """Return title, key figures and remarks."""
        table = self.table
        lines = [f"{table.title} ({table.follower})"]
        width = max(len(text) for _, _, text in table.figures.values())
        for value, unit, text in table.figures.values():
            lines.append(f"  {text:<{width}}  {_shown(value, unit)}")
        lines += [f"  {note}" for note in table.notes]
        lines += [f"written to {p}" for p in (self.output, self.plots, self.profile) if p]
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data, in SI; numbers that are infinite as null."""
        columns = {n: _plain(c.values) for n, c in self.table.columns.items()}
        return {
            "title": self.table.title,
            "follower": self.table.follower,
            "figures": {n: _plain([v])[0] for n, (v, _, _) in self.table.figures.items()},
            "notes": list(self.table.notes),
            "angle": _plain(self.table.angle),
            "columns": columns,
        }


def view_cam(
    cam: CamFile,
    *,
    output: Path | None = None,
    plots: Path | None = None,
    profile: Path | None = None,
    tolerance: float = 1e-6,
) -> CamReport:
    """Return a cam over a turn.

    Parameters
    ----------
    cam
        The cam, its files read.
    output, plots, profile
        Table to write (CSV or HDF5), folder of the pictures, profile (DXF or CSV); None for none.
    tolerance
        Largest distance of the profile's chords from the curve [m].

    Raises
    ------
    InputError
        If a file cannot be written, or the profile cannot be given as finely.
    """
    table = cam_table(cam)
    if output is not None:
        write_cam(output, table)
    if profile is not None:
        write_profile(profile, drawing_of(cam, tolerance))
    if plots is not None:
        from vehicledyn.results.plots.cams.cam_figures import cam_figures
        from vehicledyn.results.plots.picture_files import save_figures

        save_figures(cam_figures(table), plots, ("png", "svg"))
    return CamReport(table, output, plots, profile)


def cam_table(cam: CamFile, angles: Array | None = None) -> CamTable:
    """Return the columns of a cam at angles [rad], those of its file if None."""
    theta = cam.samples(cam.steps) if angles is None else np.asarray(angles, dtype=float)
    columns = cam_columns(cam, theta)
    return CamTable(
        cam.title,
        cam.touch.kind.replace("_", " "),
        theta,
        columns,
        key_figures(cam),
        tuple(_notes(cam)),
    )


def cam_columns(cam: CamFile, theta: Array) -> dict[str, Column]:
    """Return what is known of a cam at angles [rad], by name."""
    geometry = cam.geometry(theta)
    motion, unit = geometry.motion, "rad" if cam.touch.rocks else "m"
    word = "Swing" if cam.touch.rocks else "Lift"
    per = "1" if cam.touch.rocks else "m/rad"
    found = {
        "lift": Column(unit, f"{word} of the follower", motion.coordinate - cam.start),
        "velocity": Column(per, f"{word} by the angle of the cam", motion.slope),
        "acceleration": Column(
            "1/rad" if cam.touch.rocks else "m/rad^2", f"{word} by the angle, twice", motion.second
        ),
    }
    if cam.curve is not None:
        jerk = cam.curve.derivatives(np.mod(theta, 2.0 * math.pi))[3]
        name = "1/rad^2" if cam.touch.rocks else "m/rad^3"
        found["jerk"] = Column(name, f"{word} by the angle, three times", jerk)
    meaning = "Angle of the follower" if cam.touch.rocks else "Height of roller's centre or face"
    found |= {
        "position": Column(unit, meaning, motion.coordinate),
        "pressure_angle": Column("rad", "Pressure angle", geometry.pressure_angle),
        "pitch_x": Column("m", "Pitch curve, x in axes of the cam", geometry.pitch[0]),
        "pitch_y": Column("m", "Pitch curve, y in axes of the cam", geometry.pitch[1]),
        "profile_x": Column("m", "Profile, x in axes of the cam", geometry.profile[0]),
        "profile_y": Column("m", "Profile, y in axes of the cam", geometry.profile[1]),
        "pitch_radius": Column(
            "m",
            "Radius of curvature of the pitch curve, positive where convex",
            geometry.pitch_radius,
        ),
        "profile_radius": Column(
            "m",
            "Radius of curvature of the profile, positive where convex",
            geometry.profile_radius,
        ),
    }
    if geometry.along is not None:
        found["contact_place"] = Column("m", "Place of the contact on the face", geometry.along)
    return found | second_columns(cam, theta) | _force_columns(cam, geometry)


def _force_columns(cam: CamFile, geometry: CamGeometry) -> dict[str, Column]:
    if cam.load is None:
        return {}
    torque = forces_of(cam, cam.load, geometry).torque
    first, second = pushing(cam, geometry)
    words = "Normal force; negative would pull" if second is None else "Normal force"
    found = {
        "normal_force": Column("N", words, first),
        "torque": Column("N*m", "Torque that turns the cam", torque),
    }
    if second is not None:
        found["second_normal_force"] = Column("N", "Normal force on the second cam", second)
    return found


def key_figures(cam: CamFile) -> dict[str, tuple[float, str, str]]:
    """Return extremes over a turn, by name, with unit and meaning."""
    theta = cam.samples(max(cam.steps, 3600))
    geometry = cam.geometry(theta)
    motion = geometry.motion
    unit = "rad" if cam.touch.rocks else "m"
    lift = motion.coordinate - cam.start
    rises, falls = motion.slope > 0.0, motion.slope < 0.0
    pressure = np.abs(geometry.pressure_angle)
    convex = geometry.profile_radius[geometry.profile_radius > 0.0]
    hollow = geometry.profile_radius[geometry.profile_radius < 0.0]
    found = {
        "greatest_lift": (float(lift.max()), unit, "Greatest lift"),
        "pressure_rise": (_most(pressure, rises), "rad", "Greatest pressure angle of rises"),
        "pressure_fall": (_most(pressure, falls), "rad", "Greatest pressure angle of falls"),
        "convex_radius": (_least(convex), "m", "Least convex radius of the profile"),
        "hollow_radius": (_least(-hollow), "m", "Least hollow radius of the profile"),
        "greatest_velocity": (
            float(np.abs(motion.slope).max()),
            f"{unit}/rad",
            "Greatest velocity",
        ),
        "greatest_acceleration": (
            float(np.abs(motion.second).max()),
            f"{unit}/rad^2",
            "Greatest acceleration",
        ),
    }
    if geometry.along is not None:
        found["face_from"] = (float(geometry.along.min()), "m", "Contact on the face, from")
        found["face_to"] = (float(geometry.along.max()), "m", "Contact on the face, to")
    found |= second_figures(cam, theta)
    if cam.load is not None:
        torque = forces_of(cam, cam.load, geometry).torque
        first, second = pushing(cam, geometry)
        found["least_force"] = (float(first.min()), "N", "Least normal force")
        found["greatest_force"] = (float(first.max()), "N", "Greatest normal force")
        found["greatest_torque"] = (float(np.abs(torque).max()), "N*m", "Greatest torque")
        if second is not None:
            words = "Greatest normal force on the second cam"
            found["second_greatest_force"] = (float(second.max()), "N", words)
        limit = None if second is not None else lift_off_speed(cam, cam.load)
        if limit is not None:
            found["lift_off_speed"] = (limit[0], "rad/s", "Speed at which the follower lifts off")
            found["lift_off_angle"] = (limit[1], "rad", "where it does")
    return found


def drawing_of(cam: CamFile, tolerance: float) -> list[Path2 | Circle2]:
    """Return profile, pitch curve and base circle; chords keep within a tolerance [m].

    Raises
    ------
    InputError
        If the profile would need more points than any machine takes, or jumps, as where a flat
        follower bridges hollow parts of an outline.
    """
    count, stalled, before = _FEWEST, 0, math.inf
    while (distance := _sagitta(cam, count)) > tolerance:
        stalled = stalled + 1 if distance > _STALLED * before else 0
        if stalled == _STALLS:
            raise InputError(
                f"chords of the profile stay {1e6 * distance:.3g} um from it however many there "
                "are: the follower bridges parts of the cam that it does not touch; take a "
                "follower that reaches them, or another outline"
            )
        before = distance
        count *= 2
        if count > _MOST:
            raise InputError(
                f"the profile needs more than {_MOST} points for a tolerance of "
                f"{1e6 * tolerance:g} um; give a larger tolerance"
            )
    theta = cam.samples(count)
    is_plane = cam.touch.shape != "axial"
    geometry = cam.geometry(theta[:-1] if is_plane else theta)
    items: list[Path2 | Circle2] = [Path2("PROFILE", geometry.profile.T, is_plane)]
    if not isinstance(cam.touch, LineFollower):
        items.append(Path2("PITCH", geometry.pitch.T, is_plane))
    if is_plane:
        least = float(np.hypot(*geometry.profile).min())
        items += [Circle2("BASE", (0.0, 0.0), least), Circle2("AXIS", (0.0, 0.0), 1e-3)]
        items += second_items(cam, theta[:-1])
    return items


def _sagitta(cam: CamFile, count: int) -> float:
    """Return the largest distance of the profile from the chords of a number of points [m]."""
    points = cam.geometry(cam.samples(2 * count)).profile
    middle = 0.5 * (points[:, :-2:2] + points[:, 2::2])
    return float(np.hypot(*(points[:, 1::2] - middle)).max())


def _notes(cam: CamFile) -> list[str]:
    """Return remarks on jumps of the acceleration and forces that pull."""
    notes = []
    if cam.curve is not None:
        most = float(np.abs(cam.curve.derivatives(cam.samples(720))[2]).max())
        jumps = [math.degrees(at) for at, j in cam.curve.jumps(2) if abs(j) > 1e-9 * most]
        if jumps:
            listed = ", ".join(f"{at % 360.0:.4g}" for at in jumps)
            notes.append(f"the acceleration jumps at {listed} deg, which excites vibrations")
    if cam.load is not None and cam.conjugate is None:
        geometry = cam.geometry(cam.samples(3600))
        pulls = forces_of(cam, cam.load, geometry).normal < 0.0
        if pulls.any():
            at = np.degrees(geometry.motion.theta[pulls])
            notes.append(
                f"the normal force is below zero from {at[0]:.4g} to {at[-1]:.4g} deg at this "
                "speed: the follower lifts off there; take a stronger spring or less speed"
            )
    return notes


def _most(values: Array, where: NDArray[np.bool_]) -> float:
    return float(values[where].max()) if where.any() else 0.0


def _least(values: Array) -> float:
    return float(values.min()) if values.size else math.inf


def _shown(value: float, unit: str) -> str:
    if not math.isfinite(value):
        return "none"
    if unit == "rad":
        return f"{math.degrees(value):.5g} deg"
    if unit.startswith("m") and unit != "m/s":
        return f"{1e3 * value:.5g} m{unit}"
    return f"{value:.5g} {unit}"


def _plain(values: Any) -> list[float | None]:
    return [float(v) if math.isfinite(v) else None for v in np.asarray(values, dtype=float)]
