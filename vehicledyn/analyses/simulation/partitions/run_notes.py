"""What a run that changes its dependent coordinates goes on with, in numbers and back.

A note says which equations were in use and what was known of their pivots at a sample, and holds
the note of the method. Where the equations were derived is kept once for all later notes.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.simulation.partitions.partition_changes import PartitionChanges
from vehicledyn.analyses.simulation.partitions.rederived import Origin, names_at_origin
from vehicledyn.analyses.simulation.partitions.singularity_crossing import Sample
from vehicledyn.analyses.simulation.partitions.singularity_monitor import PivotLog
from vehicledyn.integrate.course import Beginning, RunHistory, reading_history
from vehicledyn.symbolic.equations import Equations

Vector = NDArray[np.float64]

_ORIGIN, _ROWS = 0.0, 1.0
_FIRST, _MULTIPLIERS = -1, -2
"""Numbers of the equations that a run begins with, and of those with multipliers."""
_LEFT: tuple[str, ...] = ()
"""Dependent coordinates of equations with multipliers."""


@dataclass(frozen=True)
class Standing:
    """How a run of pieces stands: the look at which its piece began, and lengths of pieces.

    ``segment`` are the looks in a piece of a motion full of passages, None elsewhere; ``passed`` is
    the look behind the latest passage.
    """

    look: int
    segment: int | None
    passed: int


@dataclass(frozen=True)
class Recalled:
    """What a run goes on from.

    ``beginning`` is that of the method. With multipliers there are a ``start`` of their run [s] and
    their ``origin``, else a ``standing`` and a ``sample``.
    """

    beginning: Beginning
    standing: Standing | None = None
    sample: Sample | None = None
    start: float = 0.0
    origin: Origin | None = None


@dataclass
class RunNotes:
    """Notes of one run, which are given to ``course``."""

    changes: PartitionChanges
    log: PivotLog
    course: RunHistory
    _kept: dict[tuple[str, ...], Origin] = field(default_factory=dict, init=False)
    _rows: dict[tuple[int, ...], list[int]] = field(default_factory=dict, init=False)

    def of_piece(self, standing: Standing, beginning: Beginning | None) -> RunHistory:
        """Return what notes the history of a piece with dependent coordinates."""

        def note(time: float, numbers: Vector) -> None:
            known = self.log.known_at(time)
            if known is None:
                return
            sample, pivots = known
            changes = self.changes
            parts: list[Vector | list[float]] = [
                [self._number(), changes.changed_at, changes.count],
                [standing.look, standing.segment or 0, standing.passed, len(pivots)],
                pivots,
                *(sample.state, sample.unknowns, sample.outputs),
                numbers,
            ]
            self._note(time, parts)

        return RunHistory(note, beginning)

    def of_multipliers(
        self, start: float, origin: Origin, beginning: Beginning | None
    ) -> RunHistory:
        """Return what notes the history of a run with multipliers from a start [s] on."""

        def note(time: float, numbers: Vector) -> None:
            self._keep_origin(_LEFT, origin)
            self._note(time, [[_MULTIPLIERS, start], numbers])

        return RunHistory(note, beginning)

    def _note(self, time: float, parts: list[Vector | list[float]]) -> None:
        for best, origin in self.changes.origins.items():
            self._keep_origin(best, origin)
        if "watch" in self.changes.__dict__:
            for columns, rows in self.changes.watch.choices.items():
                if self._rows.get(columns) != rows:
                    self._rows[columns] = rows
                    self._keep([_ROWS, len(columns), *columns, *rows])
        self.course.note(time, np.concatenate(parts))

    def _keep_origin(self, best: tuple[str, ...], origin: Origin) -> None:
        if self._kept.get(best) is origin:
            return
        self._kept[best] = origin
        names = self._names
        columns = [names.index(name) for name in best]
        self._keep(
            [_ORIGIN, len(best), *columns, origin.time, float(origin.interpreted), *origin.values]
        )

    def _keep(self, row: list[float]) -> None:
        if self.course.keep is not None:
            self.course.keep(np.array([len(row), *row]))

    @property
    def _names(self) -> list[str]:
        return names_at_origin(self.changes.system, self.changes.first)

    def _number(self) -> int:
        """Return the number of the equations in use."""
        equations, known = self.changes.kernel.equations, self.changes.known
        if equations is self.changes.first:
            return _FIRST
        best = next(best for best, kernel in known.items() if kernel.equations is equations)
        return list(self.changes.origins).index(best)

    def recall(self, beginning: Beginning, history: Vector) -> Recalled:
        """Put the changes and the pivots of a run where they were noted; return what follows.

        Raises
        ------
        InputError
            If the numbers are not notes of this run.
        """
        with reading_history():
            return self._recall(beginning, history)

    def _recall(self, beginning: Beginning, history: Vector) -> Recalled:
        self._replay(np.zeros(0) if beginning.kept is None else beginning.kept)
        changes, number = self.changes, int(history[0])
        changes.choices = dict(self._rows)
        if number == _MULTIPLIERS:
            method = Beginning(beginning.time, history[2:])
            return Recalled(method, start=float(history[1]), origin=self._kept[_LEFT])
        changes.changed_at, changes.count = float(history[1]), int(history[2])
        look, segment, passed, n_pivots = map(int, history[3:7])
        if number != _FIRST:
            changes.kernel = changes.with_dependent(list(changes.origins)[number])
        e = changes.kernel.equations
        lengths = [n_pivots, len(e.states), len(e.unknowns), len(e.channels)]
        if min(lengths) < 0 or sum(lengths) > len(history) - 7:
            raise ValueError("too few numbers")
        pivots, *parts, method_numbers = np.split(history[7:], np.cumsum(lengths))
        sample = Sample(beginning.time, *(part.copy() for part in parts))
        self.log.recall(sample, pivots)
        return Recalled(
            Beginning(beginning.time, method_numbers),
            Standing(look, segment or None, passed),
            sample,
        )

    def _replay(self, kept: Vector) -> None:
        """Take what was kept."""
        names, place = self._names, 0
        while place < len(kept):
            length = int(kept[place])
            kind, count, *row = kept[place + 1 : place + 1 + length].tolist()
            columns, rest = tuple(map(int, row[: int(count)])), row[int(count) :]
            if kind == _ROWS:
                self._rows[columns] = [int(number) for number in rest]
            else:
                origin = Origin(rest[0], np.array(rest[2:]), bool(rest[1]))
                self._kept[tuple(names[k] for k in columns)] = origin
            place += 1 + length
        self.changes.origins.update({best: o for best, o in self._kept.items() if best != _LEFT})


def most_noted(equations: Equations) -> int:
    """Return how many numbers a note has beside those of a method, at most.

    Other partitions have other states and unknowns, and multipliers more of both.
    """
    structure = equations.structure
    if not (structure.get("loops") or structure.get("rate_dependent")):
        return 0
    n_points = len(equations.states) + len(equations.unknowns)
    return 16 + 16 * n_points + len(equations.channels) + len(structure.get("dependent", ()))
