"""Key figures of any system, found block by block: ranges of channels, errors of the energy."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.numbers.spline import MARGIN, spline_integral
from vehicledyn.road.manoeuvres.channel_recorder import BLOCK, Recording, Rows

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry

ENERGIES, POWER = ("energy.kinetic", "energy.gravity"), "power.forces"
"""Channels that the energy's error is made from."""

Floats = NDArray[np.float64]


def ranges(recording: Recording, names: Sequence[str]) -> tuple[dict[str, float], dict[str, float]]:
    """Return the smallest and the largest values of channels by name, NaN where one is NaN."""
    low, high = dict.fromkeys(names, np.inf), dict.fromkeys(names, -np.inf)
    for block in recording.blocks(names):
        for name, values in block.channels.items():
            low[name] = float(np.minimum(low[name], values.min()))
            high[name] = float(np.maximum(high[name], values.max()))
    return low, high


def energy_error(recording: Recording) -> Iterator[SummaryEntry]:
    """Yield the largest difference between the energy gained and the work of all forces.

    It is infinite where the samples of a run that diverged are too large to compute it.
    """
    from vehicledyn.results.store.layout import SummaryEntry

    if recording.count < 2 or not {*ENERGIES, POWER} <= set(recording.channels):
        return
    ends = [recording.rows((), k, k + 1).time[0] for k in (0, recording.count - 1)]
    if not ends[1] > ends[0]:
        return
    with np.errstate(over="ignore", invalid="ignore"):
        error = _largest_error(recording)
    yield SummaryEntry(
        "energy_drift",
        error if np.isfinite(error) else np.inf,
        "J",
        "Largest difference of energy gained and work done, as far as the samples tell",
    )


def _largest_error(recording: Recording) -> float:
    start, error = _Start(recording.rows(ENERGIES, 0, 1)), 0.0
    for first in range(0, recording.count, BLOCK):
        last = min(first + BLOCK, recording.count)
        begin, end = max(0, first - MARGIN), min(recording.count, last + MARGIN)
        rows = recording.rows((*ENERGIES, POWER), begin, end)
        work = _work(rows)
        inside = slice(first - begin, last - begin)
        work += start.work - work[inside.start]
        gained = _energy(rows)[inside] - start.energy
        error = float(np.maximum(error, np.abs(gained - work[inside]).max()))
        if end > last:
            start.work = float(work[last - begin])
    return error


class _Start:
    """Energy of the first sample, and the work until the first sample of a block [J]."""

    def __init__(self, first: Rows) -> None:
        self.energy, self.work = float(_energy(first)[0]), 0.0


def _energy(rows: Rows) -> Floats:
    return rows.channels[ENERGIES[0]] + rows.channels[ENERGIES[1]]


def _work(rows: Rows) -> Floats:
    """Return the work of the forces since the first of some samples, shape (n,) [J]."""
    kept, first = np.unique(rows.time, return_index=True)
    if len(kept) < 2:
        return np.zeros(len(rows.time))
    return np.interp(rows.time, kept, spline_integral(kept, rows.channels[POWER][first]))
