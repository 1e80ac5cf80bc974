"""Find a periodic orbit as a fixed point: the motion from one point returns to it.

    φ_T(x, p) = x

Simple shooting, for motions that compiled code follows quickly. However many contacts begin and
end on the way, the motion passes them, and what they set ringing has decayed when it returns; so
Newton's method sees but the slow part, where one that moves many points of the orbit at once would
have to find the ringing too. The derivatives come from an orbit near by until they no longer do.

References
----------
Seydel (2010), Practical Bifurcation and Stability Analysis, 3rd ed., section 7.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.solve.engine import Vector
from vehicledyn.solve.periodic.autonomous import AutonomousField
from vehicledyn.solve.periodic.collocation import Direction
from vehicledyn.solve.periodic.monodromy import Passages, passages
from vehicledyn.solve.periodic.orbit import Orbit
from vehicledyn.solve.periodic.shooting import Chain, Closed, solved

_NEAR_STEP, _STEP, _NEAR = 3e-6, 3e-8, 1e-3
"""Errors of steps of the motion, at first and from a gap on."""

_FINER, _FINEST, _STALLED = 0.03, 1e-11, 1e-2
"""How these errors shrink where a gap stays, how far, and the gap from which on they do. Contacts
that begin and end on the way multiply them by thousands, so that they may be all that is left."""

_ROUGH = 1e-2
"""Tolerance of tangents on the way."""

_TOLERANCES = (1e-4, 1e-5)
"""Those of the tangents that multipliers come from; the second where the first does not do."""

_SHIFTED = 5e-4
"""Distance of the trivial multiplier from 1 up to which the first does."""

_RETURNED = 3e-7
"""Distance to the begin, part of the scales, that counts as none."""

_ITERATIONS, _SLOW, _MOST_VAIN, _LOST = 16, 0.3, 2, 3.0
"""Iterations; reduction of the gap from which derivatives are found anew; iterations without
progress, and gap, with which the search is given up."""

_FARTHEST, _ASTRAY = 0.3, 30.0
"""Largest correction, part of the scales, that is made, and that is one at all."""

_MOST_STEPS = 200_000


def returning(
    field: AutonomousField,
    guess: Orbit,
    near: Passages | None,
    *,
    parameter_scale: float | None = None,
    along: Direction | None = None,
) -> Closed:
    """Return the orbit near a guess whose motion returns.

    Parameters
    ----------
    field
        The equations, with compiled code that carries them along.
    guess
        Its first point counts; the mesh tells where points of the orbit are wanted.
    near
        Passages of an orbit near by on the same mesh.
    parameter_scale
        Size with which changes of the parameter are measured; None to hold the parameter.
    along
        A direction: the orbit that is found lies on the plane across it. Without one it is the
        nearest.

    Raises
    ------
    NumericalError
        If the orbit is not found.
    """
    chain = None if near is None else Chain.of(near, parameter_scale or 0.0)
    scales = guess.scales() if near is None else near.scales
    orbit, before, best, vain, error = guess, np.inf, np.inf, 0, _NEAR_STEP
    counted = 0
    for _ in range(_ITERATIONS):
        counted += error >= _STEP
        orbit, gap, efforts = _followed(field, orbit, scales, error)
        size = float(np.abs(gap).max())
        if size < _RETURNED and error <= _STEP:
            found = _tangents(field, orbit, efforts)
            chain = Chain.of(found, parameter_scale or 0.0)
            gap = gap * scales / found.scales
            return Closed(_corrected(chain, orbit, gap, guess, along), found, counted)
        vain = 0 if size < 0.5 * best else vain + 1
        best = min(best, size)
        if vain > _MOST_VAIN or not size < _LOST:
            break
        is_slow = size > _SLOW * before
        finer = _finer(error, size, is_slow=is_slow)
        if chain is None or is_slow:
            found = passages(field, orbit, tolerance=_ROUGH, efforts=efforts)
            chain = Chain.of(found, parameter_scale or 0.0)
            gap, scales = gap * scales / chain.found.scales, chain.found.scales
        orbit, before = _corrected(chain, orbit, gap, guess, along), size
        if finer < error:
            error, before, best, vain = finer, np.inf, np.inf, 0
    raise NumericalError("the motion along a cycle does not return to its begin")


def _finer(error: float, gap: float, *, is_slow: bool) -> float:
    """Return the error of steps that suits a gap, smaller where the gap hardly shrinks."""
    if is_slow and gap < _STALLED:
        error = max(_FINER * error, _FINEST)
    return min(error, _STEP) if gap < _NEAR else error


def _followed(
    field: AutonomousField, orbit: Orbit, scales: Vector, tolerance: float
) -> tuple[Orbit, Vector, Vector]:
    """Return the orbit through its first point, by how much its end misses that, and efforts."""
    durations = np.diff(np.append(orbit.times_of(orbit.mesh)[0], 1.0)) * orbit.period
    begin = orbit.states[0]
    found = field.followed(
        begin,
        orbit.parameter,
        durations,
        scales=scales,
        tolerance=tolerance,
        trials=_MOST_STEPS,
    )
    if found is None:
        raise NumericalError("the motion along a cycle cannot be followed")
    places, efforts = found
    states = np.concatenate([begin[None], places[:-1]])
    return replace(orbit, states=states), (places[-1] - begin) / scales, efforts


def _tangents(field: AutonomousField, orbit: Orbit, efforts: Vector) -> Passages:
    """Return the passages of an orbit, accurate enough for its multipliers."""
    for tolerance in _TOLERANCES:
        found = passages(field, orbit, tolerance=tolerance, efforts=efforts)
        if abs(found.trivial - 1.0) < _SHIFTED:
            break
    return found


def _corrected(
    chain: Chain, orbit: Orbit, gap: Vector, guess: Orbit, along: Direction | None
) -> Orbit:
    """Return the orbit after a step of Newton's method, its points as they follow the first."""
    size, n = chain.parameter_scale, len(gap)
    matrix = chain.closing(2 if size else 1)
    right = np.append(gap, 0.0)
    if along is not None:
        moved = Direction(
            orbit.states - guess.states,
            orbit.period - guess.period,
            orbit.parameter - guess.parameter,
        )
        matrix = np.vstack([matrix, chain.across(along)])
        right = np.append(right, -chain.product(along, moved))
    change = solved(matrix, right)
    farthest = float(np.abs(change).max())
    if not farthest < _ASTRAY:
        raise NumericalError("the motion along a cycle does not return to its begin")
    change = change * min(1.0, _FARTHEST / farthest)
    outer = np.append(change[n:], 0.0)[:2]
    moved_points = chain.points(change[:n], outer, gaps=False)
    return replace(
        orbit,
        states=orbit.states + moved_points * chain.found.scales,
        period=orbit.period * (1.0 + float(outer[0])),
        parameter=orbit.parameter + size * float(outer[1]),
    )
