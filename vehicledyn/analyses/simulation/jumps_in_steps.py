"""Report forces that jump within steps of fixed size, which smear the jump over the step."""

from __future__ import annotations

from typing import Any

import numpy as np

from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.analyses.preparation.time_jumps import laws_over_time, time_jumps
from vehicledyn.base.units import shown

_BESIDE = 1e-9
"""Time by which laws are evaluated beside a jump, part of the step."""
_WITHIN = 1e-6
"""Part of a step by which a jump lies away from its ends."""
_JUMP = 1e-6
"""Part of the largest value that a jump must have to count."""


def jumps_in_steps(prepared: Prepared, solver: Any, duration: float) -> list[str]:
    """Return a line on the first force of time alone that jumps within a step, if there is one.

    Where a system has events they may end steps there, and nothing is said.
    """
    step = getattr(solver, "step", None)
    system = getattr(prepared.subject, "system", None)
    if step is None or system is None or prepared.equations.events:
        return []
    inside = [
        time
        for time in time_jumps(system, 0.0, duration)
        if abs(time / step - round(time / step)) > _WITHIN
    ]
    if not inside:
        return []
    names, evaluate = laws_over_time(system)
    for time in inside:
        low, high = (evaluate(time + side * _BESIDE * step) for side in (-1.0, 1.0))
        jumps = np.abs(high - low) > _JUMP * np.maximum(np.abs(high), np.abs(low))
        if jumps.any():
            at, name = f"{time:.9g} s", names[int(np.argmax(jumps))]
            return [
                f"'{name}' jumps at t = {at}, within a step of {shown(step, 's')}, which takes it "
                f"for a part of the step too long or too short; 'events: {{jump: {{when: time - "
                f"{at}}}}}' lets a step end there"
            ]
    return []
