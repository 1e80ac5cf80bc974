"""The steps with which a motion is followed for its derivatives."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepare import AssembledPoint
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.errors import InputError
from vehicledyn.base.units import shown
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.integrate.accuracy.proposed_step import proposed_step
from vehicledyn.integrate.channel_ranges import Ranges
from vehicledyn.integrate.fixed_step import steps_per_interval
from vehicledyn.kernel.engine import Method
from vehicledyn.kernel.tangent_code import StepRow

Floats = NDArray[np.float64]

FIXED = (Method.RK4, Method.SYMPLECTIC_EULER)
"""Methods with derivatives."""


_MOST_NUMBERS = 100_000_000
"""Of the samples and their derivatives, which are all kept at once."""


def grid_of(
    loaded: LoadedScenario, prepared: Prepared, start: AssembledPoint, notes: list[str]
) -> tuple[StepRow, int]:
    """Return the steps of a scenario; a method without derivatives is replaced, as noted."""
    solver, interval = loaded.scenario.solver, loaded.scenario.output.interval
    method = getattr(solver, "fixed_method", None)
    step = getattr(solver, "step", None) if method in FIXED else None
    if method not in FIXED:
        method = Method.RK4
    if step is None:
        point = (0.0, start.state, start.unknowns)
        step = proposed_step(prepared.kernel, method, point, interval)
        name = Method(method).name.lower()
        notes.append(f"derivatives are those of {name} steps of {shown(step, 's')}")
    per_interval = steps_per_interval(step, interval)
    whole = loaded.scenario.duration / interval
    n_intervals = math.floor(whole * (1.0 + 1e-12) + 1e-9)
    return StepRow(int(method), 0.0, interval, per_interval), n_intervals


def missed_by(ranges: Ranges, coarse: Floats, fine: Floats) -> float:
    """Return the largest difference of channels, as a part of each one's range.

    Shape (n_samples, n_channels) each, infinite where the shapes differ. Errors of constraints and
    the like count as little as what rounding makes of a zero.
    """
    if coarse.shape != fine.shape:
        return math.inf
    spans = np.ptp(fine, axis=0)
    sizes = np.maximum(spans, 1e-9 * np.max(np.abs(fine), axis=0, initial=0.0))
    sizes = np.where(ranges.matters, np.maximum(sizes, ranges.noise), math.inf)
    differences = np.max(np.abs(coarse - fine), axis=0, initial=0.0)
    return float(np.max(differences / sizes, initial=0.0))


def check_size(n_intervals: int, width: int) -> None:
    """Refuse a motion whose samples, each of so many numbers, do not fit the memory."""
    if n_intervals * width > _MOST_NUMBERS:
        raise InputError(
            f"output.interval: {n_intervals} samples of {width} values and derivatives are more "
            "than fit the memory; take a longer one, a shorter duration or fewer of them",
            about=["output.interval"],
        )
