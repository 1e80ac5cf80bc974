"""Bounds of the variables of a nonlinear program."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimal_control.layout import Layout
from vehicledyn.analyse.optimal_control.problem import BEND, POINTS, ControlProblem

Floats = NDArray[np.float64]


def variable_bounds(
    problem: ControlProblem, layout: Layout, distances: Floats
) -> tuple[Floats, Floats]:
    """Return the lower and upper bounds of all variables, divided by their scales.

    ``distances`` are those along the path at which intervals end, but the last, where the mesh
    follows the path [m].
    """
    low, high = (_side(problem, layout, distances, side) for side in (0, 1))
    return low, high


def _side(p: ControlProblem, layout: Layout, distances: Floats, side: int) -> Floats:
    far, n, sign = (-np.inf, np.inf)[side], layout.n, (-1.0, 1.0)[side]
    edge = [np.array([_sided(c, place)[side] for c in p.controls]) for place in range(3)]
    values = np.tile(edge[1], (n + 1, 1)) if p.controls else np.zeros((n + 1, 0))
    if p.controls:
        values[0], values[-1] = edge[0], edge[2]
    values[:, [k for k, c in enumerate(p.controls) if c.order == POINTS]] = 0.0
    rates = np.tile([sign * c.rate if c.order == BEND else far for c in p.controls], (n + 1, 1))
    for k, c in enumerate(p.controls):
        if c.order != BEND:
            rates[:, k] = 0.0
        elif c.start[0] == c.start[1]:
            rates[0, k] = 0.0
    distance = np.full(layout.places["distance"].shape, far)
    if layout.places["lengths"].size:
        distance[:-1, -1, 0] = distances
    bend = [sign * c.acceleration if c.order == BEND else 0.0 for c in p.controls]
    return layout.pack(
        duration=p.duration[side],
        lengths=(0.0, np.inf)[side],
        first=p.start[:, side],
        states=_inside(p, layout, side),
        unknowns=far,
        first_distance=p.path_start[side],
        distance=distance,
        values=values,
        rates=rates,
        accelerations=bend,
        inner=[edge[1][k] if c.order == POINTS else 0.0 for k, c in enumerate(p.controls)],
    )


def _inside(p: ControlProblem, layout: Layout, side: int) -> Floats:
    inside = np.broadcast_to(p.bounds[:, side], layout.places["states"].shape).copy()
    worse = (np.maximum, np.minimum)[side]
    inside[-1, -1] = worse(inside[-1, -1], p.end[:, side])
    return inside


def _sided(control: Any, place: int) -> tuple[float, float]:
    """Return the bounds of a control at the start (0), within (1) or at the end (2)."""
    low, high = control.low, control.high
    if place != 1:
        edge = control.start if place == 0 else control.end
        low, high = max(low, edge[0]), min(high, edge[1])
    return low, high
