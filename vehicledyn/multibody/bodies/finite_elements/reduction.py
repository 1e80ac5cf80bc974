"""Reduction of finite-element matrices to component modes (Craig, Bampton 1968).

Displacements are u = Ψ u_b + Φ η: static shapes Ψ for unit displacements of the interfaces, which
make deflections under loads on them exact, and normal modes Φ of the structure that is held there.
Rigid motion is taken out, either by the mass, so that the frame of the body is a mean of its axes
(Tisserand, Buckens), or by holding one interface, whose frame is then that of the body. What is
left is made orthogonal, so that each coordinate has a frequency; all have the mass of the body
as modal mass, so that an amplitude is the root mean square of the displacement [m].

Craig, Bampton (1968), AIAA Journal 6(7), 1313-1319; Craig (2000), AIAA-2000-1573, for the
orthogonal set.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodies.finite_elements.interfaces import (
    Interface,
    JoinedModel,
    Motion,
    Nodes,
    joined,
)
from vehicledyn.multibody.bodies.finite_elements.mode_signs import mode_signs
from vehicledyn.multibody.bodies.finite_elements.model import (
    FiniteElements,
    Sparse,
    indefinite_row,
    loose_row,
)

Array = NDArray[np.float64]
PIECE = -1
_DENSE = 600
"""Size up to which eigenvalues are those of full matrices."""
_MASSLESS = 1e-12
"""Mass over stiffness of a shape, over the largest, that has no motion of its own."""


@dataclass(frozen=True, eq=False)
class ComponentModes:
    """Modes of a structure relative to its frame.

    Parameters
    ----------
    model
        The matrices.
    shapes
        Displacements of the model's rows by unit amplitudes, shape (n_rows, n) [1, rad/m].
    frequencies
        Angular frequency of each mode, shape (n,) [rad/s].
    mass
        Mass of the body, the modal mass of each mode too [kg].
    damping
        Modal damping of the damping matrix, shape (n, n) [N s/m].
    frames
        Place [m], displacement by and rotation by the amplitudes, (3, n) each, of the frame of each
        interface and kept node by name; no rotation where its node has none.
    origin
        Where the frame of the body is in the axes of the model [m].
    nodes
        Number of the node of each frame by its name, ``PIECE`` for several.
    held_node
        The same of the interface that holds the body, 0 where none does.
    """

    model: FiniteElements
    shapes: Array
    frequencies: Array
    mass: float
    damping: Array
    frames: dict[str, tuple[Array, Array, Array | None]]
    origin: Array
    nodes: Mapping[str, int]
    held_node: int = 0


def component_modes(
    model: FiniteElements,
    interface: Mapping[str, Nodes],
    modes: int,
    *,
    reference: str | None = None,
    kept: Mapping[str, int] | None = None,
    motion: Motion = "all",
    highest: float | None = None,
) -> ComponentModes:
    """Return the component modes of a structure.

    Parameters
    ----------
    model
        The matrices.
    interface
        Node of each interface by name, or nodes that a rigid piece joins.
    modes
        Number of normal modes of the structure held at its interfaces.
    reference
        Interface that the body is held at; None for the mean of its axes.
    kept
        Further nodes by name whose motion is wanted.
    motion
        Whether interfaces may take moments ("all") or forces alone ("translations").
    highest
        Frequency above which modes are left out [rad/s]; None keeps all.

    Raises
    ------
    InputError
        If an interface is unknown, the interfaces do not hold the structure, the stiffness is
        indefinite, or there are fewer modes than asked for.
    """
    if modes < 0:
        raise InputError(f"modes: there are no {modes} of them; give 0 or more")
    whole = joined(model, interface)
    held = _held(whole, reference)
    boundary = [
        int(column)
        for name, item in whole.interfaces.items()
        if name != reference
        for column in (item.columns[:3] if motion == "translations" else item.columns)
    ]
    mass, stiffness = (whole.join.T @ m @ whole.join for m in (model.mass, model.stiffness))
    fixed = boundary, () if held is None else held.columns.tolist()
    basis = _fixed_interface_basis(whole, (mass, stiffness), fixed, modes)
    m, k = basis.T @ (mass @ basis), basis.T @ (stiffness @ basis)
    if held is None:
        own = whole.rigid[boundary]
        free = _complement(np.vstack([own, np.zeros((modes, 6))]).T @ m)
        basis, m, k = basis @ free, free.T @ m @ free, free.T @ k @ free
    squares, vectors = _orthogonal(m, k, model)
    chosen = np.sqrt(squares) <= (np.inf if highest is None else highest)
    if not chosen.any():
        lowest = np.sqrt(squares[0]) / (2.0 * np.pi)
        raise InputError(f"highest_frequency: is below the lowest of the body, {lowest:.4g} Hz")
    rigid = model.rigid[:, :3]
    total = float(np.trace(rigid.T @ (model.mass @ rigid)) / 3.0)
    amplitudes = basis @ vectors[:, chosen] * np.sqrt(total)
    signs = mode_signs(np.asarray(whole.join @ amplitudes))
    amplitudes = amplitudes * signs
    shapes = np.asarray(whole.join @ amplitudes)
    damping = np.zeros((shapes.shape[1],) * 2)
    if model.damping is not None:
        damping = shapes.T @ (model.damping @ shapes)
    origin = np.zeros(3) if reference is None else whole.interfaces[reference].place
    frames = _frames(whole, amplitudes, shapes, origin, kept or {})
    frequencies = np.sqrt(squares[chosen])
    nodes = {name: _node(given) for name, given in interface.items()}
    return ComponentModes(
        model,
        shapes,
        frequencies,
        total,
        damping,
        frames,
        origin,
        nodes | dict(kept or {}),
        0 if reference is None else nodes[reference],
    )


def _node(given: Nodes) -> int:
    items = [given] if isinstance(given, int) else list(given)
    return items[0] if len(items) == 1 else PIECE


def _held(whole: JoinedModel, reference: str | None) -> Interface | None:
    if reference is None:
        return None
    item = whole.interfaces.get(reference)
    if item is None:
        names = ", ".join(whole.interfaces)
        raise InputError(f"reference: '{reference}' is no interface; interfaces are {names}")
    if not item.turns:
        raise InputError(
            f"reference: the node of '{reference}' has no rotations and cannot hold the body; name "
            "three or more nodes for this interface, which a rigid piece then joins"
        )
    return item


def _fixed_interface_basis(
    whole: JoinedModel,
    matrices: tuple[Sparse, Sparse],
    fixed: tuple[Sequence[int], Sequence[int]],
    modes: int,
) -> Array:
    """Return constraint modes and fixed-interface normal modes, shape (n_columns, n).

    ``matrices`` are mass and stiffness, ``fixed`` the columns of the interfaces and those at which
    the body is held.
    """
    from scipy.sparse.linalg import splu

    (mass, stiffness), size, (boundary, held) = matrices, whole.join.shape[1], fixed
    inner = np.setdiff1d(np.arange(size), [*boundary, *held])
    inside = stiffness[inner][:, inner].tocsc()
    _refuse_loose(whole, inside, inner)
    normal = _normal_modes(mass[inner][:, inner], inside, modes) if modes else None
    basis = np.zeros((size, len(boundary) + modes))
    basis[boundary, range(len(boundary))] = 1.0
    if boundary and len(inner):
        right = stiffness[inner][:, boundary].toarray()
        basis[inner, : len(boundary)] = -splu(inside).solve(right)
    if normal is not None:
        basis[inner, len(boundary) :] = normal
    return basis


def _refuse_loose(whole: JoinedModel, inside: Sparse, inner: NDArray[np.int64]) -> None:
    """Refuse a stiffness that is indefinite, or lets parts move while the interfaces are held."""
    model = whole.model
    row = indefinite_row(inside) if len(inner) else None
    if row is not None:
        words = f"{model.source}: stiffness: is indefinite, found at {_named(whole, inner[row])}"
        raise InputError(f"{words}; check signs and the elements there")
    row = loose_row(inside) if len(inner) else None
    if row is not None:
        raise InputError(
            f"interface: does not hold the body of {model.source}, found at "
            f"{_named(whole, inner[row])}: name further interfaces, or nodes that a rigid piece "
            "joins, and look for parts that nothing joins"
        )


def _named(whole: JoinedModel, column: int) -> str:
    rows = whole.join[:, [int(column)]].nonzero()[0]
    return whole.model.row_name(int(rows[0]))


def _normal_modes(mass: Sparse, stiffness: Sparse, modes: int) -> Array:
    """Return the lowest modes of a held structure, shape (n, modes)."""
    from scipy.linalg import eigh
    from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh, splu

    count = mass.shape[0]
    if count <= _DENSE or modes >= count // 2:
        # Massless rows are allowed: the reciprocal problem has a definite matrix on its right.
        values, vectors = eigh(mass.toarray(), stiffness.toarray())
        independent = int((values > _MASSLESS * max(values[-1], 0.0)).sum()) if count else 0
        if modes > independent:
            raise InputError(
                f"modes: {modes} are more than are independent: the structure held at its "
                f"interfaces has {independent}; give at most as many"
            )
        return np.asarray(vectors[:, ::-1][:, :modes] / np.sqrt(values[::-1][:modes]))
    solve = LinearOperator(mass.shape, matvec=splu(stiffness.tocsc()).solve)
    start = np.random.default_rng(0).normal(size=count)
    try:
        found = eigsh(stiffness, modes, mass, sigma=0.0, OPinv=solve, v0=start)[1]
    except ArpackNoConvergence:
        raise InputError(f"modes: {modes} cannot be found; give fewer") from None
    return np.asarray(found)


def _complement(rows: Array) -> Array:
    """Return an orthonormal basis of what some rows are orthogonal to."""
    _, sizes, right = np.linalg.svd(rows / np.linalg.norm(rows, axis=1, keepdims=True))
    return np.asarray(right[len(sizes) :].T)


def _orthogonal(mass: Array, stiffness: Array, model: FiniteElements) -> tuple[Array, Array]:
    """Return squared frequencies and vectors of unit mass."""
    from scipy.linalg import eigh

    if not len(mass):
        raise InputError("modes: the body has none and would be rigid; give it some, or a body")
    mass, stiffness = 0.5 * (mass + mass.T), 0.5 * (stiffness + stiffness.T)
    values, vectors = eigh(mass, stiffness)
    if values[0] < _MASSLESS * values[-1]:
        raise InputError(
            f"interface: a displacement of one moves no mass of {model.source}; give the nodes "
            "rotary inertia, or write 'motion: translations' where no moments act on interfaces"
        )
    order = np.argsort(-values)
    return 1.0 / values[order], vectors[:, order] / np.sqrt(values[order])


def _frames(
    whole: JoinedModel, amplitudes: Array, shapes: Array, origin: Array, kept: Mapping[str, int]
) -> dict[str, tuple[Array, Array, Array | None]]:
    """Return place, displacement and rotation of interfaces and kept nodes."""
    found: dict[str, tuple[Array, Array, Array | None]] = {}
    for name, item in whole.interfaces.items():
        moved = amplitudes[item.columns]
        found[name] = item.place - origin, moved[:3], moved[3:] if item.turns else None
    model = whole.model
    for name, node in kept.items():
        if name in found:
            raise InputError(f"nodes.{name}: is also the name of an interface; take another")
        if node not in model.index:
            near = min(model.index, key=lambda known: abs(known - node))
            words = f"nodes.{name}: {model.source} has no node {node}; the nearest number is {near}"
            raise InputError(words)
        known = [model.row_of.get((node, d)) for d in range(1, 7)]
        rows = [row for row in known if row is not None]
        turned = shapes[rows[3:]] if len(rows) == 6 else None
        found[name] = model.places[model.index[node]] - origin, shapes[rows[:3]], turned
    return found
