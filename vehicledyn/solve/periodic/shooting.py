"""Close a periodic orbit by multiple shooting: its points move until the motion itself returns.

Collocation misses where its mesh is too coarse for a contact that is stiff; integration with error
control does not. With the passages from point to point (:mod:`.monodromy`)

    x_k+1 = φ_k(x_k, T, p),    k = 0 .. n - 1,    x_n = x_0

is solved for all points, the period and, where that is asked, the parameter: then the orbit that
is found is the nearest one on its branch, which exists at a fold too.

References
----------
Seydel (2010), Practical Bifurcation and Stability Analysis, 3rd ed., section 7.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.solve.engine import Vector
from vehicledyn.solve.periodic.autonomous import AutonomousField
from vehicledyn.solve.periodic.monodromy import Passages, passages
from vehicledyn.solve.periodic.orbit import Orbit

CLOSED = 3e-5
"""Largest gap between the pieces of an orbit, part of the scales, that may count as none."""

_ROUNDING, _STALLED = 1e-8, 0.1
_ITERATIONS = 6
_FARTHEST = 0.5
"""Largest change of a point, part of the scales, that is taken for a correction."""

_RANK = 1e-13


@dataclass(frozen=True)
class Closed:
    """An orbit that the motion closes, and how it carries changes from point to point.

    ``orbit`` has its points on the mesh, the period and the parameter in common with that of the
    passages.
    """

    orbit: Orbit
    passages: Passages


def closed(field: AutonomousField, orbit: Orbit, *, parameter_scale: float | None = None) -> Closed:
    """Return the closed orbit near one that collocation has found.

    Parameters
    ----------
    field
        The equations.
    orbit
        The orbit, nearly closed.
    parameter_scale
        Size with which changes of the parameter are measured; None to hold the parameter.

    Raises
    ------
    NumericalError
        If the orbit is not found.
    """
    guess, before = orbit, np.inf
    for _ in range(_ITERATIONS):
        found = passages(field, orbit)
        gap = float(np.abs(found.gaps).max())
        stalled = gap > _STALLED * before
        if gap < max(_ROUNDING, min(CLOSED, CLOSED if stalled else found.error)):
            return Closed(_beside(guess, found.orbit), found)
        orbit, before = _corrected(found, parameter_scale), gap
    raise NumericalError("the motion along a cycle does not close")


def _beside(guess: Orbit, exact: Orbit) -> Orbit:
    """Return the polynomials of an orbit, moved so that they pass the exact mesh points.

    Between these the polynomials of collocation are nearer to the motion than those through exact
    points are, and stay as they are.
    """
    m = guess.basis.degree
    missed = (exact.states - guess.states)[::m]
    ahead, part = np.roll(missed, -1, axis=0), (np.arange(m) / m)[:, None]
    moved = missed[:, None] * (1.0 - part) + ahead[:, None] * part
    return replace(exact, states=guess.states + moved.reshape(guess.states.shape))


def _corrected(found: Passages, parameter_scale: float | None) -> Orbit:
    """Return the orbit after one step of Newton's method."""
    orbit, n = found.orbit, found.orbit.states.shape[1]
    size = parameter_scale or 0.0
    pulls = np.stack([found.durations[:, None] * found.last, size * found.by_parameter], axis=2)
    whole, pulled, missed = np.eye(n), np.zeros((n, 2)), np.zeros(n)
    for piece, pull, gap in zip(found.by_state, pulls, found.gaps, strict=True):
        whole, pulled, missed = piece @ whole, piece @ pulled + pull, piece @ missed + gap
    ahead = found.first[0] / np.linalg.norm(found.first[0])
    free = 2 if parameter_scale else 1
    matrix = np.zeros((n + 1, n + free))
    matrix[:n, :n], matrix[:n, n:] = np.eye(n) - whole, -pulled[:, :free]
    matrix[n, :n] = ahead
    right = np.append(missed, 0.0)
    change = np.linalg.lstsq(matrix, right, rcond=_RANK)[0]
    own, outer = change[:n], np.append(change[n:], 0.0)[:2]
    moved: list[Vector] = []
    for piece, pull, gap in zip(found.by_state, pulls, found.gaps, strict=True):
        moved.append(own)
        own = piece @ own + pull @ outer + gap
    changes = np.array(moved)
    if not (np.abs(changes).max() < _FARTHEST and abs(outer[0]) < _FARTHEST):
        raise NumericalError("the motion along a cycle does not close")
    return replace(
        orbit,
        states=orbit.states + changes * found.scales,
        period=orbit.period * (1.0 + float(outer[0])),
        parameter=orbit.parameter + size * float(outer[1]),
    )
