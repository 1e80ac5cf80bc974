"""Equations in which time makes no difference, with time taken out of them.

Frames that run ahead of each other along a straight track have positions that grow with time, of
which only differences count; nothing but their values shows that.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from vehicledyn.base.errors import InputError
from vehicledyn.symbolic.equations import Equations

TIMES = np.concatenate([[0.0], np.geomspace(1e-2, 1e2, 40)])
"""Times at which equations are compared [s]."""

_MOST = 1e-6
_KICK = 1e-3
_POINTS = 3


def autonomous_form(equations: Equations, parameters: ArrayLike) -> Equations:
    """Return equations whose rates and residuals do not contain time.

    Parameters
    ----------
    equations
        The equations.
    parameters
        Values of their parameters in SI, shape (n_parameters,).

    Raises
    ------
    InputError
        If rates or residuals change with time, by more than rounding does, at one of ``TIMES``
        at the starting point or beside it.
    """
    import casadi

    e = equations
    whole = casadi.vertcat(e.rate, e.residual)
    if not casadi.which_depends(whole, e.time, 1, False)[0]:
        return e
    function = casadi.Function("at_time", [e.time, e.state, e.algebraic, e.parameter], [whole])
    state = np.array([s.start for s in e.states])
    unknowns = np.array([u.start for u in e.unknowns])
    random = np.random.default_rng(0)
    values = np.asarray(parameters, dtype=float)
    for kick in (0.0, *[_KICK] * (_POINTS - 1)):
        x, z = (s + kick * random.standard_normal(s.size) for s in (state, unknowns))
        seen = np.array(function.map(len(TIMES))(TIMES[None, :], x, z, values))
        with np.errstate(invalid="ignore"):
            apart = np.abs(seen - seen[:, :1])
        if not (apart <= _MOST * (1.0 + np.abs(seen[:, :1]))).all():
            raise InputError(
                f"model '{e.name}' depends on time: limit cycles are those of free motions; "
                "hold drives and excitations still, and take a straight, even track"
            )
    given = [e.rate, e.residual, *([] if e.slopes is None else [e.slopes])]
    rate, residual, *slopes = casadi.substitute(given, [e.time], [casadi.SX(0.0)])
    return replace(
        e,
        rate=rate,
        residual=residual,
        slopes=slopes[0] if slopes else None,
        motion_residuals=None,
    )
