"""Plans of the derivatives at a point: the rows that lead from some directions to some results.

The derivatives by time and states serve all directions and are planned once; those by constants
are planned for the directions that are wanted. A direction that few constants move takes a few
rows only.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.codegen.passes.linear_program import LinearProgram
from vehicledyn.codegen.passes.stage_program import NO_STEPS, StageSolution

Ints = NDArray[np.int32]
_L, _P = ctypes.c_longlong, ctypes.c_void_p

ABREAST, FEW = 8, 4
"""Directions of a plan, and of one for what is left, as passes.c has them."""

_AT_ONCE = 64
"""Directions that are weighed at once."""

Call = Callable[..., int]


class _Program(ctypes.Structure):
    _fields_ = [
        *[(name, _L) for name in ("n_rows", "n_columns", "n_targets")],
        *[(name, _P) for name in ("out", "starts", "columns", "which", "targets")],
    ]


class _Pass(ctypes.Structure):
    _fields_ = [("plan", _P), ("seeds", _P), ("first", _L), ("width", ctypes.c_int)]


class PlannedSlopes(ctypes.Structure):
    """What C knows of the derivatives of some results at several points."""

    _fields_ = [
        ("by_state", ctypes.c_int),
        *[(name, _L) for name in ("n_targets", "n_passes", "n_moved", "n_steps")],
        ("passes", _P),
        *[(name, _P) for name in ("starts", "values", "sources")],
        *[(f"moved_{name}", _P) for name in ("values", "targets", "directions")],
        *[(f"step_{name}", _P) for name in ("out", "scales", "starts", "columns", "which")],
        *[(name, _P) for name in ("slots", "results")],
    ]


class BackPass(ctypes.Structure):
    """What C knows of a plan that goes back."""

    _fields_ = [("plan", _P), ("n_results", _L), *[(n, _P) for n in ("slots", "results", "sums")]]


@dataclass(frozen=True)
class Plan:
    """A plan as C reads it, the place of each target's results, -1 for none, and its directions."""

    numbers: Ints
    number: Ints
    directions: NDArray[np.uint8]

    @property
    def n_slots(self) -> int:
        """Places for values that rows hand on."""
        return int(self.numbers[1])

    @property
    def n_results(self) -> int:
        """Targets that the plan leads to."""
        return int(np.sum(self.number >= 0))


@dataclass(frozen=True)
class Passes:
    """Plans with seeds of their sources (n_sources, n_directions).

    ``entries`` (n, 3): target, direction and place among the results of all passes, of which
    ``n_before`` come from elsewhere.
    """

    plans: list[Plan]
    seeds: list[NDArray[np.float64]]
    entries: NDArray[np.int64]
    n_before: int = 0


def plan(call: Call, program: LinearProgram, bits: NDArray[np.uint8]) -> Plan:
    """Return the plan from sources of a program that some directions move, as bits (n_sources,)."""
    given, sizes = _Given(program), (len(program.out), len(program.columns))
    every = np.zeros(program.n_columns, np.uint8)
    every[: len(bits)] = bits
    room = np.empty(2 + 4 * sizes[0] + 2 * sizes[1], np.int32)
    n_targets = len(program.targets)
    number, found = np.empty(n_targets + 1, np.int32), np.empty(n_targets + 1, np.uint8)
    length = call("vd_plan", given.address, every, room, number, found)
    if not length:
        raise MemoryError
    return Plan(room[:length].copy(), number[:-1], found[:-1])


class _Given:
    """A program as C reads it."""

    def __init__(self, program: LinearProgram) -> None:
        p = program
        self._arrays = [
            np.ascontiguousarray(item, dtype=np.int32)
            for item in (p.out, p.starts, p.columns, p.which, p.targets)
        ]
        sizes = len(p.out), p.n_columns, len(p.targets)
        self._program = _Program(*sizes, *[item.ctypes.data for item in self._arrays])
        self.address = ctypes.addressof(self._program)


def passes(call: Call, program: LinearProgram, seeds: NDArray[np.float64]) -> Passes:
    """Return the passes ahead for directions that move sources, seeds (n_sources, n_directions).

    Those that lead to about as many rows go together.
    """
    plans, own_seeds, entries, first = [], [], [np.zeros((0, 3), dtype=np.int64)], 0
    for group in _groups(call, program, seeds):
        width = FEW if len(group) <= FEW else ABREAST
        own = np.zeros((len(seeds), width))
        own[:, : len(group)] = seeds[:, group]
        bits = (own != 0.0) @ (1 << np.arange(width))
        made = plan(call, program, bits.astype(np.uint8))
        reached = made.directions[:, None] >> np.arange(len(group), dtype=np.uint8) & 1
        targets, which = np.nonzero(reached.astype(bool) & (made.number >= 0)[:, None])
        places = first + width * made.number[targets] + which
        entries.append(np.stack([targets, group[which], places], axis=1))
        plans.append(made)
        own_seeds.append(own)
        first += width * made.n_results
    return Passes(plans, own_seeds, np.concatenate(entries))


def _groups(
    call: Call, program: LinearProgram, seeds: NDArray[np.float64]
) -> list[NDArray[np.intp]]:
    """Return the directions that go together, those that move nothing left out."""
    given, moved, counts = _Given(program), seeds != 0.0, []
    for first in range(0, seeds.shape[1], _AT_ONCE):
        own = moved[:, first : first + _AT_ONCE]
        bits, found = np.zeros(program.n_columns, np.uint64), np.zeros(_AT_ONCE, np.int64)
        bits[: len(seeds)] = own @ (np.uint64(1) << np.arange(own.shape[1], dtype=np.uint64))
        call("vd_weigh_directions", given.address, bits, found)
        counts += found[: own.shape[1]].tolist()
    active = np.flatnonzero(moved.any(axis=0))
    order = active[np.argsort(-np.array(counts, dtype=np.int64)[active], kind="stable")]
    return [order[k : k + ABREAST] for k in range(0, len(order), ABREAST)]


@dataclass
class SlopeMap:
    """The derivatives of a program's results, as C reads them; keeps all that it reads."""

    slopes: PlannedSlopes
    n_targets: int
    _kept: list[Any] = field(default_factory=list)

    @staticmethod
    def of(
        n_targets: int,
        known: Passes,
        moved: Passes,
        lanes: int,
        solution: StageSolution = NO_STEPS,
    ) -> SlopeMap:
        """Return the map of passes by time, states and first results, and of passes by constants.

        The steps of ``solution`` on the results follow.
        """
        kept: list[Any] = []

        def address(array: NDArray[Any]) -> int:
            kept.append(array)
            return int(array.ctypes.data)

        whole = [
            (p, s) for own in (known, moved) for p, s in zip(own.plans, own.seeds, strict=True)
        ]
        firsts = np.cumsum([known.n_before, *[s.shape[1] * p.n_results for p, s in whole]])
        rows = (_Pass * max(1, len(whole)))()
        for k, (one, seeds) in enumerate(whole):
            rows[k] = _Pass(address(one.numbers), address(seeds), int(firsts[k]), seeds.shape[1])
        kept.append(rows)
        by_state = known.entries[np.lexsort(known.entries.T[1::-1])]
        starts = np.searchsorted(by_state[:, 0], np.arange(n_targets + 1))
        own = moved.entries.copy()
        own[:, 2] += firsts[len(known.plans)]
        lists: list[NDArray[Any]] = [
            starts,
            by_state[:, 2],
            by_state[:, 1],
            own[:, 2],
            own[:, 0],
            own[:, 1],
        ]
        lists += [solution.out, solution.scales, solution.starts]
        lists += [solution.columns, solution.which]
        n_slots = max([1, *[p.n_slots for p, _ in whole]])
        slopes = PlannedSlopes(
            int(known.n_before > 0),
            n_targets,
            len(whole),
            len(own),
            len(solution.out),
            ctypes.addressof(rows),
            *[address(np.ascontiguousarray(item, dtype=np.int32)) for item in lists],
            address(aligned((ABREAST * n_slots, lanes))),
            address(aligned((int(firsts[-1]) + 1, lanes))),
        )
        return SlopeMap(slopes, n_targets, kept)


@dataclass
class BackSums:
    """A plan back from some results, and what adds up at the columns that it leads to."""

    back: BackPass
    number: Ints
    sums: NDArray[np.float64]
    _kept: list[Any]

    @staticmethod
    def of(call: Call, program: LinearProgram, seeded: Sequence[int], lanes: int) -> BackSums:
        """Return the plan from the sources of a transposed program that have seeds."""
        bits = np.zeros(max([0, *seeded]) + 1, np.uint8)
        bits[list(seeded)] = 1
        made = plan(call, program, bits)
        rooms = [aligned((size + 1, lanes)) for size in (made.n_slots, *[made.n_results] * 2)]
        addresses = [item.ctypes.data for item in rooms]
        back = BackPass(made.numbers.ctypes.data, made.n_results, *addresses)
        return BackSums(back, made.number, rooms[2], [made, *rooms])

    def total(self) -> NDArray[np.float64]:
        """Return what has added up at each of the program's results."""
        found = np.append(self.sums[:-1].sum(axis=1), 0.0)
        return np.asarray(found[self.number])


def aligned(shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return zeros that begin at a multiple of 64 bytes."""
    size = int(np.prod(shape))
    raw = np.zeros(size + 8)
    first = -(raw.ctypes.data // 8) % 8
    return raw[first : first + size].reshape(shape)
