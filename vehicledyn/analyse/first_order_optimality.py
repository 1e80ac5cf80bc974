"""How far a point is from meeting the Karush-Kuhn-Tucker conditions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.trust_region.search import ScaledTerms

Floats = NDArray[np.float64]

ACTIVE = 1e-5
"""Distance of a constraint or bound to its limit, scaled, within which it is active."""


def stationarity(x: Floats, terms: ScaledTerms) -> tuple[float, Floats, list[int]]:
    """Return what no active constraint takes of the gradient, multipliers, variables at bounds."""
    from scipy.optimize import nnls

    active = [k for k, value in enumerate(terms.constraints) if value <= ACTIVE]
    lower, upper = np.flatnonzero(x <= ACTIVE), np.flatnonzero(x >= 1.0 - ACTIVE)
    unit = np.eye(len(x))
    columns = np.vstack([terms.jacobian[active], unit[lower], -unit[upper]]).T
    multipliers = np.zeros(len(terms.constraints))
    if not columns.shape[1]:
        return float(np.max(np.abs(terms.gradient))), multipliers, []
    weights, _ = nnls(columns, terms.gradient)
    multipliers[active] = weights[: len(active)]
    left = float(np.max(np.abs(columns @ weights - terms.gradient)))
    return left, multipliers, sorted({*map(int, lower), *map(int, upper)})
