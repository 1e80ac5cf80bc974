"""The contact point of a disc or torus as numbers, found by Newton's method on its equations."""

from dataclasses import fields

import numpy as np
from scipy.optimize import root

from vehicledyn.road.wheel.contact import Contact, contact_at_offset, contact_residuals
from vehicledyn.symbolic import ops


def find_contact(surface, centre, spin_axis, radius, *, crown=None):
    """Return the contact of a wheel from its centre [m] and spin axis, shape (3,) each.

    ``radius`` and ``crown``, that of the tread across the wheel or None for a disc, in m.
    """
    place = np.asarray(centre, float)
    axis = np.asarray(spin_axis, float) / np.linalg.norm(spin_axis)
    c, a, o = (ops.vector(*map(ops.symbol, "xyz")) for _ in range(3))
    offset, torus = (o[0], o[1]), None if crown is None else (radius, crown)
    residual = ops.column(contact_residuals(surface, c, a, offset, torus=torus))
    error, slope = (ops.numeric([c, a, o], e) for e in (residual, ops.jacobian(residual, o[:2])))

    def values(at):
        return error(place, axis, [*at, 0.0])[:, 0]

    def slopes(at):
        return slope(place, axis, [*at, 0.0])

    # From the foot of the centre, else from places before and behind it.
    starts = np.outer([0.0, 0.25, -0.25, 0.5, -0.5, 1.0, -1.0], [axis[1], -axis[0]]) * radius
    found = (root(values, start, jac=slopes, tol=1e-15).x for start in starts)
    solution = next(at for at in found if np.linalg.norm(values(at)) < 1e-11)
    contact = contact_at_offset(surface, c, a, radius, offset=offset, crown=crown)
    parts = ops.column([getattr(contact, field.name) for field in fields(Contact)])
    numbers = ops.numeric([c, a, o], parts)(place, axis, [*solution, 0.0])[:, 0]
    return Contact(*numbers[:12].reshape(4, 3), *map(float, numbers[12:]))
