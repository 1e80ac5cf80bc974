"""Where the search for an optimal manoeuvre begins: coasting, along the path, or driven there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimal_control.path_curves import PathCurves
from vehicledyn.analyse.optimal_control.problem import ControlProblem
from vehicledyn.analyse.optimal_control.trajectory import DEGREE, Trajectory, radau_points
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.studies.manoeuvre_optimisation.driven_guess import GuessDriver, Vehicle
from vehicledyn.studies.manoeuvre_optimisation.model import PreparedManoeuvre, duration_bounds
from vehicledyn.studies.mistakes import Mistakes

Floats = NDArray[np.float64]


def first_guess(manoeuvre: PreparedManoeuvre) -> tuple[Trajectory, str]:
    """Return the motion to begin with, and a warning if it should be driven but could not.

    States go in a straight line from start to end where both are given; else they coast. On a
    path a driver takes a vehicle along at the speed of the start; what has no heading, or is not
    to be driven, has its places follow the path.

    Raises
    ------
    InputError
        If the start is outside the corridor.
    """
    study, problem = manoeuvre.study, manoeuvre.problem
    n, mesh = study.intervals, np.linspace(0.0, 1.0, study.intervals + 1)
    duration = duration_bounds(study)[2]
    along = _distances(manoeuvre)
    guessed = isinstance(study.duration, dict) and "guess" in study.duration
    if along is not None and manoeuvre.speed > 0.0 and not guessed:
        duration = float(np.clip((along[1] - along[0]) / manoeuvre.speed, *problem.duration))
    inner = (mesh[:-1, None] + np.diff(mesh)[:, None] * radau_points()).ravel()
    parts = np.concatenate([[0.0], inner])
    states = _states(problem, manoeuvre.point.state, parts, duration)
    distance = np.zeros(parts.size)
    if along is not None and problem.path is not None:
        distance = along[0] + (along[1] - along[0]) * parts
        _follow(manoeuvre, states, distance, (along[1] - along[0]) / duration)
        mistakes = Mistakes(study.document)
        with mistakes.at("start"):
            _check_start(problem, states[0], distance[0])
        mistakes.refuse()
    n_u = len(problem.controls)
    low, high = (np.array([getattr(c, k) for c in problem.controls]) for k in ("low", "high"))
    values = np.tile(np.clip(0.0, low, high), (n + 1, 1))
    unknowns = np.tile(manoeuvre.point.unknowns, (n, DEGREE, 1))
    along_path = Trajectory(
        duration,
        mesh,
        states[0],
        states[1:].reshape(n, DEGREE, -1),
        unknowns,
        float(distance[0]),
        distance[1:].reshape(n, DEGREE),
        values,
        np.zeros((n + 1, n_u)),
        np.zeros((n, n_u)),
        np.tile(np.clip(0.0, low, high), (n, DEGREE, 1)),
    )
    try:
        return _driven(manoeuvre, along_path) or along_path, ""
    except NumericalError as error:
        return along_path, (
            f"warning: driving along the path to begin with failed: {error}; the search began with "
            "a motion along it that forces do not bring about, from which it may not converge: "
            "start slower, or widen the bounds of the controls"
        )


def _driven(manoeuvre: PreparedManoeuvre, along_path: Trajectory) -> Trajectory | None:
    """Return the motion of a vehicle with a driver, None where nothing is to be driven.

    Raises NumericalError where it cannot be driven. A closed path is driven twice, since the first
    round begins straight.
    """
    problem, prepared, study = manoeuvre.problem, manoeuvre.prepared, manoeuvre.study
    index = {s.name: k for k, s in enumerate(prepared.equations.states)}
    heading = index.get(f"{prepared.subject.ports.body}.yaw")
    if problem.path is None or study.track is None or heading is None or manoeuvre.speed <= 0.0:
        return None
    pairs = dict(zip(prepared.equations.positions, prepared.equations.velocities, strict=True))
    x, y = problem.path.place
    vehicle = Vehicle((x, y), heading, (pairs[x], pairs[y]), manoeuvre.speed)
    driver = GuessDriver(problem, problem.path, prepared.kernel, vehicle)
    return driver.drive(along_path, laps=2 if study.track.closed and problem.growth else 1)


def state_scales(guess: Trajectory) -> Floats:
    """Return by what states are divided, shape (n_x,): their size in the guess, at least one."""
    return np.asarray(np.maximum(np.abs(guess.all_states).max(axis=0, initial=0.0), 1.0))


def _middle(bounds: Floats, usual: float) -> float:
    low, high = bounds
    if np.isfinite(low) and np.isfinite(high):
        return float(0.5 * (low + high))
    return float(np.clip(usual, low, high))


def _states(problem: ControlProblem, point: Floats, parts: Floats, duration: float) -> Floats:
    e = problem.equations
    first = np.array([_middle(b, p) for b, p in zip(problem.start, point, strict=True)])
    states = np.tile(first, (parts.size, 1))
    for position, velocity in zip(e.positions, e.velocities, strict=True):
        states[:, position] += parts * duration * first[velocity]
    for k, bounds in enumerate(problem.end):
        if np.isfinite(bounds).any():
            states[:, k] = first[k] + parts * (_middle(bounds, first[k]) - first[k])
    for k, growth in problem.growth.items():
        states[:, k] = first[k] + parts * growth
    return states


def _distances(manoeuvre: PreparedManoeuvre) -> tuple[float, float] | None:
    """Return the distances along the path at start and end [m]."""
    problem, study = manoeuvre.problem, manoeuvre.study
    if problem.path is None or study.track is None:
        return None
    begin = _middle(np.array(problem.path_start), 0.0)
    for item in problem.final:
        if item.what.kind == "path" and item.what.index == 0:
            return begin, _middle(np.array([item.low, item.high]), study.track.length)
    if study.track.closed:
        return begin, begin + study.track.length
    return begin, min(begin + manoeuvre.speed * problem.duration[1], study.track.length)


def _follow(manoeuvre: PreparedManoeuvre, states: Floats, distance: Floats, speed: float) -> None:
    """Put the places of a motion on its path, with the heading and rates of the vehicle."""
    path, prepared = manoeuvre.problem.path, manoeuvre.prepared
    assert path is not None
    x, y = path.place
    at = [np.interp(distance, path.distance, v) for v in (path.x, path.y)]
    ways = [np.gradient(v, path.distance) for v in (path.x, path.y)]
    heading = np.unwrap(np.arctan2(ways[1], ways[0]))
    heading = np.interp(distance, path.distance, heading)
    kept = states[0].copy()
    states[:, x], states[:, y] = at
    index = {s.name: k for k, s in enumerate(prepared.equations.states)}
    body = prepared.subject.ports.body
    pairs = dict(zip(prepared.equations.positions, prepared.equations.velocities, strict=True))
    moving = speed if speed > 0.0 else 0.0
    states[:, pairs[x]], states[:, pairs[y]] = moving * np.cos(heading), moving * np.sin(heading)
    if body and f"{body}.yaw" in index:
        yaw = index[f"{body}.yaw"]
        states[:, yaw] = heading
        states[:, pairs[yaw]] = np.gradient(heading, distance) * speed
    fixed = manoeuvre.problem.start[:, 0] == manoeuvre.problem.start[:, 1]
    states[0, fixed] = kept[fixed]


def _check_start(problem: ControlProblem, state: Floats, distance: float) -> None:
    """Refuse a start outside the corridor."""
    path = problem.path
    assert path is not None
    if not (problem.start[list(path.place), 0] == problem.start[list(path.place), 1]).all():
        return
    curves = PathCurves(path)
    x, y = (float(state[k]) for k in path.place)
    near = (
        np.argmin(np.hypot(path.x - x, path.y - y))
        if problem.path_start[0] != problem.path_start[1]
        else None
    )
    at = distance if near is None else float(path.distance[near])
    gap, offset = (float(v) for v in curves.seen(at, x, y))
    right, left = (float(v) for v in curves.sides(at))
    slack = 1e-9
    if near is None and abs(gap) > 1e-6:
        raise InputError(
            f"the motion starts {gap:+.3g} m along the path from start.path.distance = "
            f"{distance:g} m; leave that out, or start at its place"
        )
    if not -right - slack <= offset <= left + slack:
        raise InputError(
            f"is outside the corridor, {offset:.4g} m to the left of the path where "
            f"{-right:.4g} m to {left:.4g} m are allowed"
        )
