"""A motion under way with its tangents, step by step and through events, in stretches."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.corner_steps import CornerSteps, StepParts
from vehicledyn.analyse.gradients.event_tangents import EventTangents
from vehicledyn.analyse.gradients.motion_slopes import CornerPassed, EventSlope, SlopeRecorder
from vehicledyn.analyse.gradients.motion_stretches import PartitionPiece, Stretch, Where
from vehicledyn.analyse.gradients.step_failures import raise_failure, refuse_divergence
from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.accuracy.divergence import state_limits
from vehicledyn.integrate.events import ConsistentPoint, EventMonitor
from vehicledyn.kernel.bundle import Bundle, BundleResult
from vehicledyn.kernel.engine import Ledger, March, Method, Status, Vector
from vehicledyn.kernel.tangent_code import MotionPoint, StepRow, StepSpan

Matrix = NDArray[np.float64]


_AT_STEP = 1e-6
"""Part of a step that a change of the dependent coordinates may lie beside it."""
_AT_ONCE, _MOST_NUMBERS = 512, 4_000_000
"""Intervals that are followed at once where nothing happens in them, and tangents of these."""
_MOST_CORNERS = 16
"""Corners of laws that a step with events is divided at, at most."""
_SHORTEST, _REACH = 1e-9, 1.25
"""Parts of a step behind an event of a method of order one, as in a run without derivatives."""


class TangentCourse:
    """A motion under way: the run itself, and a bundle of tangents that follows it.

    With events the last direction of the bundle is the length of the step under way.
    """

    def __init__(
        self,
        piece: PartitionPiece,
        grid: StepRow,
        start: tuple[Vector, Vector],
        directions: tuple[Matrix, Matrix],
        n_channels: int,
    ) -> None:
        by_parameter, by_state = directions
        self.grid, self.n, self._by_parameter = grid, by_state.shape[1], by_parameter
        self.events: list[EventSlope] = []
        self.corners: list[CornerPassed] = []
        self.left_whole = False
        self.record = SlopeRecorder(n_channels, self.n)
        numbers = max(1, by_state.size)
        self.at_once = max(1, min(_AT_ONCE, _MOST_NUMBERS // numbers))
        self._names: list[str] = []
        self._later: list[tuple[int, PartitionPiece]] = []
        extra = int(bool(piece.kernel.equations.events))
        self._extra = np.zeros(self.n + extra)
        self._first = np.pad(by_state, ((0, 0), (0, extra)))
        self._begin(piece, 0, start, self._first)
        if self.watch.ended_by:
            raise NumericalError(f"event '{self.watch.ended_by}' ends the motion at its start")

    def _begin(
        self, piece: PartitionPiece, step: int, start: tuple[Vector, Vector], tangents: Matrix
    ) -> None:
        """Go on with the equations of a piece from a step, with the tangents of its states."""
        self.kernel, self.code, grid = piece.kernel, piece.code, self.grid
        self.constants = self.code.constants(self.kernel.parameters)
        moved = np.asarray(self.code.constant_slopes(self.kernel.parameters) @ self._by_parameter)
        extra = len(self._extra) - self.n
        self.bundle = Bundle(self.code, np.pad(moved, ((0, 0), (0, extra))), n_idle=extra)
        self.bundle.state = tangents
        given = self.kernel, self.code, self.bundle, self._by_parameter
        self.corner_steps = CornerSteps(*given)
        state, guess = start
        self._limits = state_limits(state)
        time = grid.start + grid.interval * step / grid.per_interval
        unknowns = self.code.solved(time, state, guess, self.constants)
        point = ConsistentPoint(time, state, unknowns)
        self.watch = EventMonitor(self.kernel, point, Ledger(), self._happened)
        sides = self.watch.sides
        self.march = March(
            grid.method, grid.start, grid.interval, grid.per_interval, state, unknowns, sides=sides
        )
        self.march.step = step

    def passes(self, piece: PartitionPiece, step: int, start: tuple[Vector, Vector]) -> bool:
        """Return whether a step from some point, with the first tangents, is one with corners."""
        self._begin(piece, step, start, self._first)
        self.corner_steps.watch.look(self.march, 1)
        return self._over_corners()

    def expect(self, later: Sequence[PartitionPiece]) -> None:
        """Take notice of changes of the dependent coordinates.

        Raises
        ------
        NumericalError
            If one does not lie at a step.
        """
        for piece in later:
            place = (piece.time - self.grid.start) / self.grid.interval * self.grid.per_interval
            if abs(place - round(place)) > _AT_STEP:
                raise NumericalError(
                    f"the dependent coordinates change within a step, at t = {piece.time:.9g} s, "
                    "which derivatives do not follow; take a smaller step or another start"
                )
            self._later.append((round(place), piece))

    def place(self, count: int) -> tuple[Any, ...]:
        """Return what so many intervals from here on depend on beside the motion itself."""
        return self._where(), count, len(self._later)

    def _where(self) -> Where:
        march = self.march
        return Where(
            march.step,
            march.state.copy(),
            march.unknowns.copy(),
            march.memory.copy(),
            march.sides.copy(),
            self.watch.memory,
            self.bundle.state.copy(),
            self.corner_steps.watch.memory,
            self.watch.ended_by,
        )

    def stretch(self, count: int) -> Stretch:
        """Return the samples of the next intervals, and where they end."""
        record = self.record = SlopeRecorder(self.record.n_channels, self.n)
        before = len(self.events), len(self.corners)
        if self.march.step == 0:
            self.sample()
        self.intervals(count)
        events, corners = tuple(self.events[before[0] :]), tuple(self.corners[before[1] :])
        del self.events[before[0] :], self.corners[before[1] :]
        return Stretch(
            np.concatenate(record.times),
            np.concatenate(record.values),
            np.concatenate(record.slopes),
            tuple(record.looks),
            events,
            corners,
            self._where(),
            len(self._later),
            self.left_whole,
        )

    def resume_after(self, stretch: Stretch) -> None:
        """Stand where a stretch has ended."""
        where = stretch.end
        while len(self._later) > stretch.n_later:
            _, piece = self._later.pop(0)
            self._begin(piece, where.step, (where.state, where.unknowns), where.tangents)
        self.events += stretch.events
        self.corners += stretch.corners
        self.left_whole |= stretch.left_whole
        self.march.step, self.bundle.state = where.step, where.tangents
        pairs = (
            (self.march.state, where.state),
            (self.march.unknowns, where.unknowns),
            (self.march.memory, where.memory),
            (self.march.sides, where.sides),
        )
        for own, known in pairs:
            own[:] = known
        self.watch.recall(where.crossed)
        self.corner_steps.watch.recall(where.corners)
        self.watch.ended_by = where.ended_by

    def _change(self, piece: PartitionPiece) -> None:
        """Go on with other dependent coordinates: the same motion, with other states."""
        point = ConsistentPoint(self.time, self.march.state, self.march.unknowns)
        found, e = self._found(point, None), self.kernel.equations
        values, slopes = found.values[0], found.value_slopes[0]
        channels = [e.channels[k].name for k in self.code.channels]
        known = dict(zip(channels, zip(values, slopes, strict=False), strict=False))
        for items, numbers, rows in (
            (e.states, point.state, self.bundle.state),
            (e.unknowns, point.unknowns, found.unknown_slopes[0]),
        ):
            names = [item.name for item in items]
            known |= dict(zip(names, zip(numbers, rows, strict=True), strict=True))
        new = piece.kernel.equations
        state = np.array([known[item.name][0] for item in new.states])
        guess = np.array([known[u.name][0] if u.name in known else u.start for u in new.unknowns])
        tangents = np.array([known[item.name][1] for item in new.states])
        self._begin(piece, self.march.step, (state, guess), tangents)

    def _happened(self, name: str, _: float) -> None:
        self._names.append(name)

    @property
    def time(self) -> float:
        """Time of the step that is due [s]."""
        return self.march.time(self.march.step)

    def sample(self, moved: Vector | None = None) -> None:
        """Record the channels at the point reached; ``moved`` are the tangents of its time."""
        point = ConsistentPoint(self.time, self.march.state, self.march.unknowns)
        self.record.looks.append(
            (np.array([point.time]), point.state[None].copy(), point.unknowns[None].copy())
        )
        self._record(point, moved)

    def _record(self, point: ConsistentPoint, moved: Vector | None) -> None:
        found = self._found(point, moved)
        self.record.take(np.array([point.time]), found.values, found.value_slopes)

    def _found(self, point: ConsistentPoint, moved: Vector | None) -> BundleResult:
        return self.bundle.here(MotionPoint(*point, self.constants), moved)

    def intervals(self, count: int) -> None:
        """Go on by so many samples, or to the event that ends the motion."""
        due = count * self.grid.per_interval
        while due:
            if self._later and self._later[0][0] <= self.march.step:
                self._change(self._later.pop(0)[1])
            ahead = self._later[0][0] - self.march.step if self._later else due
            corners = self.corner_steps.watch
            status, taken = self._march(corners.most(self.march, min(due, ahead)))
            due -= taken
            if status is Status.CORNER:
                divided = self._over_corners()
                status, taken = (Status.SOLVED, 1) if divided else self._march(1, watched=False)
                due -= taken
                if status is Status.SOLVED:
                    corners.passed(self._here(), self.march.step)
            self.left_whole |= corners.left_whole
            if status is Status.EVENT:
                self._step_with_events()
                if self.watch.ended_by:
                    return
                due -= 1
                corners.enter(self._here())
                if self.march.step % self.grid.per_interval == 0:
                    self.sample()

    def _march(self, n_steps: int, *, watched: bool = True) -> tuple[Status, int]:
        """Take whole steps; return how that ended, and how many were taken.

        If ``watched``, up to one in which a law changes its branch.
        """
        way = StepSpan(self.march.step, n_steps)
        before = self.march.state.copy(), self.march.unknowns.copy()
        moment = MotionPoint(self.time, self.march.state, self.march.unknowns, self.constants)
        corners = self.corner_steps.watch.structure if watched else None
        given = self.grid, way, moment, self.march.sides, corners
        status, taken, samples = self.bundle.march(*given)
        if status not in (Status.SOLVED, Status.EVENT, Status.CORNER):
            march = replace(self.march, state=before[0], unknowns=before[1])
            raise_failure(self.kernel, self.code, march, way.n_steps, status)
        self.march.step += taken
        if len(samples.times):
            reached = self.kernel.equations, *samples[:2], self._limits, self.grid
            refuse_divergence(*reached)
            self.record.looks.append(samples[:3])
            found = self.bundle.found(samples, self.constants)
            self.record.take(samples.times, found.values, found.value_slopes)
        return status, taken

    def _over_corners(self) -> bool:
        """Take the step that is due, divided at corners of laws, if it has any that is felt."""
        corners, begin, tangents = self.corner_steps, self._here(), self.bundle.state
        still = self._extra, self._extra
        parts = StepParts(self._trials, lambda span: self._part(span, still), self._enter)
        whole = corners.whole(self.march)
        end = whole and corners.divided(self.march.step, parts, (begin, whole))
        if whole is None or end is None or self.watch.fires(end):
            self._enter(begin)
            self.bundle.state = tangents
            return False
        missed = corners.missed(end, whole)
        self.corners.append(CornerPassed(begin.time, missed, corners.jumped))
        self._enter(end)
        self.march.step += 1
        self.march.memory[:] = 0.0
        if self.march.step % self.grid.per_interval == 0:
            self.sample()
        return True

    def _here(self, fraction: float = 0.0) -> ConsistentPoint:
        """Return the point reached, at a fraction of the step that is due."""
        time = self._time_at(fraction) if fraction else self.time
        return ConsistentPoint(time, self.march.state.copy(), self.march.unknowns.copy())

    def _enter(self, point: ConsistentPoint) -> None:
        self.march.state[:], self.march.unknowns[:] = point.state, point.unknowns

    def _step_with_events(self) -> None:
        """Take the step that is due in parts, as a run without derivatives does."""
        step = self.grid.interval / self.grid.per_interval
        fraction, reach, moved = 0.0, 1.0, self._extra.copy()
        n_corners = len(self.corners) + _MOST_CORNERS
        euler = self.grid.method == Method.SYMPLECTIC_EULER
        while fraction < 1.0 and not self.watch.ended_by:
            begin, end = fraction, min(fraction + reach, 1.0)
            trial, self._names = self._trials(begin), []
            point = trial(end)
            ends, corner = (self._here(begin), point), None
            if len(self.corners) < n_corners:
                corner = self.corner_steps.behind(trial, (begin, end), ends)
            if corner is not None and corner < end and not self.watch.fires(trial(corner)):
                end, point = corner, trial(corner)
            if self.watch.fires(point):
                fraction, point = self.watch.cross(trial, begin, end, step)
                before = trial(fraction)
                moved = self._cross(before, begin, fraction, moved)
                reach = _SHORTEST / step if euler else 1.0
            else:
                later = self._extra if end == 1.0 else moved
                point = self._between((begin, end), (moved, later), point, corner is not None)
                fraction, reach = end, _REACH * reach
                moved = later
            self.march.state[:], self.march.unknowns[:] = point.state, point.unknowns
        self.march.memory[:] = 0.0
        self.march.step += 1
        if self.watch.ended_by:
            self._record(point, moved)

    def _trials(self, begin: float) -> Callable[[float], ConsistentPoint]:
        part, here = replace(self.march), self._here()

        def trial(end: float) -> ConsistentPoint:
            part.state[:], part.unknowns[:] = here.state, here.unknowns
            status = self.kernel.advance_part(part, (begin, end))
            if status is not Status.SOLVED:
                moment = self.march.time(self.march.step, begin)
                raise NumericalError(self.kernel.failure(status, moment, part.ledger))
            return ConsistentPoint(self._time_at(end), part.state.copy(), part.unknowns.copy())

        return trial

    def _time_at(self, fraction: float) -> float:
        step = self.march.step
        return self.march.time(step, fraction) if fraction < 1.0 else self.march.time(step + 1)

    def _part(self, span: tuple[float, float], times: tuple[Vector, Vector]) -> ConsistentPoint:
        """Take the tangents through a part of the step that is due; return where it ends."""
        state, unknowns = self.march.state.copy(), self.march.unknowns.copy()
        moment = MotionPoint(self.time, state, unknowns, self.constants)
        self.bundle.part(self.grid, StepSpan(self.march.step, 1, span), moment, times)
        return ConsistentPoint(self._time_at(span[1]), state, unknowns)

    def _between(
        self,
        span: tuple[float, float],
        times: tuple[Vector, Vector],
        end: ConsistentPoint,
        has_corner: bool,
    ) -> ConsistentPoint:
        """Take tangents through a part without events; return its end, ``end`` if it is whole.

        It is divided at corners of laws, which do not move with the times at its ends.
        """
        corners, begin, tangents = self.corner_steps, self._here(span[0]), self.bundle.state
        if has_corner:

            def part(inner: tuple[float, float]) -> ConsistentPoint:
                first = times[0] if inner[0] == span[0] else self._extra
                return self._part(inner, (first, times[1] if inner[1] == span[1] else self._extra))

            parts = StepParts(self._trials, part, self._enter)
            found = corners.divided(self.march.step, parts, (begin, end), span)
            self._enter(begin)
            if found is not None:
                passed = CornerPassed(self.time, corners.missed(found, end), corners.jumped)
                self.corners.append(passed)
                return found
            self.bundle.state = tangents
        self._part(span, times)
        return end

    def _cross(
        self,
        before: ConsistentPoint,
        begin: float,
        end: float,
        moved: Vector,
    ) -> Vector:
        """Carry the tangents through the events at a point; return those of its time."""
        earlier = self.kernel.event_values(
            self.march.time(self.march.step, begin), self.march.state, self.march.unknowns
        )
        ahead = self._extra.copy()
        ahead[-1] = 1.0
        self._part((begin, end), (moved, ahead))
        slopes = self._found(before, ahead).value_slopes[0][len(self.code.channels) :]
        passed = EventTangents(self.kernel.equations, self._names, slopes, before.time)
        seconds = before.time - self.march.time(self.march.step, begin)
        moment = passed.moment(float(earlier[passed.place]), seconds)
        slope = moment[:-1]
        self.events += [EventSlope(name, before.time, slope.copy()) for name in self._names]
        self.bundle.state = passed.behind(self.bundle.state, moment)
        return moment
