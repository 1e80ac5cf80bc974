"""Say when the motion that a model is linearised about is not steady."""

from __future__ import annotations

import numpy as np

from vehicledyn.analyses.preparation.prepare import AssembledPoint
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.units import shown

STEADY = 1e-6
"""Acceleration above which a reference motion is called unsteady [m/s², rad/s²]."""


def unsteadiness(prepared: Prepared, point: AssembledPoint, limit: float = STEADY) -> str:
    """Return a remark on a reference motion that accelerates, empty if it is steady.

    Eigenvalues and responses about such a motion hold only while it lasts.
    """
    e = prepared.equations
    rates = prepared.kernel.rates(prepared.subject.balance_time, point.state, point.unknowns)
    accelerations = rates[list(e.speeds)]
    if not accelerations.size or np.abs(accelerations).max() <= limit:
        return ""
    worst = int(np.argmax(np.abs(accelerations)))
    state = e.states[e.speeds[worst]]
    value = shown(float(accelerations[worst]), state.unit).replace("/s", "/s^2")
    return f"the reference motion is not steady: {state.name} changes by {value}"
