"""Contact as the Iltis benchmark has it: a spring measured straight down from the wheel centre.

The ground is taken as its tangent plane at the foot F, vertically below the wheel centre C. The
deflection is the vertical one, whatever the camber, in the direction of the ground normal n:
n_z (R - (C_z - F_z)). In closed form on any ground. On flat ground the disc's deflection differs
by (1/cos γ - 1) of the loaded radius.
"""

from __future__ import annotations

from vehicledyn.road.contact import Contact, wheel_axes
from vehicledyn.road.surface import RoadSurface, ground_normal
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec


def contact_below(surface: RoadSurface, centre: Vec, spin_axis: Vec, radius: Scalar) -> Contact:
    """Return the contact with the tangent plane at the foot of the wheel centre.

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
    normal k n_z (R - (z_C - z_F)), contact point C - r e_s with r = (z_C - z_F) n_z / (n·e_s).
    The factor n_z was found from the benchmark's histories: poses and loads agree with it.
    """
    x, y, z = centre[0], centre[1], centre[2]
    normal = ground_normal(surface, x, y)
    longitudinal, spoke, cosine = wheel_axes(spin_axis, normal)
    clearance = z - surface.height(x, y)
    loaded_radius = clearance * normal[2] / cosine
    return Contact(
        position=centre - loaded_radius * spoke,
        longitudinal=longitudinal,
        lateral=ops.cross(normal, longitudinal),
        normal=normal,
        loaded_radius=loaded_radius,
        deflection=(radius - clearance) * normal[2],
        camber=ops.atan(ops.dot(normal, spin_axis) / cosine),
    )
