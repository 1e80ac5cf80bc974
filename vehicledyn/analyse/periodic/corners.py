"""Pass a corner of a branch of cycles, at which its direction turns within no length.

A contact that just begins to touch makes the derivatives of the motion jump: those on this side
say nothing about where the branch goes on. Those beyond do, at orbits that are not closed: a guess
some way ahead is taken, the direction that its tangents have is turned to the side that the sense
of the branch asks for, and the orbit is corrected across it with the derivatives from there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.collocation import Direction, Scales, dot
from vehicledyn.analyse.periodic.cycle_points import CyclePoint, ahead, between, cosine, point_of
from vehicledyn.analyse.periodic.mirror_symmetry import Mirror
from vehicledyn.analyse.periodic.monodromy import passages
from vehicledyn.analyse.periodic.multiple_shooting import Closed, closed, direction_of
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.analyse.periodic.single_shooting import returning
from vehicledyn.base.errors import NumericalError

_REACHES, _LENGTHS = (1.0, 5.0), (25.0, 5.0, 1.0)
"""Ways ahead at which derivatives are taken, and lengths of steps, as parts of a size."""

_AGREES = 0.9
"""Cosine of the angle up to which the direction of an orbit is that with which it was found."""

_OPPOSITE = 1e-6
"""Squared sine of the angle below which two legs say nothing about where they meet."""


def behind_corner(
    model: AutonomousField,
    base: CyclePoint,
    size: float,
    scales: Scales,
    mirror: Mirror | None = None,
) -> tuple[CyclePoint, float]:
    """Return a point of a branch behind a corner, and the length of the step to it.

    Parameters
    ----------
    model
        The equations.
    base
        The last point before the corner, its sense known.
    size
        Length along the branch within which the corner lies.
    scales
        Sizes of states, period and parameter.
    mirror
        In which the orbits are their own images.

    Raises
    ------
    NumericalError
        If none is found.
    """
    for reach in _REACHES:
        try:
            guess = ahead(base.orbit, base.tangent, reach * size)
            probe = passages(model, guess, mirror=mirror)
        except NumericalError:
            continue
        beyond = Closed(probe.orbit, probe)
        along, sense = direction_of(beyond, scales.parameter, base.tangent)
        if sense * base.sense < 0.0:
            along = along.times(-1.0)
        for length in _LENGTHS:
            try:
                step = length * size
                return _behind(model, base, beyond, along.times(step), scales), step
            except NumericalError:
                continue
    raise NumericalError("no orbit is found behind a corner of the branch")


def _behind(
    model: AutonomousField, base: CyclePoint, beyond: Closed, step: Direction, scales: Scales
) -> CyclePoint:
    """Return the point at a step from another, with the derivatives of an orbit beyond."""
    guess = ahead(base.orbit, step, 1.0)
    along = step.times(1.0 / np.sqrt(dot(guess, step, step, scales)))
    size = scales.parameter
    if model.is_carried:
        near = beyond.passages
        exact = returning(model, guess, near, parameter_scale=size, along=along, mirror=near.mirror)
    else:
        exact = closed(model, guess, parameter_scale=size, along=along)
    point = point_of(exact, along, size, base.sense)
    agrees = cosine(point.orbit, point.tangent, along, scales) > _AGREES
    if not (agrees and point.sense == base.sense):
        raise NumericalError("the branch goes on in another direction")
    return point


def corner_between(before: CyclePoint, after: CyclePoint, scales: Scales) -> float:
    """Return how far ahead of a point the corner lies behind which another one is.

    It is where their tangents come nearest; 0 where these are opposite.
    """
    orbit = before.orbit
    chord = between(orbit, after.orbit.moved(orbit.mesh))
    first, second = before.tangent, _on(after, orbit)
    turn = cosine(orbit, first, second, scales)
    sizes = [np.sqrt(dot(orbit, d, d, scales)) for d in (first, second)]
    along = [dot(orbit, chord, d, scales) / s for d, s in zip((first, second), sizes, strict=True)]
    if 1.0 - turn**2 < _OPPOSITE:
        return 0.0
    return float(max((along[0] - turn * along[1]) / (1.0 - turn**2), 0.0) / sizes[0])


def _on(point: CyclePoint, orbit: Orbit) -> Direction:
    states = replace(point.orbit, states=point.tangent.states).moved(orbit.mesh).states
    return Direction(states, point.tangent.period, point.tangent.parameter)
