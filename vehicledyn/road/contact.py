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

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.road.smooth import floored
from vehicledyn.road.surface import RoadSurface, ground_normal
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec

AXIS_FLOOR = 1e-3
"""Sine of the angle between spin axis and normal that is never divided by less [1]."""

Array = NDArray[np.float64]
Residual = Callable[[Array], tuple[Array, Array]]

_TOLERANCE = 1e-14  # [m]
_STALLED = 1e-11  # [m], rounding far from the origin of the world
_SINGULAR = 1e-9
_ITERATIONS = 50
_HALVINGS = 12


@dataclass(frozen=True)
class Contact:
    """Contact point of a disc: expressions, or arrays and floats from :func:`find_contact`.

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


def find_contact(
    surface: RoadSurface, centre: ArrayLike, spin_axis: ArrayLike, radius: float
) -> Contact:
    """Return the contact point as numbers, by Newton's method from the foot of the centre.

    Parameters
    ----------
    surface
        Ground with numbers as parameters.
    centre
        Wheel centre, world axes, shape (3,) [m].
    spin_axis
        Direction of the spin axis to the left of the wheel, any length, shape (3,).
    radius
        Unloaded radius [m].

    Returns
    -------
    Contact
        Vectors of shape (3,) and floats.

    Raises
    ------
    InputError
        If the radius is not positive, a value is not finite or the axis has no length.
    NumericalError
        If the wheel lies flat on the ground or no contact point is found.
    """
    place, axis = _checked(centre, spin_axis, radius)
    if np.linalg.norm(np.cross(axis, _normal_below(surface, place))) < 2.0 * AXIS_FLOOR:
        raise NumericalError(
            "the wheel lies flat on the ground: its spin axis is along the ground normal, so "
            "it has no contact point; check the wheel's orientation"
        )
    c, a, o = (ops.vector(*map(ops.symbol, "xyz")) for _ in range(3))
    offset = (o[0], o[1])
    residual = ops.column(contact_residuals(surface, c, a, offset))
    error, slope = (ops.numeric([c, a, o], e) for e in (residual, ops.jacobian(residual, o[:2])))
    solution = _nearest_solution(
        lambda at: (error(place, axis, [*at, 0.0])[:, 0], slope(place, axis, [*at, 0.0])),
        axis,
        radius,
    )
    contact = contact_at_offset(surface, c, a, radius, offset=offset)
    parts = ops.column([getattr(contact, field.name) for field in fields(Contact)])
    numbers = ops.numeric([c, a, o], parts)(place, axis, [*solution, 0.0])[:, 0]
    vectors = numbers[:12].reshape(4, 3)
    return Contact(*vectors, *(float(number) for number in numbers[12:]))


def _normal_below(surface: RoadSurface, place: Array) -> Array:
    normal = ground_normal(surface, float(place[0]), float(place[1]))
    return np.array([float(normal[k]) for k in range(3)])


def _reach(surface: RoadSurface, centre: Vec, offset: tuple[Scalar, Scalar]) -> Vec:
    height = surface.height(centre[0] + offset[0], centre[1] + offset[1])
    return ops.vector(offset[0], offset[1], height - centre[2])


def wheel_axes(spin_axis: Vec, normal: Vec) -> tuple[Vec, Vec, Scalar]:
    """Return e_x, the upward spoke e_s and n·e_s; finite for a wheel that lies flat."""
    along = ops.cross(spin_axis, normal)
    cosine = ops.sqrt(floored(ops.dot(along, along), AXIS_FLOOR**2))
    longitudinal = along / cosine
    return longitudinal, ops.cross(longitudinal, spin_axis), cosine


def _checked(centre: ArrayLike, spin_axis: ArrayLike, radius: float) -> tuple[Array, Array]:
    place, axis = np.asarray(centre, dtype=float), np.asarray(spin_axis, dtype=float)
    if place.shape != (3,) or axis.shape != (3,):
        raise InputError("wheel centre and spin axis need three components each")
    if not (np.isfinite(place).all() and np.isfinite(axis).all() and np.isfinite(radius)):
        raise InputError("wheel centre, spin axis and radius must be finite numbers")
    if radius <= 0.0:
        raise InputError(f"a wheel radius must be positive, found {radius} m")
    length = float(np.linalg.norm(axis))
    if length == 0.0:
        raise InputError("the spin axis has no length; give its direction, such as (0, 1, 0)")
    return place, axis / length


def _nearest_solution(residual: Residual, axis: Array, radius: float) -> Array:
    """Return the offset found from the foot of the centre, else from places beside it."""
    forward = np.array([axis[1], -axis[0]])
    for shift in (0.0, 0.25, -0.25, 0.5, -0.5, 1.0, -1.0):
        solution = _newton(residual, shift * radius * forward, 0.5 * radius)
        if solution is not None:
            return solution
    raise NumericalError(
        "no contact point of the wheel with the ground was found; the ground is too rough for "
        "a disc of this radius, or the wheel is too far above it"
    )


def _newton(residual: Residual, start: Array, largest_step: float) -> Array | None:
    """Return a root by Newton's method with limited, halved steps, or None."""
    at = start
    error, slope = residual(at)
    for _ in range(_ITERATIONS):
        if np.linalg.norm(error) < _TOLERANCE:
            return at
        if abs(np.linalg.det(slope)) < _SINGULAR:
            return None
        step = np.linalg.solve(slope, -error)
        step *= min(1.0, largest_step / float(np.linalg.norm(step)))
        for _ in range(_HALVINGS):
            trial, trial_slope = residual(at + step)
            if np.linalg.norm(trial) < np.linalg.norm(error):
                break
            step = 0.5 * step
        else:
            return at if np.linalg.norm(error) < _STALLED else None
        at, error, slope = at + step, trial, trial_slope
    return None
