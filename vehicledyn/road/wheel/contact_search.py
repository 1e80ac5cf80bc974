"""The contact point of a disc as numbers, found by Newton's method on the same equations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.road.surfaces.surface import RoadSurface, ground_normal
from vehicledyn.road.wheel.contact import AXIS_FLOOR, Contact, contact_at_offset, contact_residuals
from vehicledyn.symbolic import ops

Array = NDArray[np.float64]
Residual = Callable[[Array], tuple[Array, Array]]

_TOLERANCE = 1e-14  # [m]
_STALLED = 1e-11  # [m], rounding far from the origin of the world
_SINGULAR = 1e-9
_ITERATIONS = 50
_HALVINGS = 12


def find_contact(
    surface: RoadSurface,
    centre: ArrayLike,
    spin_axis: ArrayLike,
    radius: float,
    *,
    crown: float | None = None,
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
    crown
        Radius of the tread across the wheel, which is a torus; None for a thin disc [m].

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
    torus = None if crown is None else (radius, crown)
    residual = ops.column(contact_residuals(surface, c, a, offset, torus=torus))
    error, slope = (ops.numeric([c, a, o], e) for e in (residual, ops.jacobian(residual, o[:2])))
    solution = _nearest_solution(
        lambda at: (error(place, axis, [*at, 0.0])[:, 0], slope(place, axis, [*at, 0.0])),
        axis,
        radius,
    )
    contact = contact_at_offset(surface, c, a, radius, offset=offset, crown=crown)
    parts = ops.column([getattr(contact, field.name) for field in fields(Contact)])
    numbers = ops.numeric([c, a, o], parts)(place, axis, [*solution, 0.0])[:, 0]
    vectors = numbers[:12].reshape(4, 3)
    return Contact(*vectors, *(float(number) for number in numbers[12:]))


def _normal_below(surface: RoadSurface, place: Array) -> Array:
    normal = ground_normal(surface, float(place[0]), float(place[1]))
    return np.array([float(normal[k]) for k in range(3)])


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
