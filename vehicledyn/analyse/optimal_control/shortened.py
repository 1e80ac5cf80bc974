"""The quickest motion, found from a slow one by shortening it little by little.

Far from an optimum at the limit of tyres a search takes steps that leave the motion behind. At a
given duration the problem is tame, and the next shorter one is near. On the way motions are found
roughly, and stay away from their bounds.
"""

from __future__ import annotations

from dataclasses import replace

from vehicledyn.analyse.optimal_control.solve import Settings, Solution, solve_on_mesh
from vehicledyn.analyse.optimal_control.trajectory import Trajectory
from vehicledyn.analyse.optimal_control.transcription import PointModel

_FIRST, _LEAST, _QUICK = 0.04, 0.002, 0.12
"""Part by which a motion is shortened at first, below which shortening is given up, and at most."""

_EASY = 15
"""Iterations below which the next motion is shortened by twice as much."""

_LONGER = 0.5
"""Part of what it should be shortened by, by which a motion near its optimum is longer."""

_MOST_ITERATIONS = 60
"""Iterations for one duration; where these do not do, it is shortened by less."""

_BARRIER, _ROUGH = 1e-3, 1e-3
"""Parameter of the barrier, and optimality, of motions on the way."""


def solve_by_shortening(
    model: PointModel, lost: Trajectory, guess: Trajectory, settings: Settings
) -> Solution:
    """Return the optimum on the mesh of a guess, or where and why it was not found.

    Parameters
    ----------
    model
        Of a problem whose duration is free.
    lost
        Where another search ended, which is slowed down a little to begin with.
    guess
        A motion that is slow enough for all limits, to begin with where that fails.
    settings
        Of the search; its iterations are those at the end.
    """
    low, high = model.problem.duration
    brief = replace(
        settings,
        most_iterations=min(_MOST_ITERATIONS, settings.most_iterations),
        tolerance=max(_ROUGH, settings.tolerance),
        barrier=_BARRIER,
        kept_barrier=_BARRIER,
    )
    whole = replace(settings, barrier=_BARRIER)
    spent, part, shortest = 0, _FIRST, lost
    duration = min(max((1.0 + _FIRST) * lost.duration, low), high)
    is_begun, last, tried = False, None, None
    while part >= _LEAST and duration >= low:
        found = solve_on_mesh(model.within((duration, high)), shortest, brief)
        spent += found.iterations
        if not found.failure:
            is_begun, shortest = True, found.trajectory
            if shortest.duration > (1.0 + _LONGER * part) * duration:
                break
            if found.iterations <= _EASY:
                part = min(2.0 * part, _QUICK)
        elif not is_begun and shortest is not guess:
            shortest, duration = guess, guess.duration
            continue
        elif not is_begun:
            break
        else:
            part *= 0.5
            if tried is not shortest:  # the optimum may be nearer than it is shorter
                last, tried = solve_on_mesh(model, shortest, whole), shortest
                spent += last.iterations
                if not last.failure:
                    break
        duration = shortest.duration * (1.0 - part)
    if last is None or tried is not shortest:
        last = solve_on_mesh(model, shortest, whole)
        spent += last.iterations
    return replace(last, iterations=spent)
