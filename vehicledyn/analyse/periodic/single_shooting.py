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

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.collocation import Direction
from vehicledyn.analyse.periodic.mirror_symmetry import BrokenMirrorError, Mirror
from vehicledyn.analyse.periodic.monodromy import Passages, durations_of, passages_along
from vehicledyn.analyse.periodic.multiple_shooting import Chain, Closed, solved
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.path_code import StepTrace

_NEAR_STEP, _STEP, _NEAR = 3e-6, 3e-8, 1e-3
"""Errors of steps of the motion, at first and from a gap on."""

_FINER, _FINEST, _STALLED, _MULTIPLIED = 0.03, 1e-11, 1e-2, 1e5
"""How these errors shrink where a gap stays, how far, and the gap from which on they do. Contacts
that begin and end on the way multiply them by thousands, so that they may be all that is left; what
is more than so many times as large is none of theirs."""

_ROUGH = (1e-2,)
"""Tolerance of tangents on the way."""

_TOLERANCES = (3e-4, 3e-5, 1e-5, 3e-6)
"""Those of the tangents that multipliers come from; each where the one before does not do."""

_SHIFTED = 5e-4
"""Distance of the trivial multiplier from 1 up to which one does."""

_RETURNED, _SURELY = 1e-6, 3e-7
"""Distances to the begin, part of the scales, that count as none: where the trivial multiplier
is 1, and else."""

_MOVED = 1e-5
"""Correction from which on an orbit that has returned is looked for more finely: where a multiplier
is near 1, what is left of the gap says little."""

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
    mirror: Mirror | None = None,
) -> Closed:
    """Return the orbit near a guess whose motion returns.

    Parameters
    ----------
    field
        The equations, with compiled code that carries them along.
    guess
        Its first point counts; the mesh says where points of the orbit are wanted.
    near
        Passages of an orbit near by on the same mesh.
    parameter_scale
        Size with which changes of the parameter are measured; None to hold the parameter.
    along
        A direction: the orbit that is found lies on the plane across it. Without one it is the
        nearest.
    mirror
        Asks for an orbit whose second half is the image of its first, which alone is followed. The
        guess is one, on a mesh that is.

    Raises
    ------
    BrokenMirrorError
        If the equations do not look the same in the mirror along the orbit.
    NumericalError
        If the orbit is not found.
    """
    size_of = parameter_scale or 0.0
    is_near = near is not None and (
        near.mirror is None if mirror is None else mirror.equals(near.mirror)
    )
    search = _Search(Chain.of(near, size_of), guess, along) if near and is_near else None
    scales = guess.scales() if near is None else near.scales
    orbit, before, best, vain, error = guess, np.inf, np.inf, 0, _NEAR_STEP
    counted, returned = 0, _RETURNED
    for _ in range(_ITERATIONS):
        counted += error >= _STEP
        orbit, gap, path = _followed(field, orbit, scales, error, mirror)
        size = float(np.abs(gap).max())
        if size < returned and error <= _STEP:
            found = _tangents(field, orbit, path, mirror)
            last = _Search(Chain.of(found, size_of), guess, along)
            corrected = last.corrected(orbit, gap * scales / found.scales, stay=True)
            if size >= _SURELY and abs(found.trivial - 1.0) >= _SHIFTED:
                search, orbit, before, returned = None, corrected, size, _SURELY
                continue
            if returned > _SURELY * _FINER and _moved(orbit, corrected, scales) > _MOVED:
                search, orbit, before, returned = last, corrected, np.inf, returned * _FINER
                error *= _FINER
                continue
            value = orbit.parameter
            if mirror and not mirror.holds(field, orbit.states, value, scales=scales):
                raise BrokenMirrorError("an orbit is not its own image in a mirror any more")
            return Closed(corrected, found, counted)
        vain = 0 if size < 0.5 * best else vain + 1
        best = min(best, size)
        if vain > _MOST_VAIN or not size < _LOST:
            break
        is_slow = size > _SLOW * before
        finer = _finer(error, size, is_slow=is_slow)
        if search is None or is_slow:
            found = passages_along(field, orbit, path, scales, tolerances=_ROUGH, mirror=mirror)
            search = _Search(Chain.of(found, size_of), guess, along)
        orbit, before = search.corrected(orbit, gap), size
        if finer < error:
            error, before, best, vain = finer, np.inf, np.inf, 0
    raise NumericalError("the motion along a cycle does not return to its begin")


def _moved(orbit: Orbit, corrected: Orbit, scales: Vector) -> float:
    """Return by how much the first point of an orbit is corrected, part of the scales."""
    return float((np.abs(corrected.states[0] - orbit.states[0]) / scales).max())


def _finer(error: float, gap: float, *, is_slow: bool) -> float:
    """Return the error of steps that suits a gap, smaller where the gap hardly shrinks."""
    if is_slow and gap < min(_STALLED, _MULTIPLIED * error):
        error = max(_FINER * error, _FINEST)
    return min(error, _STEP) if gap < _NEAR else error


def _followed(
    field: AutonomousField,
    orbit: Orbit,
    scales: Vector,
    tolerance: float,
    mirror: Mirror | None,
) -> tuple[Orbit, Vector, StepTrace]:
    """Return the orbit through its first point, by how much its end misses that, and the path."""
    begin = orbit.states[0]
    found = field.followed(
        begin,
        orbit.parameter,
        durations_of(orbit, mirror),
        scales=scales,
        tolerance=tolerance,
        trials=_MOST_STEPS,
    )
    if found is None:
        raise NumericalError("the motion along a cycle cannot be followed")
    places = found.places
    states, end = np.concatenate([begin[None], places[:-1]]), places[-1]
    if mirror is not None:
        states, end = mirror.completed(states), mirror.image(end)
    return replace(orbit, states=states), (end - begin) / scales, found


def _tangents(
    field: AutonomousField, orbit: Orbit, path: StepTrace, mirror: Mirror | None
) -> Passages:
    """Return the passages of an orbit, accurate enough for its multipliers."""
    return passages_along(
        field,
        orbit,
        path,
        orbit.scales(),
        tolerances=_TOLERANCES,
        shifted=_SHIFTED,
        mirror=mirror,
    )


class _Search:
    """Newton's method with derivatives from an orbit near by, made better by what steps change.

    References
    ----------
    Broyden (1965), Math. Comp. 19, 577-593: the first of the two methods.
    """

    def __init__(self, chain: Chain, guess: Orbit, along: Direction | None) -> None:
        self._chain, self._guess, self._along = chain, guess, along
        closing = chain.closing(2 if chain.parameter_scale else 1)
        rows = [] if along is None else [chain.across(along)]
        self._matrix = np.vstack([closing, *rows])
        self._made: tuple[Vector, Vector] | None = None

    def corrected(self, orbit: Orbit, gap: Vector, *, stay: bool = False) -> Orbit:
        """Return the orbit after a step, its points as they follow the first.

        It reaches the plane of the search, or stays where it is on the branch.
        """
        chain, n = self._chain, len(gap)
        right = self._right(orbit, gap)
        if stay:
            right[n:] = 0.0
        if self._made is not None:
            change, before = self._made
            missed = before - right - self._matrix @ change
            self._matrix += np.outer(missed, change) / (change @ change)
        change = solved(self._matrix, right)
        farthest = float(np.abs(change).max())
        if not farthest < _ASTRAY:
            raise NumericalError("the motion along a cycle does not return to its begin")
        change = change * min(1.0, _FARTHEST / farthest)
        self._made = change, right
        outer = np.append(change[n:], 0.0)[:2]
        points = chain.points(change[:n], outer, gaps=False)
        return replace(
            orbit,
            states=orbit.states + points * chain.found.scales,
            period=orbit.period * (1.0 + float(outer[0])),
            parameter=orbit.parameter + chain.parameter_scale * float(outer[1]),
        )

    def _right(self, orbit: Orbit, gap: Vector) -> Vector:
        """Return what the closing equations miss: the gap, the phase, the way along."""
        missed = np.append(gap, 0.0)
        if self._along is None:
            return missed
        guess = self._guess
        moved = Direction(
            orbit.states - guess.states,
            orbit.period - guess.period,
            orbit.parameter - guess.parameter,
        )
        return np.append(missed, -self._chain.product(self._along, moved))
