"""Which steps of a motion are taken apart since a law changes its branch in them.

Laws that change their branch all the time, such as those of contacts that chatter or of wheels that
roll over the points of a profile, are passed over: their corners are all over the motion.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.integrate.events import ConsistentPoint
from vehicledyn.kernel.branch_watch import NOISE, BranchWatch
from vehicledyn.kernel.bundle import Bundle
from vehicledyn.kernel.engine import March, Method, Vector
from vehicledyn.kernel.tangent_code import MotionPoint, StepRow, StepSpan, TangentCode

Matrix = NDArray[np.float64]

_LOOK, _WINDOW, _LEAST = 128, 4096, 1024
"""Steps that are looked through where a motion begins, after which it is judged again which laws
are passed over, and which a share of them counts at least before."""
_OFTEN, _FEW = 0.1, 16
"""Part of the steps, and their number, up to which one function may change its branch in them, and
up to which all may together."""
_MOST_WEAK = 2
"""How often a function may change its branch without being felt until it is passed over."""


def has_corners(code: TangentCode, grid: StepRow) -> bool:
    """Return whether steps of a model are divided where they pass corners of its laws."""
    return grid.method == Method.RK4 and code.branches.count > 0


class CornerWatch:
    """Finds the steps with corners of laws while a motion is followed.

    ``branches`` are the functions; ``weak`` says how often each changed its branch without being
    felt, ``resting`` which of them the motion begins at the corner of; ``sizes`` are the largest
    states.

    Parameters
    ----------
    code
        The compiled derivatives.
    parameters
        Those of the model.
    plain
        Carries no directions.
    """

    def __init__(self, code: TangentCode, parameters: Vector, plain: Bundle) -> None:
        self.branches = BranchWatch(code, parameters)
        count = self.branches.count
        self.weak, self._chatters = np.zeros((2, count))
        self.resting = np.zeros(count, dtype=bool)
        self.sizes = np.ones(len(code.equations.states))
        self._window = np.array([-1.0, -1.0, 0.0])
        self._leaves_whole = self._left_whole = False
        self._plain, self._constants = plain, code.constants(parameters)

    @property
    def _known(self) -> tuple[NDArray[Any], ...]:
        b = self.branches
        own = (self.weak, self._chatters, self.resting, self.sizes, self._window)
        return (*own, b.marks, b.changes, b.sizes, b.before)

    @property
    def memory(self) -> Vector:
        """What is known of the functions at the point reached."""
        return np.concatenate([item.astype(float) for item in self._known])

    def recall(self, memory: Vector) -> None:
        """Set what :attr:`memory` returned, where it is of the same equations."""
        known = self._known
        ends = np.cumsum([len(item) for item in known])
        if len(memory) == ends[-1]:
            for item, part in zip(known, np.split(memory, ends[:-1]), strict=True):
                item[:] = part.astype(item.dtype)
            self._skip()

    @property
    def structure(self) -> Any:
        """What compiled steps watch, None where that is nothing."""
        return self.branches.structure if self._window[1] >= 0.0 else None

    @property
    def felt(self) -> NDArray[np.bool_]:
        """Which functions are not passed over since they were not felt."""
        return self.weak < _MOST_WEAK

    @property
    def left_whole(self) -> bool:
        """Whether steps were left whole though a law changes its branch in them."""
        changed_whole = self._leaves_whole and bool(self.branches.changes.any())
        return changed_whole or self._left_whole

    def most(self, march: March, due: int) -> int:
        """Return how many of the steps that are due may be taken before this is asked again."""
        if not self.branches.count:
            return due
        begin, end, n_changing = self._window
        if not self._leaves_whole and march.method != Method.RK4:
            self._leaves_whole = True
            self._skip()
        if march.step >= end:
            changes, self._left_whole = self.branches.changes, self.left_whole
            if end < 0.0:
                self.look(march, min(due, _LOOK))
            else:
                most = max(int(n_changing), int(changes.max()))
                self._chatters[:] = self._often(changes, march.step - int(begin), most)
            changes[:] = 0
            self._window[:] = march.step, march.step + _WINDOW, 0.0
            self._skip()
        return min(due, int(self._window[1]) - march.step)

    def enter(self, point: ConsistentPoint) -> None:
        """Go on from a point that no step of the motion led to, such as that behind an event."""
        if self.structure is not None:
            self.branches.enter(self.values(point), counted=False)

    def passed(self, point: ConsistentPoint, step: int) -> None:
        """Go on from the end of a step in which a function has changed its branch."""
        self.branches.enter(self.values(point), counted=True)
        np.fmax(self.sizes, np.abs(point.state), out=self.sizes)
        self._window[2] += 1.0
        n_steps = max(step - int(self._window[0]), _LEAST)
        often = self._often(self.branches.changes, n_steps, int(self._window[2]))
        self._chatters[often] = 1.0
        self._skip()

    def values(self, point: ConsistentPoint) -> Vector:
        """Return the functions at a point, shape (count,)."""
        found = self.branches.values(
            np.array([point.time]), point.state[None], point.unknowns[None]
        )
        return np.asarray(found[0])

    def look(self, march: March, count: int) -> None:
        """Learn from the next steps, taken as a whole, which functions chatter in them.

        Where the motion begins at a corner up to rounding, it does not pass it.
        """
        watch = self.branches
        times, states, unknowns = self._ahead(march, count)
        values = watch.values(times, states, unknowns)
        marks = watch.branches(values)
        with np.errstate(invalid="ignore"):
            watch.sizes[:] = np.fmax.reduce(np.abs(values), axis=0)
            moved = np.abs(np.diff(values, axis=0)) > NOISE * watch.sizes
            rests = (np.abs(values[0]) <= NOISE * watch.sizes) & ~watch.is_table
        if march.step == 0:
            self.resting[:], marks[0, rests] = rests, 0.0
        watch.marks[:], watch.before[:] = marks[0], values[0]
        sizes = np.abs(states).max(axis=0)
        self.sizes[:] = np.where(sizes > 0.0, sizes, 1.0)
        rows = np.arange(len(marks))[:, None]
        known = np.where(marks != 0.0, rows, len(marks) - 1)
        behind = np.minimum.accumulate(known[::-1], axis=0)[::-1]
        marks = np.take_along_axis(marks, behind, axis=0)
        changed = (np.diff(marks, axis=0) != 0.0) & moved
        self._chatters[:] = self._often(
            changed.sum(axis=0), len(changed), changed.any(axis=1).sum()
        )

    def _often(self, changes: NDArray[Any], n_steps: int, n_changing: int) -> NDArray[np.bool_]:
        """Return which functions change too often in so many steps to be followed.

        ``changes`` is how often each did, ``n_changing`` in how many of the steps one did.
        """
        own = changes > max(_FEW, _OFTEN * n_steps)
        rest = np.where(own | ~self.felt, 0, changes)
        together = n_changing > _FEW and rest.sum() > _OFTEN * n_steps
        return np.asarray(own | together)

    def _skip(self) -> None:
        chatters = self._chatters > 0.0
        self.branches.skipped[:] = chatters | ~self.felt | self._leaves_whole
        self._left_whole |= bool(chatters.any())

    def _ahead(self, march: March, count: int) -> tuple[Vector, Matrix, Matrix]:
        """Return times, states and unknowns of the next steps, as they are taken as a whole."""
        time, step = march.time(march.step), march.interval / march.per_interval
        begin = MotionPoint(time, march.state.copy(), march.unknowns.copy(), self._constants)
        found = self._plain.march(
            StepRow(march.method, time, step, 1), StepSpan(0, count), begin, march.sides.copy()
        )[2]
        states = np.concatenate([march.state[None], found.states])
        unknowns = np.concatenate([march.unknowns[None], found.unknowns])
        return np.asarray(time + step * np.arange(len(states)), dtype=float), states, unknowns
