"""Short stretches of a run taken again with its step and with half of it, for their difference."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.kernel.engine import Count, March, Method, Rows, Status, Vector
from vehicledyn.kernel.kernel import Kernel

STEPS = 4
"""Steps of a window: an unstable mode has shown itself by then, and the price is low."""


@dataclass(frozen=True)
class Grid:
    """When a run with a fixed step takes its steps and samples; ``method`` as in ``March``."""

    method: int
    start: float
    interval: float
    per_interval: int
    n_intervals: int

    @property
    def step(self) -> float:
        """Step size [s]."""
        return self.interval / self.per_interval

    @property
    def n_steps(self) -> int:
        """Number of steps of the whole run."""
        return self.n_intervals * self.per_interval


@dataclass(frozen=True)
class Place:
    """A sample that a window begins at: its number, time [s], states and unknowns."""

    index: int
    time: float
    state: Vector
    unknowns: Vector


def order_of(method: int) -> int:
    """Return the order of a fixed-step method."""
    if method >= Method.CHEBYSHEV:
        return 2
    return 4 if method == Method.RK4 else 1


def stages_of(method: int) -> int:
    """Return how often a step evaluates the rates."""
    if method >= Method.CHEBYSHEV:
        return method - Method.CHEBYSHEV
    return 4 if method == Method.RK4 else 1


def total_error(difference: Vector, method: int) -> Vector:
    """Return the error of a step from how far half of it leads elsewhere (Richardson)."""
    power = 2.0 ** order_of(method)
    return difference * (power / (power - 1.0))


def window_difference(kernel: Kernel, grid: Grid, place: Place) -> Vector | None:
    """Return how far half the step leads from the step, in each channel.

    Parameters
    ----------
    kernel
        The model with its parameters set.
    grid
        The run.
    place
        Where the window begins.

    Returns
    -------
    Vector or None
        Shape (n_channels,), infinite where one of them cannot be computed or is interrupted by an
        event; None where an event interrupts both.
    """
    return two_ends_apart(*(_outputs(kernel, grid, place, factor) for factor in (1, 2)))


def two_ends_apart(one: Vector | None, other: Vector | None) -> Vector | None:
    """Return how far two ends of a window lie apart, None where an event is in both.

    Infinite where an event is in one of them only, or one is no number and the other is.
    """
    if one is None and other is None:
        return None
    if one is None or other is None:
        known = other if one is None else one
        nowhere: Vector = np.full(0 if known is None else len(known), np.inf)
        return nowhere
    with np.errstate(all="ignore"):
        distance = np.abs(one - other)
    same = np.isnan(one) & np.isnan(other)
    apart: Vector = np.where(same, 0.0, np.where(np.isnan(distance), np.inf, distance))
    return apart


def _outputs(kernel: Kernel, grid: Grid, place: Place, divided: int) -> Vector | None:
    """Return the channels at the end of a window; infinite ones where it is not reached."""
    e = kernel.equations
    count = STEPS * divided
    march = March(
        grid.method,
        place.time,
        STEPS * grid.step,
        count,
        place.state,
        place.unknowns,
        sides=np.zeros(len(e.events), dtype=np.intc),
    )
    rows = Rows(*[np.zeros((2, len(items))) for items in (e.states, e.unknowns, e.channels)])
    status = kernel.advance(march, count, rows)
    if status is Status.EVENT:
        return None
    if status is not Status.SOLVED or not march.ledger.counts[Count.SAMPLES]:
        rows.outputs[0] = np.inf
    found: Vector = rows.outputs[0]
    return found


def operations_of_step(kernel: Kernel, method: int) -> float:
    """Return about how many operations a step of a run takes."""
    counted = kernel.report.operations
    once = counted.get("rates", 0) + 2 * counted.get("blocks", 0)
    return float(max(50, once) * stages_of(method))
