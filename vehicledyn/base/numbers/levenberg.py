"""The Levenberg-Marquardt method for the least squares of residuals near a start."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOST_STEPS = 200
_FIRST, _LEAST, _MOST = 1e-6, 1e-12, 1e8
_TENTH = 0.1


@np.errstate(over="ignore", invalid="ignore")  # a residual that overflows is no better
def least_squares(
    residual: Callable[[Array], Array],
    jacobian: Callable[[Array], Array],
    start: Array,
    *,
    is_solved: Callable[[Array], bool],
    scaled: bool = False,
) -> tuple[Array, Array]:
    """Return a point of least squared residuals near a start, and the residuals there.

    Steps minimise |J δ + h|² + λ |D δ|² by an orthogonal factorisation, so that they are the
    shortest ones where the residuals leave freedom. No point is worse than the one before.

    Parameters
    ----------
    residual, jacobian
        Functions of the unknowns, shapes (m,) and (m, n); a residual that is not finite makes
        the step shorter.
    start
        Unknowns to begin from, shape (n,), where both are finite.
    is_solved
        Whether residuals are small enough to stop at.
    scaled
        Whether D holds the largest norms so far of the columns of J, for unknowns of different
        units; it is the identity otherwise.

    References
    ----------
    Levenberg (1944), Quart. Appl. Math. 2, 164-168; Marquardt (1963), SIAM J. Appl. Math. 11,
    431-441; scaling by Moré (1978), Lecture Notes in Mathematics 630, 105-116.
    """
    q, h = start, residual(start)
    damping, scale = _FIRST, np.zeros(q.size)
    for _ in range(MOST_STEPS):
        if h.size == 0 or is_solved(h):
            break
        j = jacobian(q)
        scale = np.maximum(scale, np.linalg.norm(j, axis=0)) if scaled else np.ones(q.size)
        while True:
            step = _damped_step(j, h, damping, np.where(scale > 0.0, scale, 1.0))
            trial = q + step
            h_trial = residual(trial)
            if np.isfinite(h_trial).all() and h_trial @ h_trial < h @ h:
                damping = max(damping * _TENTH, _LEAST)
                break
            damping *= 10.0
            if damping > _MOST:
                return q, h
        q, h = trial, h_trial
    return q, h


def _damped_step(j: Array, h: Array, damping: float, scale: Array) -> Array:
    stacked = np.vstack([j, np.sqrt(damping) * np.diag(scale)])
    target = np.concatenate([-h, np.zeros(j.shape[1])])
    return np.asarray(np.linalg.lstsq(stacked, target, rcond=None)[0])
