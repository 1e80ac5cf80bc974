"""Contacts that look straight down: with the ground's tangent plane at the foot below the wheel.

The ground is taken as its tangent plane at the foot F, vertically below the wheel centre C, with
the unit normal n. The deflection is the vertical one, whatever the camber, in the direction of
the normal: n_z (R - (C_z - F_z)). The contact point lies on the spoke e_s = e_x × e_y at the
loaded radius r, P = C - r e_s. Of this radius there are two rules:

- the Iltis benchmark's, r = (C_z - Q_z) / e_s,z, with Q the foot of the perpendicular from C on
  the tangent plane: exact on level ground, and on slopes where the wheel is not cambered;
- the exact one, r = (C - F)·n / (n·e_s), by which P lies in the tangent plane.

A third contact is that of the *lowest point* of the disc by the rules of Chrono::Vehicle: the
deflection is measured in the wheel plane from the ground's plane below that point.

They differ where a wheel is both yawed and cambered on a slope: by up to 0.8 mm for the Iltis
over its bump in anti-phase. Both are in closed form on any ground. On level ground the disc's
deflection differs from theirs by (1/cos γ - 1) of the loaded radius.
"""

from __future__ import annotations

from vehicledyn.road.surfaces.surface import RoadSurface, ground_normal
from vehicledyn.road.tyres.smooth import floored
from vehicledyn.road.wheel.contact import AXIS_FLOOR, Contact, wheel_axes
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec


def contact_below(surface: RoadSurface, centre: Vec, spin_axis: Vec, radius: Scalar) -> Contact:
    """Return the contact by the rules of the Iltis benchmark.

    Parameters
    ----------
    surface
        Any ground.
    centre, spin_axis
        Wheel centre [m] and unit spin axis, world axes.
    radius
        Unloaded radius [m].

    References
    ----------
    Rules of the benchmark as its public Robotran model has them: force along the ground
    normal k n_z (R - (z_C - z_F)), contact point C - r e_s with r = (z_C - z_Q) / e_s,z and
    z_C - z_Q = n_z² (z_C - z_F). The factor n_z of the force was found from the benchmark's
    histories: poses and loads agree with it.
    """
    normal = ground_normal(surface, centre[0], centre[1])
    axes = wheel_axes(spin_axis, normal)
    drop = _clearance(surface, centre) * normal[2] * normal[2]
    loaded_radius = drop / floored(axes[1][2], AXIS_FLOOR)
    return _contact(surface, centre, spin_axis, radius, loaded_radius)


def contact_on_tangent_plane(
    surface: RoadSurface, centre: Vec, spin_axis: Vec, radius: Scalar
) -> Contact:
    """Return the contact whose point lies in the tangent plane; arguments as above."""
    normal = ground_normal(surface, centre[0], centre[1])
    _, _, cosine = wheel_axes(spin_axis, normal)
    loaded_radius = _clearance(surface, centre) * normal[2] / cosine
    return _contact(surface, centre, spin_axis, radius, loaded_radius)


def contact_of_lowest_point(
    surface: RoadSurface, centre: Vec, spin_axis: Vec, radius: Scalar
) -> Contact:
    """Return the contact of the disc's lowest point; arguments as above.

    With the lowest point B, the point P of the ground there and the unit vector u upwards in the
    wheel plane along the ground's normal n, δ = R n·u - (C - P)·u; on level ground δ = R cos γ
    - R sin² γ - h cos γ, a disc's depth less R γ²/2. The contact point is the ground at C - r u.

    References
    ----------
    Project Chrono, ChTire::DiscTerrainCollision1pt; rules of that public program, own formulation.
    Depths and loads of its recorded runs fulfil them to 5e-6 m.
    """
    _, upwards, _ = wheel_axes(spin_axis, ops.vector(0.0, 0.0, 1.0))
    lowest = centre - radius * upwards
    normal = ground_normal(surface, lowest[0], lowest[1])
    _, spoke, cosine = wheel_axes(spin_axis, normal)
    below = ops.vector(lowest[0], lowest[1], surface.height(lowest[0], lowest[1]))
    distance = ops.dot(centre - below, spoke)
    depth = radius * cosine - distance
    foot = centre - distance * spoke
    normal = ground_normal(surface, foot[0], foot[1])
    longitudinal, _, cosine = wheel_axes(spin_axis, normal)
    return Contact(
        position=ops.vector(foot[0], foot[1], surface.height(foot[0], foot[1])),
        longitudinal=longitudinal,
        lateral=ops.cross(normal, longitudinal),
        normal=normal,
        loaded_radius=radius - depth,
        deflection=depth,
        camber=ops.atan(ops.dot(normal, spin_axis) / cosine),
    )


def _clearance(surface: RoadSurface, centre: Vec) -> Scalar:
    return centre[2] - surface.height(centre[0], centre[1])


def _contact(
    surface: RoadSurface, centre: Vec, spin_axis: Vec, radius: Scalar, loaded_radius: Scalar
) -> Contact:
    normal = ground_normal(surface, centre[0], centre[1])
    longitudinal, spoke, cosine = wheel_axes(spin_axis, normal)
    return Contact(
        position=centre - loaded_radius * spoke,
        longitudinal=longitudinal,
        lateral=ops.cross(normal, longitudinal),
        normal=normal,
        loaded_radius=loaded_radius,
        deflection=(radius - _clearance(surface, centre)) * normal[2],
        camber=ops.atan(ops.dot(normal, spin_axis) / cosine),
    )
