"""Contact of a thin disc with the ground: the point, its frame, deflection and road camber.

The disc has the centre C, the unit spin axis e_y and the radius R. Its contact point P is
the point of the ground with

    (P - C)·e_y = 0,    (P - C)·e_x(P) = 0,    e_x = e_y × n / |e_y × n|,

n the unit normal of the ground at P: P lies in the wheel plane, straight below the centre as
seen along the ground. The contact frame is e_x forward, e_lat = n × e_x to the left and n up.
The deflection is R less the distance of P from C. All vectors are in world axes.

On one plane the solution is in closed form. On other ground the horizontal offset of P from C
is unknown and solved from the two lengths above. The solution nearest to the foot below the
centre is meant; it is the only one while the distance of the ground is less than the ground's
smallest radius of curvature.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from vehicledyn.road.surfaces.surface import RoadSurface, ground_normal
from vehicledyn.road.tyres.smooth import floored
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec

AXIS_FLOOR = 1e-3
"""Sine of the angle between spin axis and normal that is never divided by less [1]."""


@dataclass(frozen=True)
class Contact:
    """Contact point of a disc: expressions, or numbers from the search for one contact.

    Attributes
    ----------
    position
        Contact point P, world axes [m].
    longitudinal, lateral, normal
        Unit vectors e_x, e_lat and n of the contact frame, world axes.
    loaded_radius
        Distance of P from the wheel centre, negative below ground [m].
    deflection
        Radius less the loaded radius; negative when the wheel is lifted [m].
    camber
        Angle of the spin axis above the ground, atan(n·e_y / n·e_s) with e_s = e_x × e_y;
        positive when the wheel leans to the right, ISO 8855 [rad].
    """

    position: Any
    longitudinal: Any
    lateral: Any
    normal: Any
    loaded_radius: Any
    deflection: Any
    camber: Any


def contact_on_plane(surface: RoadSurface, centre: Vec, spin_axis: Vec, radius: Scalar) -> Contact:
    """Return the contact with ground that is one plane, in closed form.

    P = C - r e_s with r = (C_z - z(C)) n_z / (n·e_s); n·e_s = |e_y × n|.

    Parameters
    ----------
    surface
        Ground with ``is_flat``.
    centre, spin_axis
        Wheel centre [m] and unit spin axis, world axes.
    radius
        Unloaded radius [m].
    """
    x, y, z = centre[0], centre[1], centre[2]
    normal = ground_normal(surface, x, y)
    longitudinal, spoke, cosine = wheel_axes(spin_axis, normal)
    loaded_radius = (z - surface.height(x, y)) * normal[2] / cosine
    return Contact(
        position=centre - loaded_radius * spoke,
        longitudinal=longitudinal,
        lateral=ops.cross(normal, longitudinal),
        normal=normal,
        loaded_radius=loaded_radius,
        deflection=radius - loaded_radius,
        camber=ops.atan(ops.dot(normal, spin_axis) / cosine),
    )


def contact_at_offset(
    surface: RoadSurface,
    centre: Vec,
    spin_axis: Vec,
    radius: Scalar,
    *,
    offset: tuple[Scalar, Scalar],
) -> Contact:
    """Return the contact when P is known to lie at a horizontal offset from the centre.

    Parameters
    ----------
    surface, centre, spin_axis, radius
        As in :func:`contact_on_plane`, for any ground.
    offset
        P_x - C_x and P_y - C_y that fulfil :func:`contact_residuals` [m].
    """
    reach = _reach(surface, centre, offset)
    normal = ground_normal(surface, centre[0] + offset[0], centre[1] + offset[1])
    longitudinal, spoke, cosine = wheel_axes(spin_axis, normal)
    loaded_radius = -ops.dot(reach, spoke)
    return Contact(
        position=centre + reach,
        longitudinal=longitudinal,
        lateral=ops.cross(normal, longitudinal),
        normal=normal,
        loaded_radius=loaded_radius,
        deflection=radius - loaded_radius,
        camber=ops.atan(ops.dot(normal, spin_axis) / cosine),
    )


def contact_residuals(
    surface: RoadSurface, centre: Vec, spin_axis: Vec, offset: tuple[Scalar, Scalar]
) -> tuple[Scalar, Scalar]:
    """Return (P - C)·e_x(P) and (P - C)·e_y, zero at the contact point [m, m]."""
    reach = _reach(surface, centre, offset)
    normal = ground_normal(surface, centre[0] + offset[0], centre[1] + offset[1])
    longitudinal, _, _ = wheel_axes(spin_axis, normal)
    return ops.dot(reach, longitudinal), ops.dot(reach, spin_axis)


def _reach(surface: RoadSurface, centre: Vec, offset: tuple[Scalar, Scalar]) -> Vec:
    height = surface.height(centre[0] + offset[0], centre[1] + offset[1])
    return ops.vector(offset[0], offset[1], height - centre[2])


def wheel_axes(spin_axis: Vec, normal: Vec) -> tuple[Vec, Vec, Scalar]:
    """Return e_x, the upward spoke e_s and n·e_s; finite for a wheel that lies flat."""
    along = ops.cross(spin_axis, normal)
    cosine = ops.sqrt(floored(ops.dot(along, along), AXIS_FLOOR**2))
    longitudinal = along / cosine
    return longitudinal, ops.cross(longitudinal, spin_axis), cosine
