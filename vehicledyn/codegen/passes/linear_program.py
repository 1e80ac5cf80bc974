"""The derivatives of a model at a point as a sparse linear program of numbers.

A program has columns: sources whose tangents are given, then rows, each a sum of weights times
columns before it. The weights are what a generated function computes at a point; they serve any
number of directions, forward, and transposed for adjoints.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.codegen.passes.kernel_functions import KernelFunctions, as_written
from vehicledyn.codegen.passes.local_slopes import slope_graph
from vehicledyn.codegen.passes.vertex_elimination import LinearRows, eliminated
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.shared import inlined

Index = NDArray[np.int32]

_SLACK = 0
"""Edges that a node may leave behind more than it takes along, see vertex_elimination."""


@dataclass(frozen=True)
class Program:
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

    def transposed(self, sources: Sequence[int], one: int) -> Program:
        """Return the program of the adjoints of some sources.

        Its own sources are the adjoints of the results; behind them columns keep their order. The
        weight ``one`` is the number one.
        """
        n = len(self.targets)
        users: dict[int, list[tuple[int, int]]] = {}
        for k, target in enumerate(self.targets):
            users.setdefault(int(target), []).append((k, one))
        for k, target in enumerate(self.out):
            for i in range(self.starts[k], self.starts[k + 1]):
                entry = (n + int(target), int(self.which[i]))
                users.setdefault(int(self.columns[i]), []).append(entry)
        out = [*map(int, self.out[::-1]), *sources]
        entries = [users.get(column, []) for column in out]
        flat = [item for own in entries for item in own]
        return Program(
            n + self.n_columns,
            np.array([n + column for column in out], dtype=np.int32),
            np.cumsum([0, *map(len, entries)], dtype=np.int32),
            np.array([column for column, _ in flat], dtype=np.int32),
            np.array([place for _, place in flat], dtype=np.int32),
            np.array([n + column for column in sources], dtype=np.int32),
            self.fixed,
        )

    def with_values(self, unknowns: Index, observed: Program, before: int) -> Program:
        """Return this program of rates with unknowns and observed values as its results instead.

        The sources of ``observed`` are time, states, unknowns and constants; its weights lie
        behind ``before`` others.
        """
        n_x, n_z = len(self.targets), len(unknowns)
        n_sources = observed.n_columns - len(observed.out)
        of_source = np.concatenate(
            [np.arange(1 + n_x), unknowns, np.arange(1 + n_x, n_sources - n_z)]
        )
        own = self.n_columns + np.arange(len(observed.out))
        renamed = np.concatenate([of_source, own]).astype(np.int32)
        return Program(
            self.n_columns + len(own),
            np.concatenate([self.out, renamed[observed.out]]),
            np.concatenate([self.starts, self.starts[-1] + observed.starts[1:]]).astype(np.int32),
            np.concatenate([self.columns, renamed[observed.columns]]),
            np.concatenate([self.which, observed.which + np.int32(before)]),
            np.concatenate([unknowns, renamed[observed.targets]]).astype(np.int32),
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
class _Writer:
    """A program while it is written; own places of weights count from -2**30 down."""

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

    def program(self, targets: Sequence[int], n_inverse: int = 0) -> Program:
        n_own = len(self.weights.expressions)
        which = np.array(self.which, dtype=np.int64)
        inverse, number = which <= _INVERSE, (which < 0) & (which > _INVERSE)
        which[inverse] = n_own + (_INVERSE - which[inverse])
        which[number] = n_own + n_inverse - 1 - which[number]
        numbers = np.array([*self.weights.numbers, 1.0])
        lists = (self.out, self.starts, self.columns, which, targets)
        out, starts, columns, places, ends = (np.array(item, dtype=np.int32) for item in lists)
        return Program(self.n_columns, out, starts, columns, places, ends, numbers)


_INVERSE = -(2**30)


@dataclass(frozen=True)
class StageProgram:
    """Rates and unknowns at a point: columns are t, x, c, then rows.

    ``function``: (t, x, z, c) -> rates, weights, ∂g/∂z of the blocks one after the other, by
    columns. Behind the weights lie -(∂g/∂z)⁻¹ of the blocks, then the fixed ones. ``unknowns`` are
    the columns of z.
    """

    function: Any
    program: Program
    unknowns: Index

    @property
    def n_weights(self) -> int:
        """Number of weights, those of the inverses and the fixed ones among them."""
        return int(self.function.numel_out(1) + self.function.numel_out(2)) + len(
            self.program.fixed
        )


def stage_program(equations: Equations, functions: KernelFunctions) -> StageProgram:
    """Return the program of rates and unknowns."""
    import casadi

    t, x, z, c = symbols = _symbols(functions)
    n_x, n_c = x.numel(), c.numel()
    writer = _Writer(1 + n_x + n_c)
    of_c = list(range(1 + n_x, 1 + n_x + n_c))
    unknowns: list[int] = []
    waves = [inlined(wave(*symbols)) for wave in functions.waves]
    parts = casadi.vertsplit(casadi.vertcat(*waves)) if waves else []
    jacobians, first, n_inverse = [], 0, 0
    for block in equations.blocks:
        n = block.stop - block.start
        residual = casadi.vertcat(*parts[first : first + n])
        jacobians += parts[first + n : first + n + n * n]
        first += n + n * n
        columns = [*range(1 + n_x), *unknowns, *of_c]
        moving = casadi.vertcat(t, x, z[: block.start], c)
        slopes = ops.jacobian(residual, moving)
        rows = _by_rows(slopes, columns, writer.weights)
        own = [writer.row(entries) for entries in rows]
        unknowns += [
            writer.row([(own[j], _INVERSE - n_inverse - i - n * j) for j in range(n)])
            for i in range(n)
        ]
        n_inverse += n * n
    rate = inlined(functions.rates(*symbols))
    sources = [0, *range(1, 1 + n_x), *unknowns, *of_c]
    targets, values = _written(writer, rate, symbols, sources)
    results = [values, casadi.vertcat(*writer.weights.expressions), casadi.vertcat(*jacobians)]
    function = casadi.Function(
        "linearise", symbols, [casadi.densify(item) for item in _cse(results)]
    )
    program = writer.program(targets, n_inverse)
    return StageProgram(function, program, np.array(unknowns, np.int32))


@dataclass(frozen=True)
class PointProgram:
    """Some functions of a point: columns are t, x, z, c, then rows.

    ``function``: (t, x, z, c) -> values, weights.
    """

    function: Any
    program: Program


def point_program(functions: KernelFunctions, expressions: Sequence[Any]) -> PointProgram:
    """Return the program of some columns, functions of (t, x, z, c)."""
    import casadi

    symbols = _symbols(functions)
    column = casadi.vertcat(casadi.SX(0, 1), *[item(*symbols) for item in expressions])
    n_columns = sum(item.numel() for item in symbols)
    writer = _Writer(n_columns)
    targets, values = _written(writer, inlined(column), symbols, list(range(n_columns)))
    results = [values, casadi.vertcat(*writer.weights.expressions)]
    function = casadi.Function("observe", symbols, [casadi.densify(item) for item in _cse(results)])
    return PointProgram(function, writer.program(targets))


def _symbols(functions: KernelFunctions) -> list[Any]:
    import casadi

    sizes = [functions.rates.numel_in(k) for k in range(4)]
    return [casadi.SX.sym(name, size) for name, size in zip("txzc", sizes, strict=True)]


def _written(
    writer: _Writer, column: Any, symbols: list[Any], sources: Sequence[int]
) -> tuple[list[int], Any]:
    """Write the rows of a column of functions; return the columns of its targets and its values."""
    import casadi

    column = casadi.cse(casadi.densify(column))
    elements = [(k, i) for k, item in enumerate(symbols) for i in range(item.numel())]
    function = casadi.Function("values", symbols, [column])
    with as_written():  # products with reciprocals would become divisions, which take longer
        graph = slope_graph(function, symbols, lambda _: True)
        rows = eliminated(graph, elements, _SLACK)
    return writer.rows(rows, sources), graph.values


def _cse(results: list[Any]) -> list[Any]:
    import casadi

    dense = [casadi.densify(casadi.SX(item)) for item in results]
    with as_written():
        return list(casadi.cse(dense))


def _by_rows(slopes: Any, columns: Sequence[int], weights: Weights) -> list[list[tuple[int, int]]]:
    """Return the entries (column, place of weight) of each row of a sparse matrix."""
    rows: list[list[tuple[int, int]]] = [[] for _ in range(slopes.size1())]
    entries = slopes.nonzeros()
    pattern = slopes.sparsity()
    for row, column, entry in zip(pattern.row(), pattern.get_col(), entries, strict=True):
        rows[row].append((columns[column], weights.place(entry)))
    return rows
