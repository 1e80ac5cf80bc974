"""Sweep the loops of a system along driven paths: positions, velocity ratios, singular places."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import product

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.continuation import (
    PathOutcome,
    SingularPlace,
    follow,
    singular_direction,
    tangents,
)
from vehicledyn.analyses.mechanism.driven_mechanism import Mechanism
from vehicledyn.base.step_memory import Memory
from vehicledyn.base.units import shown

Array = NDArray[np.float64]

Progress = Callable[[str, float | None], None]


@dataclass(frozen=True)
class PathDrive:
    """A coordinate or another channel and the values it is given one after the other, in SI."""

    channel: str
    values: tuple[float, ...]


_Seen = tuple[Array, Array | None]


@dataclass(frozen=True)
class PathSample:
    """One place of a sweep: its number in the grid, all channels, velocity ratios.

    ``ratios`` are the derivatives of the channels, and of the velocities, by each drive, shape
    (n_drives, n_channels + n_speeds); not numbers where the place is singular.
    """

    index: tuple[int, ...]
    coordinates: Array
    values: Array
    ratios: Array


@dataclass(frozen=True)
class Finding:
    """A singular place, or one beyond which the loops do not close: drives, words."""

    drives: tuple[float, ...]
    coordinates: tuple[str, ...]
    words: str


@dataclass
class Sweep:
    """Samples in the order of the grid, singular places, and what could not be reached."""

    samples: list[PathSample] = field(default_factory=list)
    singular: list[Finding] = field(default_factory=list)
    failures: list[Finding] = field(default_factory=list)
    is_interrupted: bool = False


def run_sweep(
    machine: Mechanism,
    drives: Sequence[PathDrive],
    *,
    together: bool,
    progress: Progress = lambda text, part: None,
    memory: Memory | None = None,
) -> Sweep:
    """Return the places of a sweep, from the one nearest the start outwards.

    Parameters
    ----------
    machine
        The system.
    drives
        What is driven, in the order of the machine's drives.
    together
        Whether the drives move at once, through values of the same number, instead of through
        all combinations.
    progress
        Called with the part that is done.
    memory
        Places that are known.
    """
    return _Explorer(machine, drives, together, progress, memory or Memory()).go()


class _Explorer:
    """Reaches the places of a grid from each other, nearest to the start first."""

    def __init__(
        self,
        machine: Mechanism,
        drives: Sequence[PathDrive],
        together: bool,
        progress: Progress,
        memory: Memory,
    ) -> None:
        self.machine, self.equations, self.progress = machine, machine.equations, progress
        self.together, self.memory = together, memory
        self.drives = drives
        self.shape = (len(drives[0].values),) if together else tuple(len(d.values) for d in drives)
        self.found = Sweep()
        self.solved: dict[tuple[int, ...], Array] = {}
        self.headings: dict[tuple[int, ...], tuple[Array, Array]] = {}
        self.failed: dict[tuple[int, ...], Finding] = {}
        self.seen: dict[tuple[int, ...], _Seen] = {}

    def go(self) -> Sweep:
        """Return what was reached; an interrupt leaves it as it is."""
        try:
            self._explore()
        except KeyboardInterrupt:
            self.found.is_interrupted = True
        samples = [self._sample(index) for index in sorted(self.solved)]
        self.found.samples = samples
        lost = [finding for index, finding in self.failed.items() if index not in self.solved]
        self.found.failures = list({f.words: f for f in lost}.values())
        order = [s.drives for s in self.found.singular]
        self.found.singular = [
            f for k, f in enumerate(self.found.singular) if not _told_before(f, order[:k])
        ]
        return self.found

    def _explore(self) -> None:
        p = self.machine.positions
        start = p.start[list(self.machine.moving)]
        first = [float(p.values(p.start)[k]) for k in self.machine.drives]
        nearest = self._nearest(first)
        if not self._reach(nearest, start, first, None):
            return
        waiting = deque([nearest])
        total = int(np.prod(self.shape))
        while waiting:
            index = waiting.popleft()
            self.progress("sweeping", len(self.solved) / total)
            for other in self._neighbours(index):
                if other in self.solved:
                    continue
                if self._reach(other, self.solved[index], self._values(index), index):
                    waiting.append(other)

    def _values(self, index: tuple[int, ...]) -> list[float]:
        if self.together:
            return [d.values[index[0]] for d in self.drives]
        return [d.values[k] for d, k in zip(self.drives, index, strict=True)]

    def _nearest(self, first: Sequence[float]) -> tuple[int, ...]:
        spans = [float(np.ptp(d.values)) or 1.0 for d in self.drives]

        def distance(index: tuple[int, ...]) -> float:
            pairs = zip(self._values(index), first, spans, strict=True)
            return float(sum(((value - here) / span) ** 2 for value, here, span in pairs))

        return min(product(*map(range, self.shape)), key=distance)

    def _neighbours(self, index: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
        for axis, size in enumerate(self.shape):
            for step in (-1, 1):
                if 0 <= index[axis] + step < size:
                    yield (*index[:axis], index[axis] + step, *index[axis + 1 :])

    def _reach(
        self,
        index: tuple[int, ...],
        here: Array,
        before: Sequence[float],
        origin: tuple[int, ...] | None,
    ) -> bool:
        """Go from one place to another; note what is met on the way."""
        first, last = self.machine.targets(before), self.machine.targets(self._values(index))
        given = here, first, last, self._heading(origin, last - first)
        way, seen = self.memory.recall("way", given, partial(self._followed, *given))
        for place in way.passed:
            finding = self._finding(place, first, last)
            self.found.singular.append(finding)
        if seen is None:
            self.failed.setdefault(index, self._failure(index, way, first, last))
            return False
        self.solved[index], self.seen[index] = way.unknowns, seen
        if way.heading is not None:
            self.headings[index] = last - first, way.heading
        return True

    def _followed(
        self, here: Array, first: Array, last: Array, heading: Array | None
    ) -> tuple[PathOutcome, _Seen | None]:
        """Return the way to a place and what is seen there, None if it is not reached."""
        way = follow(self.equations, here, first, last, heading)
        return way, None if way.reached < 1.0 else self._seen(way.unknowns)

    def _heading(self, origin: tuple[int, ...] | None, move: Array) -> Array | None:
        """Return where the unknowns were going when they came to a place, for a move like that."""
        if origin not in self.headings:
            return None
        before, heading = self.headings[origin]
        share = float(before @ move) / float(before @ before)
        return heading * share if np.allclose(share * before, move) else None

    def _at(self, part: float, first: Array, last: Array) -> tuple[float, ...]:
        return tuple(map(float, (first + part * (last - first))[self.machine.gaps :]))

    def _finding(self, place: SingularPlace, first: Array, last: Array) -> Finding:
        values = self._at(place.part, first, last)
        names = tuple(self.machine.freest(place.direction))
        at = self._place(values)
        words = f"singular at {at}: the drives do not determine {_listed(names)} there"
        return Finding(values, names, words)

    def _failure(
        self, index: tuple[int, ...], way: PathOutcome, first: Array, last: Array
    ) -> Finding:
        values = self._at(way.reached, first, last)
        goal = self._place(self._values(index))
        names: tuple[str, ...] = ()
        reason = "no step however small finds a solution"
        if way.dead_end is not None:
            names = tuple(self.machine.freest(way.dead_end.direction))
            reason = f"dead centre of {_listed(names)}"
        words = f"the loops close up to {self._place(values)} on the way to {goal}: {reason}"
        return Finding(values, names, words)

    def _place(self, values: Sequence[float]) -> str:
        channels = [self.machine.positions.channels[k] for k in self.machine.drives]
        return ", ".join(
            f"{c.name} = {_shown(v, c.unit)}" for c, v in zip(channels, values, strict=True)
        )

    def _sample(self, index: tuple[int, ...]) -> PathSample:
        values, ratios = self.seen[index]
        if ratios is None:
            self._note_singular(self.solved[index])
            width = len(values) + len(self.machine.positions.speeds)
            ratios = np.full((len(self.machine.drives), width), np.nan)
        return PathSample(index, self.machine.full(self.solved[index]), values, ratios)

    def _seen(self, u: Array) -> _Seen:
        """Return all channels at a place, and the velocity ratios, None where it is singular."""
        m, p = self.machine, self.machine.positions
        q = m.full(u)
        moves = np.eye(m.gaps + len(m.drives))[:, m.gaps :]
        motion = tangents(self.equations, u, moves)
        if motion is None:
            return p.values(q), None
        slopes = np.vstack([p.slopes(q), p.speed_slopes(q)])[:, list(m.moving)]
        return p.values(q), (slopes @ motion).T

    def _note_singular(self, u: Array) -> None:
        direction = singular_direction(self.equations, u)
        if direction is not None:
            targets = self.equations.rows(u)
            place = SingularPlace(0.0, u, direction)
            self.found.singular.append(self._finding(place, targets, targets))


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)


def _told_before(finding: Finding, others: Sequence[tuple[float, ...]]) -> bool:
    return any(np.allclose(finding.drives, o, rtol=1e-9, atol=1e-9) for o in others)


def _shown(value: float, unit: str) -> str:
    """Return a place in millimetres or degrees, to seven digits."""
    factor, name = {"m": (1e3, "mm"), "rad": (180.0 / np.pi, "deg")}.get(unit, (1.0, unit))
    return f"{value * factor:.7g} {name}".rstrip() if np.isfinite(value) else shown(value, unit)
