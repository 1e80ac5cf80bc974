"""States that a motion depends on, found from the structure of its equations and from values.

A rolling body's place and heading stand in its equations, but their values cancel: a shift of them
changes no rate that matters. Structure alone cannot show that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from vehicledyn.symbolic.equations import Equations

_SHIFTS = (1e-3, 0.17, -1.0)
"""Shifts by which coordinates are moved [m, rad]."""

_COORDINATES = ("m", "rad")
"""Units of coordinates that may be shifted."""

_MOST = 1e-9
"""Relative change of a rate that rounding makes."""

_KICK, _POINTS = 1e-2, 3


def mattering_states(e: Equations) -> list[int]:
    """Return the states that rates of other kept states, or residuals, depend on by structure."""
    return _closed_set(_structure(e), len(e.states))


def states_of_motion(e: Equations, parameters: ArrayLike) -> list[int]:
    """Return the states on which the motion depends, by structure and by value.

    Coordinates are left out whose shift changes no rate of a kept state and no residual.

    Parameters
    ----------
    e
        Equations without time.
    parameters
        Values of their parameters in SI, shape (n_parameters,).
    """
    import casadi

    depends = _structure(e)
    kept = _closed_set(depends, len(e.states))
    among = [k for k in kept if e.states[k].unit in _COORDINATES and k not in set(e.velocities)]
    whole = casadi.vertcat(e.rate, e.residual)
    function = casadi.Function("rates", [e.time, e.state, e.algebraic, e.parameter], [whole])
    start = np.array([s.start for s in e.states])
    unknowns = np.array([u.start for u in e.unknowns])
    random = np.random.default_rng(0)
    values = np.asarray(parameters, dtype=float)
    changed = np.zeros((depends.shape[0], len(among)), dtype=bool)
    for kick in (0.0, *[_KICK] * (_POINTS - 1)):
        x, z = (s + kick * random.standard_normal(s.size) for s in (start, unknowns))
        before = np.array(function(0.0, x, z, values)).ravel()
        allowed = _MOST * (1.0 + np.abs(before))
        for column, k in enumerate(among):
            for shift in _SHIFTS:
                moved = x.copy()
                moved[k] += shift
                with np.errstate(invalid="ignore"):
                    apart = np.abs(np.array(function(0.0, moved, z, values)).ravel() - before)
                    changed[:, column] |= ~(apart <= allowed)
    depends[:, among] &= changed
    return _closed_set(depends, len(e.states))


def _structure(e: Equations) -> np.ndarray:
    """Return which rates and residuals (rows) may depend on which states."""
    import casadi

    pattern = casadi.jacobian_sparsity(casadi.vertcat(e.rate, e.residual), e.state)
    return np.array(casadi.DM(pattern, 1.0).full(), dtype=bool)


def _closed_set(depends: np.ndarray, n: int) -> list[int]:
    """Return the states on which rates of this very set of states, or residuals, depend."""
    kept = list(range(n))
    searching = True
    while searching:
        rows = [*kept, *range(n, depends.shape[0])]
        left = [k for k in kept if depends[rows, k].any()]
        searching, kept = len(left) < len(kept), left
    return kept
