"""States of constraints with multipliers, put onto the constraints.

Off these a state is not that of the motion: the equations project it anew wherever they are
evaluated, and what is projected away then does not stay the same.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.kernel.kernel import Kernel

Vector = NDArray[np.float64]


def projected(kernel: Kernel, state: Vector, outputs: Vector) -> Vector:
    """Return a state on the constraints, from the channels there."""
    e = kernel.equations
    places = {c.name: k for k, c in enumerate(e.channels)}
    found = state.copy()
    for k in (*e.positions, *e.velocities):
        found[k] = outputs[places[e.states[k].name]]
    return found
