"""Put the last steps of a function in an order in which few of them wait for others.

A processor computes ahead what does not wait, within the few hundred steps that it sees. At the end
of a function it sees nothing behind it: what others wait for longest goes first there. Elsewhere
the order of the expressions keeps fewer values in hand, which counts for more.
"""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heapify, heappop, heappush

from vehicledyn.codegen.ir.instructions import Instruction
from vehicledyn.codegen.passes.latency import latency
from vehicledyn.codegen.passes.scheduling import Pack, Step, computed_by, operands_of

_STEPS = 600
"""Steps that are put in order: some more than a processor sees."""

_AT_ONCE = 2
"""Sums and products that a processor begins in the time of one."""

_TIME_OF_ONE = 4
"""Time of a sum or product, in turns of beginning some."""


def order_tail(values: list[Instruction], steps: Sequence[Step]) -> list[Step]:
    """Return the steps with the last of them ordered by how long the end waits for them.

    Short functions stay as they are: a processor sees most of one at once.
    """
    first = len(steps) - _STEPS
    if first < _STEPS:
        return list(steps)
    tail = _Tail(values, steps[first:])
    return [*steps[:first], *(steps[first + k] for k in tail.order())]


class _Tail:
    """Steps, who waits for each, and how long the end waits for it."""

    def __init__(self, values: list[Instruction], steps: Sequence[Step]) -> None:
        maker = {value: k for k, step in enumerate(steps) for value in computed_by(step)}
        self._needs = [
            {maker[value] for value in operands_of(values, step) if value in maker}
            for step in steps
        ]
        self._users: list[list[int]] = [[] for _ in steps]
        for k, needs in enumerate(self._needs):
            for step in needs:
                self._users[step].append(k)
        self._time = [_TIME_OF_ONE * _latency(values, step) for step in steps]
        self._left = list(self._time)
        for k in range(len(steps) - 1, -1, -1):
            self._left[k] += max((self._left[user] for user in self._users[k]), default=0)

    def order(self) -> list[int]:
        """Return the steps in the order in which a processor could begin them."""
        missing = [len(needs) for needs in self._needs]
        there = [0] * len(missing)
        ready = [(-self._left[k], k) for k, count in enumerate(missing) if count == 0]
        heapify(ready)
        coming: list[tuple[int, int]] = []
        found: list[int] = []
        now = 0
        while ready or coming:
            if not ready:
                now = coming[0][0]
            while coming and coming[0][0] <= now:
                step = heappop(coming)[1]
                heappush(ready, (-self._left[step], step))
            for _ in range(min(_AT_ONCE, len(ready))):
                step = heappop(ready)[1]
                found.append(step)
                for user in self._users[step]:
                    there[user] = max(there[user], now + self._time[step])
                    missing[user] -= 1
                    if missing[user] == 0:
                        heappush(coming, (there[user], user))
            now += 1
        return found


def _latency(values: list[Instruction], step: Step) -> int:
    if isinstance(step, Pack):
        return latency(values[step.computed[0]].operation)
    return latency(values[step].operation if isinstance(step, int) else step.operation)
