"""Key figures of any system, found block by block: ranges of channels, errors of the energy."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.numbers.jumps import jumping_integral
from vehicledyn.base.numbers.spline import MARGIN
from vehicledyn.integrate.estimated_accuracy import ENERGY
from vehicledyn.integrate.judged_quantities import EnergyBalance
from vehicledyn.road.manoeuvres.channel_recorder import BLOCK, ChannelRows, Recording

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry

ENERGIES, POWER = ("energy.kinetic", "energy.gravity"), "power.forces"
"""Channels that the energy's error is made from."""

_LEAST_OF_KINETIC = 0.1
"""Part of the kinetic energy that counts as exchanged at least."""

_UNEVEN = 1e-6
"""Difference of two intervals between samples, as a part of them, from which they are uneven."""

Floats = NDArray[np.float64]


def ranges(recording: Recording, names: Sequence[str]) -> tuple[dict[str, float], dict[str, float]]:
    """Return the smallest and the largest values of channels by name, NaN where one is NaN."""
    low, high = dict.fromkeys(names, np.inf), dict.fromkeys(names, -np.inf)
    for block in recording.blocks(names):
        for name, values in block.channels.items():
            low[name] = float(np.minimum(low[name], values.min()))
            high[name] = float(np.maximum(high[name], values.max()))
    return low, high


def energy_error(recording: Recording, jumps: Sequence[float] = ()) -> Iterator[SummaryEntry]:
    """Yield the largest difference between the energy gained and the work of all forces.

    Implicit steps of order two let it swing with the motion by a part that the square of the step
    gives. It is infinite where the samples of a run that diverged are too large to compute it.
    """
    from vehicledyn.results.store.layout import SummaryEntry

    found = energy_balance(recording, jumps)
    if found is None:
        return
    yield SummaryEntry(
        ENERGY,
        found.error,
        "J",
        "Largest difference of energy gained and work done at any time, whether it lasts or swings "
        "with the motion, as far as the samples tell",
    )


def rough_balance(recording: Recording) -> EnergyBalance | None:
    """Return the balance of the energy by local cubics, at a tenth of the price, None as below.

    Samples must fit into memory, each at a time of its own. Its uncertainty is what cubics differ
    by from straight lines, or from cubics through every second sample where that is more: contacts
    shorter than a few samples.
    """
    if recording.count < 2 or not {*ENERGIES, POWER} <= set(recording.channels):
        return None
    rows = recording.rows((*ENERGIES, POWER), 0, recording.count)
    with np.errstate(over="ignore", invalid="ignore"):
        power, energy = rows.channels[POWER], _energy(rows)
        parts, lines = _rough_work(rows.time, power)
        work = np.append(0.0, np.cumsum(parts))
        error = float(np.abs(energy - energy[0] - work).max())
        spans = [float(np.ptp(rows.channels[name])) for name in ENERGIES]
        largest = _LEAST_OF_KINETIC * float(rows.channels[ENERGIES[0]].max())
        coarse = np.append(0.0, np.cumsum(_rough_work(rows.time[::2], power[::2])[0]))
        differences = np.append(np.cumsum(parts - lines), work[::2] - coarse)
        exchanged = max(largest, *spans, float(np.ptp(work)))
        return EnergyBalance(error, exchanged, float(np.abs(differences).max()))


def _rough_work(times: Floats, power: Floats) -> tuple[Floats, Floats]:
    """Return the work between samples by cubics and by straight lines, shapes (n - 1,) [J].

    Both are by lines where times are uneven.
    """
    spans = np.diff(times)
    is_even = np.abs(np.diff(spans)) < _UNEVEN * spans[1:]
    bend = power[1:-2] + power[2:-1] - power[:-3] - power[3:]
    lines: Floats = 0.5 * spans * (power[1:] + power[:-1])
    work = lines.copy()
    work[1:-1] += np.where(is_even[:-1] & is_even[1:], spans[1:-1] * bend / 24.0, 0.0)
    return work, lines


def energy_balance(recording: Recording, jumps: Sequence[float] = ()) -> EnergyBalance | None:
    """Return the balance of the energy, None where it is not recorded.

    Exchanged is the largest range of kinetic energy, energy of gravity and work of the forces, no
    less than a tenth of the kinetic energy: a motion without forces exchanges nothing. Both are
    infinite where the samples of a run that diverged are too large to compute them. ``jumps`` are
    when forces may jump [s].
    """
    if recording.count < 2 or not {*ENERGIES, POWER} <= set(recording.channels):
        return None
    ends = [recording.rows((), k, k + 1).time[0] for k in (0, recording.count - 1)]
    if not ends[1] > ends[0]:
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        found = _balance(recording, jumps)
    error, exchanged = (x if np.isfinite(x) else np.inf for x in found)
    return EnergyBalance(error, exchanged)


def _balance(recording: Recording, jumps: Sequence[float]) -> tuple[float, float]:
    start, error, done = _Start(recording.rows(ENERGIES, 0, 1)), 0.0, [0.0, 0.0]
    for first in range(0, recording.count, BLOCK):
        last = min(first + BLOCK, recording.count)
        begin, end = max(0, first - MARGIN), min(recording.count, last + MARGIN)
        rows = recording.rows((*ENERGIES, POWER), begin, end)
        work = _work(rows, jumps)
        inside = slice(first - begin, last - begin)
        work += start.work - work[inside.start]
        gained = _energy(rows)[inside] - start.energy
        error = float(np.maximum(error, np.abs(gained - work[inside]).max()))
        done = [np.minimum(done[0], work[inside].min()), np.maximum(done[1], work[inside].max())]
        if end > last:
            start.work = float(work[last - begin])
    low, high = ranges(recording, ENERGIES)
    largest = _LEAST_OF_KINETIC * high[ENERGIES[0]]
    spans = [done[1] - done[0], *(high[name] - low[name] for name in ENERGIES)]
    return error, float(np.max([*spans, largest]))


class _Start:
    """Energy of the first sample, and the work until the first sample of a block [J]."""

    def __init__(self, first: ChannelRows) -> None:
        self.energy, self.work = float(_energy(first)[0]), 0.0


def _energy(rows: ChannelRows) -> Floats:
    return rows.channels[ENERGIES[0]] + rows.channels[ENERGIES[1]]


def _work(rows: ChannelRows, jumps: Sequence[float]) -> Floats:
    """Return the work of the forces since the first of some samples, shape (n,) [J]."""
    kept, first = np.unique(rows.time, return_index=True)
    if len(kept) < 2:
        return np.zeros(len(rows.time))
    power, energy = rows.channels[POWER][first], _energy(rows)[first]
    return np.interp(rows.time, kept, jumping_integral(kept, power, jumps, energy))
