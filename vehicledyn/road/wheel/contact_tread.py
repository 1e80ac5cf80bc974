"""Contact of a wheel with a flat tread: a cylinder of real width, in strips side by side.

The tread is a cylinder of the radius R and the width w about the spin axis e_y. At the edges of
its strips, C + y e_y, it has the deflection of a disc there,

    δ(y) = R - r(y),    r = (z_C - z)·n_z/(n·e_s),

against the ground's tangent plane at the foot below that place. Within a strip deflection and
contact point run straight from edge to edge. With ⟨·⟩ the mean over the width, the deflection of
the wheel is ⟨max(δ, 0)⟩, so that its force is the sum over the strips, and the contact point lies
where these have their resultant. On one plane this is exact: with the camber γ to the plane,

    δ = δ_0 - y tan γ,    y_P = -w² tan γ/(12 δ_0)    as long as the whole width touches,
    y_P = ∓(w/2 - ℓ/3),   ℓ = w/2 + δ_0/|tan γ|       where only the width ℓ at one edge does,

so the contact point moves out to the edge of the tread. The ground's normal is the mean over the
strips. There are no unknowns. On ground that curves along the wheel the foot is that straight
below the centre, not the nearest point.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.road.tyres.smooth import floored
from vehicledyn.road.wheel.contact import Contact, contact_on_plane, wheel_axes
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec

_TOUCH = 1e-12
"""Share of a strip that always counts, so that a lifted wheel has a contact point [m]."""


@dataclass(frozen=True)
class Tread:
    """A flat tread: its width [m], and the strips in which ground that is not one plane is felt."""

    width: Scalar
    strips: int = 4


@dataclass(frozen=True)
class _Strip:
    """A strip: mean of max(δ, 0), place of its resultant between its edges, from -½ to ½."""

    depth: Scalar
    place: Scalar


def contact_of_tread(
    surface: RoadSurface, centre: Vec, spin_axis: Vec, radius: Scalar, tread: Tread
) -> Contact:
    """Return the contact of a cylinder with the ground.

    Parameters
    ----------
    surface
        Any ground.
    centre, spin_axis
        Wheel centre [m] and unit spin axis, world axes.
    radius
        Unloaded radius [m].
    tread
        Width and strips; on one plane a single strip is exact.
    """
    count = 1 if surface.is_flat else tread.strips
    places = [tread.width * (k / count - 0.5) for k in range(count + 1)]
    edges = [contact_on_plane(surface, centre + y * spin_axis, spin_axis, radius) for y in places]
    depth: Scalar = 0.0
    point, normal = ops.vector(0.0, 0.0, 0.0), ops.vector(0.0, 0.0, 0.0)
    for right, left in pairwise(edges):
        strip = _strip(right.deflection, left.deflection)
        share = strip.depth + _TOUCH
        depth = depth + strip.depth / count
        middle = 0.5 * (right.position + left.position)
        point = point + share * (middle + strip.place * (left.position - right.position))
        normal = normal + share * (right.normal + left.normal)
    point = point / (count * (depth + _TOUCH))
    normal = ops.unit(normal)
    longitudinal, spoke, cosine = wheel_axes(spin_axis, normal)
    highest = edges[0].deflection
    for edge in edges[1:]:
        highest = ops.maximum(highest, edge.deflection)
    return Contact(
        position=point,
        longitudinal=longitudinal,
        lateral=ops.cross(normal, longitudinal),
        normal=normal,
        loaded_radius=ops.dot(centre - point, spoke),
        deflection=ops.where(highest > 0.0, depth, highest),
        camber=ops.atan(ops.dot(normal, spin_axis) / cosine),
    )


def _strip(right: Scalar, left: Scalar) -> _Strip:
    """Return a strip from the deflections of its edges, negative where they are lifted."""
    high, low = ops.maximum(right, left), ops.minimum(right, left)
    mean, rise = 0.5 * (right + left), left - right
    part = ops.maximum(high, 0.0) / floored(high - low, _TOUCH)  # of its width, where it touches
    whole = low >= 0.0
    side = ops.where(rise > 0.0, 1.0, -1.0)
    return _Strip(
        depth=ops.where(whole, mean, 0.5 * part * ops.maximum(high, 0.0)),
        place=ops.where(whole, rise / (12.0 * floored(mean, _TOUCH)), side * (0.5 - part / 3.0)),
    )
