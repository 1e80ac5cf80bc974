"""The functions that an export consists of: their arguments, results and expressions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from vehicledyn.multibody.equations.equation_terms import Entries, Ingredients, Label
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.sparse_rows import rows_of


@dataclass(frozen=True)
class Argument:
    """An argument: short name, column of symbols, and whether it is one number.

    The parameters are a structure named ``p`` in every language.
    """

    name: str
    symbols: Scalar
    is_scalar: bool = False

    @property
    def size(self) -> int:
        """Number of elements."""
        return int(self.symbols.shape[0])


@dataclass(frozen=True)
class ResultArray:
    """A result: name, shape (rows,) or (rows, columns) and its structural nonzeros.

    ``meaning`` says what each row of a vector is.
    """

    name: str
    shape: tuple[int, ...]
    entries: dict[tuple[int, ...], Scalar]
    meaning: tuple[str, ...] = ()


@dataclass(frozen=True)
class Procedure:
    """A function to print: what it returns, in words, and from what."""

    name: str
    summary: str
    arguments: tuple[Argument, ...]
    targets: tuple[ResultArray, ...]
    labels: tuple[Label, ...] = ()


def procedures(g: Ingredients) -> tuple[Procedure, ...]:
    """Return the functions of a system, those in all coordinates first."""
    return (*_of_the_tree(g), *_of_the_states(g))


def _of_the_tree(g: Ingredients) -> tuple[Procedure, ...]:
    t = Argument("t", g.equations.time, is_scalar=True)
    q, qd, qdd = (
        Argument(name, symbols)
        for name, symbols in (("q", g.coordinates), ("qd", g.rates), ("qdd", g.accelerations))
    )
    s, u = Argument("s", g.part_states), Argument("u", g.part_unknowns)
    p = Argument("p", g.equations.parameter)
    names = [v.name for v in g.variables]
    n, m = len(g.variables), len(g.constraint_names)
    mass = [
        Label("Mass matrix", f"M{i + 1}_{j + 1}", value)
        for (i, j), value in sorted(g.mass.items())
        if i <= j
    ]
    return (
        Procedure(
            "mass_matrix",
            "Mass matrix M of the tree, in all coordinates.",
            (q, p),
            (_matrix("M", (n, n), g.mass),),
            (*g.labels["mass"], *mass),
        ),
        Procedure(
            "bias",
            "Bias c of the tree: M qdd + c = J' lambda + forces of the drives.",
            (t, q, qd, s, u, p),
            (_vector("c", g.bias, names),),
            g.labels["bias"],
        ),
        Procedure(
            "inverse_dynamics",
            "Inverse dynamics Q = M qdd + c: the forces the coordinates need.",
            (t, q, qd, qdd, s, u, p),
            (_vector("Q", g.forces, names),),
            g.labels["forces"],
        ),
        Procedure(
            "constraints",
            "Constraints h of the loops, zero where they are closed.",
            (t, q, p),
            (_vector("h", g.constraints, g.constraint_names[: len(g.constraints)]),),
        ),
        Procedure(
            "constraint_jacobian",
            "Jacobian J of the constraints, dh/dq of those of the coordinates.",
            (t, q, p),
            (_matrix("J", (m, n), g.jacobian),),
        ),
        Procedure(
            "constraint_rate",
            "What time alone does to the constraints: J qd + b = 0.",
            (t, q, p),
            (_vector("b", g.constraint_rate, g.constraint_names),),
        ),
        Procedure(
            "quadratic_term",
            "Quadratic term of the constraints: J qdd + gamma = 0.",
            (t, q, qd, p),
            (_vector("gamma", g.quadratic, g.constraint_names),),
        ),
    )


def _of_the_states(g: Ingredients) -> tuple[Procedure, ...]:
    e, names = g.equations, [v.name for v in g.variables]
    arguments = (
        Argument("t", e.time, is_scalar=True),
        Argument("x", e.state),
        Argument("z", e.algebraic),
        Argument("p", e.parameter),
    )
    labels = g.labels["state"]
    size = len(e.unknowns)
    jacobian = {
        (i, j): value
        for i, row in enumerate(rows_of(ops.jacobian(e.residual, e.algebraic)))
        for j, value in row.items()
    }
    return (
        Procedure(
            "loops",
            "Residual g of the unknowns z, and its Jacobian G = dg/dz.",
            arguments,
            (_vector("g", _items(e.residual), _blocks(e)), _matrix("G", (size, size), jacobian)),
        ),
        Procedure(
            "coordinates",
            "All coordinates q and their rates qd; the unknowns z must solve the loops.",
            arguments,
            (_vector("q", g.positions_of_state, names), _vector("qd", g.rates_of_state, names)),
            labels,
        ),
        Procedure(
            "direct_dynamics",
            "Accelerations qdd of all coordinates; the unknowns z must solve the loops.",
            arguments,
            (_vector("qdd", g.accelerations_of_state, names),),
            labels,
        ),
        Procedure(
            "rates",
            "Rates xd of the states; the unknowns z must solve the loops.",
            arguments,
            (_vector("xd", _items(e.rate), [v.name for v in e.states]),),
            labels,
        ),
        Procedure(
            "sensors",
            "All channels y; the unknowns z must solve the loops.",
            arguments,
            (_vector("y", _items(e.output), [c.name for c in e.channels]),),
            g.labels["channels"],
        ),
    )


def _blocks(equations: Equations) -> list[str]:
    return [block.name for block in equations.blocks for _ in range(block.start, block.stop)]


def _items(column: Scalar) -> list[Scalar]:
    return [column[k] for k in range(column.shape[0])]


def _vector(name: str, items: Sequence[Scalar], meaning: Iterable[str]) -> ResultArray:
    entries: dict[tuple[int, ...], Scalar] = {(k,): item for k, item in enumerate(items)}
    return ResultArray(name, (len(items),), entries, tuple(meaning))


def _matrix(name: str, shape: tuple[int, int], entries: Entries) -> ResultArray:
    return ResultArray(name, shape, {place: entries[place] for place in sorted(entries)})
