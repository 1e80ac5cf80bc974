"""Mass, centre of mass and inertia of a beam that is not deformed."""

from __future__ import annotations

from typing import Any

from vehicledyn.multibody.bodies.beam_properties import Properties
from vehicledyn.multibody.bodies.curved_axis import CurvedAxis
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


def rigid_inertia(
    properties: Properties, length: Scalar, axis: CurvedAxis | None
) -> dict[str, Any]:
    """Return ``mass`` [kg], ``com`` [m] and ``inertia`` [kg m²] in the axes of the start.

    Parameters
    ----------
    properties
        Numbers of the section over the length.
    length
        Length along the axis [m].
    axis
        The axis of a curved beam, which is uniform; None of a straight one.
    """
    mass = properties.mean("mass_per_length") * length
    if axis is not None:
        com, inertia = axis.inertia(1.0, mass, properties.mean("polar") * length)
        return {"mass": mass, "com": com, "inertia": inertia}
    if properties.is_uniform:
        across, centre = mass * length * length / 12.0, 0.5 * length
    else:
        first = second = ops.scalar(0.0)
        for x, weight in properties.weighted("mass_per_length", 2):
            first = first + weight * length * (x * length)
            second = second + weight * length * (x * length) ** 2
        centre = first / mass
        across = second - mass * centre * centre
    inertia = (properties.mean("polar") * length, across, across)
    return {"mass": mass, "com": (centre, 0.0, 0.0), "inertia": inertia}
