"""The linear programs of a model: tangents of its rates, its unknowns and what is observed.

Where a model tells what its accelerations fulfil, their tangents are not carried through the
solution for them. Those of the residuals r at the accelerations found are, and then

    da = -(∂r/∂a)⁻¹ dr

by the factors L D Lᵀ of the reduced mass matrix: fewer operations, and the rows of one part of a
model do not lead to the accelerations of all others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.codegen.passes.kernel_functions import KernelFunctions, as_written
from vehicledyn.codegen.passes.linear_program import INVERSE, Index, LinearProgram, Weights, Writer
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.elimination import Condensed, Rows, condense_symmetric
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.motion_residuals import MotionResiduals
from vehicledyn.symbolic.shared import count_operations, inlined

_MOST_OPERATIONS = 1.5
"""Operations of residuals, mass matrix and factors over those of the rates, up to which the former
pay: they are what their derivatives follow from."""


def suitable_residuals(equations: Equations) -> MotionResiduals | None:
    """Return what the accelerations fulfil, where tangents by way of it are shorter."""
    if equations.motion_residuals is None:
        return None
    found = equations.motion_residuals()
    if not found.rows:
        return None
    factors = _factors(inlined(found.mass))
    values = [v for _, own in factors.steps for v in own.values()]
    expressions = [found.residual, *map(ops.scalar, [*values, *factors.inverses])]
    count = count_operations(ops.stacked(*expressions))
    return found if count <= _MOST_OPERATIONS * count_operations(equations.rate) else None


@dataclass(frozen=True)
class StageSolution:
    """Steps on the results of a program in their places, one after the other.

    Step k multiplies result ``out[k]`` by the weight ``scales[k]`` and adds the products of the
    results ``columns`` and the weights ``which``, from ``starts[k]`` to ``starts[k + 1]``.
    """

    out: Index
    scales: Index
    starts: Index
    columns: Index
    which: Index


_NOTHING = np.zeros(0, dtype=np.int32)
NO_STEPS = StageSolution(_NOTHING, _NOTHING, np.zeros(1, dtype=np.int32), _NOTHING, _NOTHING)
"""The solution of results that are found already."""


@dataclass(frozen=True)
class StageProgram:
    """Unknowns and rates at a point: columns are t, x, z, c, then rows.

    ``function``: (t, x, z, a, c) -> weights, ∂g/∂z of the blocks one after the other, by columns;
    ``accelerated`` are the states whose rates are a. Behind the weights lie -(∂g/∂z)⁻¹ of the
    blocks, then the fixed ones. The first results are the tangents of z, which are columns of the
    results behind them; the others are those of the rates once the steps of ``solution`` are done.
    """

    function: Any
    program: LinearProgram
    n_unknowns: int
    accelerated: tuple[int, ...]
    solution: StageSolution

    @property
    def n_weights(self) -> int:
        """Number of weights, those of the inverses and the fixed ones among them."""
        return int(self.function.numel_out(0) + self.function.numel_out(1)) + len(
            self.program.fixed
        )


def stage_program(
    equations: Equations, functions: KernelFunctions, accelerated: Sequence[int] = ()
) -> StageProgram:
    """Return the program of unknowns and rates.

    ``accelerated`` are the states whose rates are the accelerations of the functions' ``balance``.
    """
    import casadi

    symbols = t, x, z, c = _symbols(functions)
    writer, sources = _begun(symbols)
    unknowns, jacobians, n_inverse = _unknowns(equations, functions, symbols, writer)
    rate, mass = inlined(functions.rates(*symbols)), None
    a = casadi.SX.sym("a", len(accelerated))
    if accelerated:
        missing, mass = functions.balance(t, x, z, a, c)
        rate[list(accelerated)] = inlined(missing)
    moving = {(0, 1, 2, 4)[k]: columns for k, columns in sources.items()}
    rates, _ = writer.written(rate, [t, x, z, a, c], moving)
    steps = [] if mass is None else _steps(inlined(mass), accelerated, writer.weights)
    results = [casadi.vertcat(*writer.weights.expressions), casadi.vertcat(*jacobians)]
    function = casadi.Function("linearise", [t, x, z, a, c], _cse(results))
    return StageProgram(
        function,
        writer.program([*unknowns, *rates], n_inverse),
        len(unknowns),
        tuple(accelerated),
        _solution(steps, len(unknowns), writer, n_inverse),
    )


def _begun(symbols: list[Any]) -> tuple[Writer, dict[int, Sequence[int]]]:
    """Return a writer whose first columns are some symbols, and which columns each one has."""
    stops = [0, *np.cumsum([item.numel() for item in symbols])]
    return Writer(int(stops[-1])), {k: range(*stops[k : k + 2]) for k in range(len(symbols))}


def _unknowns(
    equations: Equations, functions: KernelFunctions, symbols: list[Any], writer: Writer
) -> tuple[list[int], list[Any], int]:
    """Write the rows of the unknowns, of which each block follows from those before.

    Returns their columns, the Jacobians of the blocks and the number of entries of these.
    """
    import casadi

    t, x, z, c = symbols
    waves = [inlined(wave(*symbols)) for wave in functions.waves]
    parts = casadi.vertsplit(casadi.vertcat(*waves)) if waves else []
    n_before, n_z = 1 + x.numel(), z.numel()
    of_c = range(n_before + n_z, n_before + n_z + c.numel())
    unknowns: list[int] = []
    jacobians, first, n_inverse = list[Any](), 0, 0
    for block in equations.blocks:
        n = block.stop - block.start
        residual = casadi.vertcat(*parts[first : first + n])
        jacobians += parts[first + n : first + n + n * n]
        first += n + n * n
        # Not z[:0], which of a single unknown is a row of none that would shift the columns of c.
        known = z[list(range(block.start)), 0]
        slopes = ops.jacobian(residual, casadi.vertcat(t, x, known, c))
        columns = [*range(n_before + block.start), *of_c]
        own = [writer.row(entries) for entries in _by_rows(slopes, columns, writer.weights)]
        unknowns += [
            writer.row([(own[j], INVERSE - n_inverse - i - n * j) for j in range(n)])
            for i in range(n)
        ]
        n_inverse += n * n
    return unknowns, jacobians, n_inverse


_Step = tuple[int, int, list[tuple[int, int]]]
"""A result, the place of the weight that scales it, and what is added: (result, weight)."""


def _steps(mass: Any, accelerated: Sequence[int], weights: Weights) -> list[_Step]:
    """Return the steps that solve for accelerations: forward to the last pivot, and back."""
    found = _factors(mass)
    added: list[list[tuple[int, int]]] = [[] for _ in accelerated]
    back: list[_Step] = []
    for (pivot, factors), inverse in zip(found.steps, found.inverses, strict=True):
        places = {j: weights.place(-factor) for j, factor in factors.items()}
        for j, place in places.items():
            added[j].append((accelerated[pivot], place))
        entries = [(accelerated[j], place) for j, place in places.items()]
        back.append((accelerated[pivot], weights.place(-inverse), entries))
    one = weights.place(ops.scalar(1.0))
    ahead = [(accelerated[p], one, added[p]) for p, _ in found.steps if added[p]]
    return [*ahead, *reversed(back)]


def _factors(mass: Any) -> Condensed:
    """Return a symmetric matrix factorised, of which the lower triangle is read."""
    rows: Rows = [{} for _ in range(mass.size1())]
    for i in range(len(rows)):
        for j in range(i + 1):
            if not mass[i, j].is_zero():
                rows[i][j] = rows[j][i] = mass[i, j]
    return condense_symmetric(rows, [0.0] * len(rows), ())


def _solution(steps: list[_Step], before: int, writer: Writer, n_inverse: int) -> StageSolution:
    """Return steps on results, behind some before them, as lists of numbers."""
    entries = [item for _, _, own in steps for item in own]
    return StageSolution(
        np.array([before + out for out, _, _ in steps], dtype=np.int32),
        writer.places([place for _, place, _ in steps], n_inverse),
        np.cumsum([0, *[len(own) for _, _, own in steps]], dtype=np.int32),
        np.array([before + result for result, _ in entries], dtype=np.int32),
        writer.places([place for _, place in entries], n_inverse),
    )


@dataclass(frozen=True)
class PointProgram:
    """Some functions of a point: columns are t, x, z, c, then rows.

    ``function``: (t, x, z, c) -> values, weights.
    """

    function: Any
    program: LinearProgram


def point_program(functions: KernelFunctions, expressions: Sequence[Any]) -> PointProgram:
    """Return the program of some columns, functions of (t, x, z, c)."""
    import casadi

    symbols = _symbols(functions)
    column = casadi.vertcat(casadi.SX(0, 1), *[item(*symbols) for item in expressions])
    writer, sources = _begun(symbols)
    targets, values = writer.written(inlined(column), symbols, sources)
    results = [values, casadi.vertcat(*writer.weights.expressions)]
    function = casadi.Function("observe", symbols, _cse(results))
    return PointProgram(function, writer.program(targets))


def _symbols(functions: KernelFunctions) -> list[Any]:
    import casadi

    sizes = [functions.rates.numel_in(k) for k in range(4)]
    return [casadi.SX.sym(name, size) for name, size in zip("txzc", sizes, strict=True)]


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
