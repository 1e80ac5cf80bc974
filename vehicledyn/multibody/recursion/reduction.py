"""Reduction to the independent coordinates: (M, c) of the tree become q̈_v and then all q̈."""

from __future__ import annotations

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.elimination import Rows, solve_symmetric
from vehicledyn.symbolic.ops import Scalar


def independent_accelerations(
    mass: dict[tuple[str, str], Scalar],
    bias: dict[str, Scalar],
    independent: list[str],
    influence: dict[str, dict[str, Scalar]],
) -> dict[str, Scalar]:
    """Return q̈_v from (Tᵀ M T) q̈_v = -Tᵀ c with q̇ = T q̇_v + ...

    Parameters
    ----------
    mass
        Nonzero entries of M over independent and dependent coordinates [kg, kg m, kg m²].
    bias
        c of each of them: what M q̈ lacks when the independent accelerations are zero.
    independent
        Names of the independent coordinates.
    influence
        B of q̇_u = B q̇_v: for each dependent coordinate {independent: entry}.
    """
    spread = _spread(independent, influence)
    force: list[Scalar] = [ops.scalar(0.0) for _ in independent]
    for name, row in spread.items():
        for i, entry in row.items():
            force[i] = force[i] - entry * bias[name]
    reduced = reduced_mass(mass, independent, influence)
    return dict(zip(independent, solve_symmetric(reduced, force), strict=True))


def reduced_mass(
    mass: dict[tuple[str, str], Scalar],
    independent: list[str],
    influence: dict[str, dict[str, Scalar]],
) -> Rows:
    """Return Tᵀ M T with both triangles; parameters are those of independent_accelerations."""
    spread = _spread(independent, influence)
    reduced: Rows = [{} for _ in independent]
    for (a, b), value in mass.items():
        for i, left in spread[a].items():
            for j, right in spread[b].items():
                if j <= i:
                    reduced[i][j] = reduced[i].get(j, 0.0) + left * (value * right)
    for i, row in enumerate(reduced):
        for j, value in row.items():
            reduced[j][i] = value
    return reduced


def _spread(
    independent: list[str], influence: dict[str, dict[str, Scalar]]
) -> dict[str, dict[int, Scalar]]:
    """Return the rows of T by name."""
    column = {name: k for k, name in enumerate(independent)}
    return {
        **{name: {k: ops.scalar(1.0)} for name, k in column.items()},
        **{
            name: {column[v]: entry for v, entry in row.items() if not entry.is_zero()}
            for name, row in influence.items()
        },
    }
