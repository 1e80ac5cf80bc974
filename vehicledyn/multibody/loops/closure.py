"""Loop closure: dependent rates and accelerations as functions of the independent ones.

From J_u q̇_u + J_v q̇_v + J_c q̇_c + h_t = 0 and its time derivative (book, chapter 4.5.1),
solved block by block with pivots chosen at assembly.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from vehicledyn.multibody.loops.partition import Partition
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.elimination import Rows, solve_in_order, transpose
from vehicledyn.symbolic.ops import Scalar

_BIAS = -1


@dataclass(frozen=True)
class Closure:
    """Rows of the kept constraints at symbolic coordinates.

    ``jacobian`` has one row a residual over all coordinates, ``rate`` is ∂h/∂t of each
    residual and ``quadratic`` its second derivative at zero accelerations.
    """

    partition: Partition
    jacobian: Rows
    rate: list[Scalar]
    quadratic: list[Scalar]

    def dependent_rates(self, rates: dict[int, Scalar]) -> dict[int, Scalar]:
        """Return the dependent rates, given the rates of all other coordinates."""
        return self._solve(rates, self.rate)

    def dependent_accelerations(self, accelerations: dict[int, Scalar]) -> dict[int, Scalar]:
        """Return the dependent accelerations, given those of the other coordinates."""
        return self._solve(accelerations, self.quadratic)

    def influence(self, independent: list[int]) -> dict[int, dict[int, Scalar]]:
        """Return B of q̇_u = B q̇_v: for each dependent coordinate {independent: entry}."""
        wanted = set(independent)
        right = [
            {j: -v for j, v in self.jacobian[row].items() if j in wanted}
            for row, _ in self.partition.pairs
        ]
        return self._eliminate(right)

    def multipliers(self, forces: dict[int, Scalar]) -> dict[int, Scalar]:
        """Return the multiplier of each kept residual from J_uᵀ λ = Q_u."""
        pairs = self.partition.pairs
        square = self._square()
        turned = transpose(square, len(pairs))
        right = [{_BIAS: forces[column]} for _, column in pairs]
        solution = solve_in_order(turned, right, _transposed_order(self.partition))
        return {row: solution[k].get(_BIAS, ops.scalar(0.0)) for k, (row, _) in enumerate(pairs)}

    def _solve(self, known: dict[int, Scalar], bias: list[Scalar]) -> dict[int, Scalar]:
        right: list[dict[int, Scalar]] = []
        for row, _ in self.partition.pairs:
            total = -bias[row]
            for column, entry in self.jacobian[row].items():
                if column in known:
                    total = total - entry * known[column]
            right.append({_BIAS: total})
        solved = self._eliminate(right)
        return {column: row.get(_BIAS, ops.scalar(0.0)) for column, row in solved.items()}

    def _eliminate(self, right: list[dict[int, Scalar]]) -> dict[int, dict[int, Scalar]]:
        """Solve J_u X = right, block after block."""
        position = {column: k for k, (_, column) in enumerate(self.partition.pairs)}
        solved: dict[int, dict[int, Scalar]] = {}
        first = 0
        for block in self.partition.blocks:
            local = {column: k for k, (_, column) in enumerate(block)}
            matrix: Rows = []
            sides: list[dict[int, Scalar]] = []
            for offset, (row, _) in enumerate(block):
                side = dict(right[first + offset])
                entries = {c: v for c, v in self.jacobian[row].items() if c in position}
                for column, entry in entries.items():
                    if column not in local:
                        for key, value in solved[column].items():
                            side[key] = side.get(key, 0.0) - entry * value
                matrix.append({local[c]: v for c, v in entries.items() if c in local})
                sides.append(side)
            order = [(k, k) for k in range(len(block))]
            solution = solve_in_order(matrix, sides, order)
            for (_, column), entries in zip(block, solution, strict=True):
                solved[column] = entries
            first += len(block)
        return solved

    def _square(self) -> Rows:
        """Return J_u with rows and columns in the order of the pairs."""
        position = {column: k for k, (_, column) in enumerate(self.partition.pairs)}
        return [
            {position[c]: v for c, v in self.jacobian[row].items() if c in position}
            for row, _ in self.partition.pairs
        ]


@dataclass(frozen=True)
class MultiplierClosure:
    """Stands for the closure where no coordinate is dependent.

    ``jacobian``, ``rate`` and ``quadratic`` are those of all rows, see :class:`Closure`;
    ``found`` are the multipliers by row.
    """

    partition: Partition
    jacobian: Rows
    rate: list[Scalar]
    quadratic: list[Scalar]
    found: dict[int, Scalar] = field(default_factory=dict)

    def dependent_rates(self, rates: dict[int, Scalar]) -> dict[int, Scalar]:
        """Return nothing: the rates of all coordinates are states."""
        return {}

    def dependent_accelerations(self, accelerations: dict[int, Scalar]) -> dict[int, Scalar]:
        """Return nothing: all accelerations are solved for together."""
        return {}

    def influence(self, independent: list[int]) -> dict[int, dict[int, Scalar]]:
        """Return nothing: no coordinate follows from others."""
        return {}

    def multipliers(self, forces: dict[int, Scalar]) -> dict[int, Scalar]:
        """Return the multiplier of each kept row."""
        return dict(self.found)


def _transposed_order(partition: Partition) -> list[tuple[int, int]]:
    """Return pivots of J_uᵀ: blocks last to first, within a block in its own order."""
    order: list[tuple[int, int]] = []
    first = sum(len(block) for block in partition.blocks)
    for block in reversed(partition.blocks):
        first -= len(block)
        order.extend((first + k, first + k) for k in range(len(block)))
    return order
