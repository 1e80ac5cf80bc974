"""The derivatives of a model at a point as a sparse linear program of numbers.

A program has columns: sources whose tangents are given, then rows, each a sum of weights times
columns before it. The weights are what a generated function computes at a point; they serve any
number of directions, forward, and transposed for adjoints.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.codegen.passes.kernel_functions import as_written
from vehicledyn.codegen.passes.local_slopes import slope_graph
from vehicledyn.codegen.passes.reciprocals import use_reciprocals
from vehicledyn.codegen.passes.row_order import by_parts
from vehicledyn.codegen.passes.vertex_elimination import LinearRows, eliminated

Index = NDArray[np.int32]

INVERSE = -(2**30)
"""Place of the first weight that is found elsewhere; the others count down from it."""

_SLACK = 2
"""Edges that a node may leave behind more than it takes along, see vertex_elimination."""


@dataclass(frozen=True)
class LinearProgram:
    """Rows of a linear program.

    Row k writes column ``out[k]`` from ``columns`` and ``which`` weights ``starts[k]`` to
    ``starts[k + 1]``; ``targets`` are the columns of the results. ``fixed`` are the values of the
    last weights, which are plain numbers, the last of them one.
    """

    n_columns: int
    out: Index
    starts: Index
    columns: Index
    which: Index
    targets: Index
    fixed: NDArray[np.float64]

    def transposed(self, sources: Sequence[int], one: int) -> LinearProgram:
        """Return the program of the adjoints of some sources.

        Its own sources are the adjoints of the results; behind them columns keep their order. The
        weight ``one`` is the number one.
        """
        n, n_rows = len(self.targets), len(self.out)
        place = np.full(self.n_columns, -1)
        place[self.out[::-1]] = np.arange(n_rows)
        place[list(sources)] = n_rows + np.arange(len(sources))
        of_rows = np.repeat(self.out, np.diff(self.starts))
        users = np.concatenate([np.arange(n), n + of_rows]).astype(np.int32)
        which = np.concatenate([np.full(n, one, np.int32), self.which])
        rows = place[np.concatenate([self.targets, self.columns])]
        order = np.argsort(rows, kind="stable")
        order = order[np.searchsorted(rows[order], 0) :]
        out = np.concatenate([self.out[::-1], np.array(sources, dtype=np.int32)])
        starts = np.searchsorted(rows[order], np.arange(len(out) + 1))
        return LinearProgram(
            n + self.n_columns,
            (n + out).astype(np.int32),
            starts.astype(np.int32),
            users[order],
            which[order],
            (n + np.array(sources)).astype(np.int32),
            self.fixed,
        )

    def joined(self, first: int, count: int) -> LinearProgram:
        """Return the program in which the first results stand for sources from ``first`` on.

        A row that takes such a source must lie behind the result that stands for it.
        """
        stands = np.arange(self.n_columns, dtype=np.int32)
        stands[first : first + count] = self.targets[:count]
        return replace(self, columns=stands[self.columns])

    def with_values(self, n_kept: int, observed: LinearProgram, before: int) -> LinearProgram:
        """Return the program of the first results of this one, and of observed values behind them.

        Both have the same sources; the weights of ``observed`` lie behind ``before`` others.
        """
        n_sources = observed.n_columns - len(observed.out)
        own = self.n_columns + np.arange(len(observed.out))
        renamed = np.concatenate([np.arange(n_sources), own]).astype(np.int32)
        return LinearProgram(
            self.n_columns + len(own),
            np.concatenate([self.out, renamed[observed.out]]),
            np.concatenate([self.starts, self.starts[-1] + observed.starts[1:]]).astype(np.int32),
            np.concatenate([self.columns, renamed[observed.columns]]),
            np.concatenate([self.which, observed.which + np.int32(before)]),
            np.concatenate([self.targets[:n_kept], renamed[observed.targets]]).astype(np.int32),
            np.concatenate([self.fixed, observed.fixed]),
        )


@dataclass
class Weights:
    """Different expressions among weights, and plain numbers; the latter come last."""

    expressions: list[Any] = field(default_factory=list)
    numbers: list[float] = field(default_factory=list)
    _known: dict[Any, int] = field(default_factory=dict)

    def place(self, weight: Any) -> int:
        """Return where a weight is among the expressions, or -1 - k for number k."""
        if weight.is_constant():
            value = float(weight)
            if value not in self._known:
                self._known[value] = -1 - len(self.numbers)
                self.numbers.append(value)
            return self._known[value]
        key = ("x", weight.element_hash())
        if key not in self._known:
            self._known[key] = len(self.expressions)
            self.expressions.append(weight)
        return self._known[key]


@dataclass
class Writer:
    """A program while it is written."""

    n_columns: int
    weights: Weights = field(default_factory=Weights)
    out: list[int] = field(default_factory=list)
    starts: list[int] = field(default_factory=lambda: [0])
    columns: list[int] = field(default_factory=list)
    which: list[int] = field(default_factory=list)

    def row(self, entries: Sequence[tuple[int, int]]) -> int:
        """Write a row of (column, place of weight); return its column."""
        self.out.append(self.n_columns)
        self.columns += [column for column, _ in entries]
        self.which += [place for _, place in entries]
        self.starts.append(len(self.columns))
        self.n_columns += 1
        return self.n_columns - 1

    def rows(self, rows: LinearRows, sources: Sequence[int]) -> list[int]:
        """Write rows whose sources are these columns; return the columns of their targets."""
        columns = list(sources)
        for k in range(len(rows.starts) - 1):
            own = range(rows.starts[k], rows.starts[k + 1])
            entries = [(columns[rows.columns[i]], self.weights.place(rows.weights[i])) for i in own]
            columns.append(self.row(entries))
        return [columns[k] for k in rows.targets]

    def written(
        self, column: Any, symbols: Sequence[Any], sources: Mapping[int, Sequence[int]]
    ) -> tuple[list[int], Any]:
        """Write the rows of a column of functions; return its targets' columns and its values.

        ``sources`` are the columns of those symbols that move, by their number.
        """
        import casadi

        column = casadi.cse(casadi.densify(column))
        elements = [(k, i) for k, own in sources.items() for i in range(len(own))]
        function = casadi.Function("values", symbols, [column])
        with as_written():  # products with reciprocals would become divisions, which take longer
            column = use_reciprocals(function, list(symbols), lambda _: True)[0]
            function = casadi.Function("values", symbols, [column])
            graph = slope_graph(function, list(symbols), lambda k: k in sources)
            rows = by_parts(eliminated(graph, elements, _SLACK))
        flat = [item for own in sources.values() for item in own]
        return self.rows(rows, flat), graph.values

    def program(self, targets: Sequence[int], n_inverse: int = 0) -> LinearProgram:
        """Return what has been written; of ``n_inverse`` places weights are found elsewhere."""
        lists = (self.out, self.starts, self.columns, targets)
        out, starts, columns, ends = (np.array(item, dtype=np.int32) for item in lists)
        numbers = np.array([*self.weights.numbers, 1.0])
        places = self.places(self.which, n_inverse)
        return LinearProgram(self.n_columns, out, starts, columns, places, ends, numbers)

    def places(self, which: Sequence[int], n_inverse: int) -> Index:
        """Return where weights lie: the expressions, those found elsewhere, the numbers."""
        n_own, found = len(self.weights.expressions), np.array(which, dtype=np.int64)
        inverse, number = found <= INVERSE, (found < 0) & (found > INVERSE)
        found[inverse] = n_own + (INVERSE - found[inverse])
        found[number] = n_own + n_inverse - 1 - found[number]
        return found.astype(np.int32)
