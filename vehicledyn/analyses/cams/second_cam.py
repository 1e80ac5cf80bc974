"""The second cam of a conjugate pair: its columns, key figures, forces and drawing."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vehicledyn.cams.cam_file import CamFile
from vehicledyn.cams.follower import LineFollower
from vehicledyn.cams.forces import forces_of
from vehicledyn.cams.geometry import CamGeometry
from vehicledyn.cams.opposite import OppositeCam, opposite_of
from vehicledyn.results.tables.cam_drawing import Circle2, Path2
from vehicledyn.results.tables.columns import Column

Array = NDArray[np.float64]


def second_columns(cam: CamFile, theta: Array) -> dict[str, Column]:
    """Return what is known of the second cam at angles [rad], by name; nothing of a single cam."""
    second = opposite_of(cam)
    if second is None:
        return {}
    found = second.in_axes_of_first(second.geometry(theta))
    words = "of the second cam, {} in axes of the cam"
    columns = {
        "second_pressure_angle": Column(
            "rad", "Pressure angle on the second cam", found.pressure_angle
        ),
        "second_profile_radius": Column(
            "m",
            "Radius of curvature of the second profile, positive where convex",
            found.profile_radius,
        ),
    }
    for name, points in (("pitch", found.pitch), ("profile", found.profile)):
        title = "Pitch curve" if name == "pitch" else "Profile"
        for axis, values in zip("xy", points, strict=True):
            text = f"{title} {words.format(axis)}"
            columns[f"second_{name}_{axis}"] = Column("m", text, values)
    return columns


def second_figures(cam: CamFile, theta: Array) -> dict[str, tuple[float, str, str]]:
    """Return extremes of the second cam over a turn, by name, with unit and meaning."""
    second = opposite_of(cam)
    if second is None:
        return {}
    geometry = second.geometry(theta)
    convex = geometry.profile_radius[geometry.profile_radius > 0.0]
    return {
        "second_pressure": (
            float(np.abs(geometry.pressure_angle).max()),
            "rad",
            "Greatest pressure angle on the second cam",
        ),
        "second_convex_radius": (
            float(convex.min()) if convex.size else math.inf,
            "m",
            "Least convex radius of the second profile",
        ),
    }


def pushing(cam: CamFile, geometry: CamGeometry) -> tuple[Array, Array | None]:
    """Return the normal forces on both cams [N], shape (n,); of a pair only one pushes at a time.

    That of a single cam is negative where it would pull.
    """
    if cam.load is None:
        raise ValueError("the cam moves nothing")
    normal = forces_of(cam, cam.load, geometry).normal
    second = opposite_of(cam)
    if second is None:
        return normal, None
    lever = second.geometry(geometry.motion.theta).lever
    return np.maximum(normal, 0.0), np.maximum(-normal * geometry.lever, 0.0) / lever


def second_items(cam: CamFile, theta: Array) -> list[Path2 | Circle2]:
    """Return profile and pitch curve of the second cam at angles [rad], on layers of their own."""
    second = opposite_of(cam)
    if second is None:
        return []
    return _paths(second, theta)


def _paths(second: OppositeCam, theta: Array) -> list[Path2 | Circle2]:
    found = second.in_axes_of_first(second.geometry(theta))
    items: list[Path2 | Circle2] = [Path2("PROFILE_2", found.profile.T)]
    if not isinstance(second.touch, LineFollower):
        items.append(Path2("PITCH_2", found.pitch.T))
    return items
