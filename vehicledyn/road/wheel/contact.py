"""Contact of a thin disc or a torus with the ground: point, frame, deflection and road camber.

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

A torus has a round tread of the radius c, the crown, about the circle of radius R - c in the
wheel plane. Its contact point is the point of the ground nearest to that circle:

    (P - C)·e_x = 0,    (P - C + (R - c) e_s)·e_lat = 0,

and the deflection is the overlap c - (C - (R - c) e_s - P)·n. A wheel that leans by γ touches the
ground beside its plane, c sin γ nearer to the foot of its centre than a disc.
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


def contact_on_plane(
    surface: RoadSurface,
    centre: Vec,
    spin_axis: Vec,
    radius: Scalar,
    *,
    crown: Scalar | None = None,
) -> Contact:
    """Return the contact with ground that is one plane, in closed form.

    P = C - r e_s with r = (C_z - z(C)) n_z / (n·e_s); n·e_s = |e_y × n|. With a crown P is the
    foot of C - (R - c) e_s on the plane.

    Parameters
    ----------
    surface
        Ground with ``is_flat``.
    centre, spin_axis
        Wheel centre [m] and unit spin axis, world axes.
    radius
        Unloaded radius [m].
    crown
        Radius c of the tread across the wheel; None for a thin disc [m].
    """
    x, y, z = centre[0], centre[1], centre[2]
    normal = ground_normal(surface, x, y)
    if crown is not None:
        _, spoke, _ = wheel_axes(spin_axis, normal)
        height = (z - surface.height(x, y)) * normal[2] - (radius - crown) * ops.dot(spoke, normal)
        reach = (crown - radius) * spoke - height * normal
        return _contact_of_torus(centre, spin_axis, normal, reach, (radius, crown))
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
    crown: Scalar | None = None,
) -> Contact:
    """Return the contact when P is known to lie at a horizontal offset from the centre.

    Parameters
    ----------
    surface, centre, spin_axis, radius
        As in :func:`contact_on_plane`, for any ground.
    offset
        P_x - C_x and P_y - C_y that fulfil :func:`contact_residuals` [m].
    crown
        As in :func:`contact_on_plane` [m].
    """
    reach = _reach(surface, centre, offset)
    normal = ground_normal(surface, centre[0] + offset[0], centre[1] + offset[1])
    if crown is not None:
        return _contact_of_torus(centre, spin_axis, normal, reach, (radius, crown))
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
    surface: RoadSurface,
    centre: Vec,
    spin_axis: Vec,
    offset: tuple[Scalar, Scalar],
    *,
    torus: tuple[Scalar, Scalar] | None = None,
) -> tuple[Scalar, Scalar]:
    """Return (P - C)·e_x(P) and (P - C)·e_y, zero at the contact point [m, m].

    Of a ``torus`` with radius and crown the latter is (P - C + (R - c) e_s)·e_lat.
    """
    reach = _reach(surface, centre, offset)
    normal = ground_normal(surface, centre[0] + offset[0], centre[1] + offset[1])
    longitudinal, spoke, _ = wheel_axes(spin_axis, normal)
    along = ops.dot(reach, longitudinal)
    if torus is None:
        return along, ops.dot(reach, spin_axis)
    radius, crown = torus
    lateral = ops.cross(normal, longitudinal)
    return along, ops.dot(reach + (radius - crown) * spoke, lateral)


def _contact_of_torus(
    centre: Vec, spin_axis: Vec, normal: Vec, reach: Vec, size: tuple[Scalar, Scalar]
) -> Contact:
    """Return the contact of a torus, of radius and crown, whose point lies ``reach`` from C."""
    radius, crown = size
    longitudinal, spoke, cosine = wheel_axes(spin_axis, normal)
    return Contact(
        position=centre + reach,
        longitudinal=longitudinal,
        lateral=ops.cross(normal, longitudinal),
        normal=normal,
        loaded_radius=-ops.dot(reach, spoke),
        deflection=crown + ops.dot(reach + (radius - crown) * spoke, normal),
        camber=ops.atan(ops.dot(normal, spin_axis) / cosine),
    )


def _reach(surface: RoadSurface, centre: Vec, offset: tuple[Scalar, Scalar]) -> Vec:
    height = surface.height(centre[0] + offset[0], centre[1] + offset[1])
    return ops.vector(offset[0], offset[1], height - centre[2])


def wheel_axes(spin_axis: Vec, normal: Vec) -> tuple[Vec, Vec, Scalar]:
    """Return e_x, the upward spoke e_s and n·e_s; finite for a wheel that lies flat."""
    along = ops.cross(spin_axis, normal)
    cosine = ops.sqrt(floored(ops.dot(along, along), AXIS_FLOOR**2))
    longitudinal = along / cosine
    return longitudinal, ops.cross(longitudinal, spin_axis), cosine
