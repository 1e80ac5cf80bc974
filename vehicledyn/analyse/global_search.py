"""Search whole boxes of variables by differential evolution, without gradients."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_PER_VARIABLE, _FEWEST = 8, 8
"""Members of the population by variable, and members at least."""

_NOT_KEPT = 1e6
"""Added where constraints are not kept, far above any objective over its size."""


def explore(
    evaluate: Callable[[Floats], tuple[float, float] | None],
    bounds: tuple[Floats, Floats],
    *,
    n_runs: int,
    seed: int,
    size: float,
    mapped: Callable[[Callable[[Floats], float], Iterable[Floats]], Iterable[float]] = map,
) -> Floats:
    """Return the best point found, shape (n,), as one to polish with gradients.

    Points that keep the constraints are better than any that do not, those than points without a
    motion.

    Parameters
    ----------
    evaluate
        Returns objective and scaled violation of the constraints at a point, None where there is
        no motion.
    bounds
        Lowest and highest values, shape (n,) each.
    n_runs
        Evaluations, rounded to whole generations.
    seed
        Equal seeds give equal points.
    size
        Of the objective.
    mapped
        Evaluates the members of a generation, perhaps at once.

    References
    ----------
    Storn, Price (1997), Journal of Global Optimization 11, 341-359.
    """
    from scipy.optimize import differential_evolution

    low, width = bounds[0], bounds[1] - bounds[0]
    n = len(low)
    members = max(_FEWEST, min(_PER_VARIABLE * n, n_runs // 4))

    def worth(x: Floats) -> float:
        found = evaluate(low + width * x)
        if found is None:
            return 1e3 * _NOT_KEPT
        objective, violation = found
        return objective / size if violation <= 0.0 else _NOT_KEPT * (1.0 + min(violation, 100.0))

    generator = np.random.default_rng(seed)
    first = generator.permuted(
        (np.arange(members)[:, None] + generator.random((members, n))) / members, axis=0
    )
    found = differential_evolution(
        worth,
        [(0.0, 1.0)] * n,
        init=first,
        maxiter=max(n_runs // members - 1, 1),
        tol=0.0,
        rng=generator,
        polish=False,
        updating="deferred",
        workers=mapped,
    )
    return np.asarray(low + width * found.x, dtype=float)
