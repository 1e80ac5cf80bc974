"""Interfaces of a finite-element model: nodes, or sets of nodes held together as a rigid piece."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodies.finite_elements.model import FiniteElements, Sparse, rigid_motions

Array = NDArray[np.float64]
Nodes: TypeAlias = int | Sequence[int]
"""Number of a node, or of those that a rigid piece holds together."""

Motion: TypeAlias = Literal["all", "translations"]
_STRAIGHT = 1e-6
"""Smallest breadth of a set of nodes that determines its rotation, over its length."""


@dataclass(frozen=True, eq=False)
class Interface:
    """A frame at a node or in the middle of some: its place [m] and its displacements.

    ``columns`` are the columns of the model's coordinates that displace (3) and turn it (3); those
    of a node without rotations are fewer.
    """

    name: str
    place: Array
    columns: NDArray[np.int64]

    @property
    def turns(self) -> bool:
        """Whether rotations belong to its displacements."""
        return len(self.columns) == 6


@dataclass(frozen=True, eq=False)
class JoinedModel:
    """A model whose rigid pieces have six coordinates each: u = ``join`` times coordinates.

    The first columns of ``join`` are those of ``rows`` that belong to no piece.
    """

    model: FiniteElements
    rows: NDArray[np.int64]
    join: Sparse
    interfaces: dict[str, Interface]

    @property
    def rigid(self) -> Array:
        """Coordinates of unit translations and rotations about the origin, (n_columns, 6)."""
        found = np.zeros((self.join.shape[1], 6))
        found[: len(self.rows)] = self.model.rigid[self.rows]
        for item in self.interfaces.values():
            own = np.array([(1, d) for d in range(1, len(item.columns) + 1)])
            found[item.columns] = rigid_motions(np.tile(item.place, (len(own), 1)), own)
        return found


def joined(model: FiniteElements, named: Mapping[str, Nodes]) -> JoinedModel:
    """Return a model with its interfaces.

    Parameters
    ----------
    model
        The matrices.
    named
        Node of each interface, or nodes that a rigid piece joins to a frame in their middle.

    Raises
    ------
    InputError
        If a node is unknown or belongs to two interfaces, or nodes of a piece stand on a line.
    """
    from scipy.sparse import hstack, identity

    nodes = {name: _known(model, name, given) for name, given in named.items()}
    _refuse_shared(nodes)
    slaves = {n for items in nodes.values() if len(items) > 1 for n in items}
    kept = np.array([k for k, (n, _) in enumerate(model.rows) if int(n) not in slaves], dtype=int)
    column_of = {int(row): column for column, row in enumerate(kept)}
    blocks = [identity(len(model.rows), format="csc")[:, kept]]
    found: dict[str, Interface] = {}
    count = len(kept)
    for name, items in nodes.items():
        if len(items) == 1:
            known = [model.row_of.get((items[0], d)) for d in range(1, 7)]
            own = [column_of[row] for row in known if row is not None]
            columns = np.array(own if len(own) == 6 else own[:3])
            found[name] = Interface(name, model.places[model.index[items[0]]], columns)
            continue
        middle, block = _piece(model, name, items)
        blocks.append(block)
        found[name] = Interface(name, middle, np.arange(count, count + 6))
        count += 6
    return JoinedModel(model, kept, hstack(blocks).tocsr(), found)


def _piece(model: FiniteElements, name: str, items: Sequence[int]) -> tuple[Array, Sparse]:
    """Return the middle of nodes, and how a rigid piece there displaces the rows, (n_rows, 6)."""
    from scipy.sparse import lil_matrix

    places = model.places[[model.index[n] for n in items]]
    middle = places.mean(axis=0)
    _refuse_straight(model, name, places - middle)
    rows = [k for k, (n, _) in enumerate(model.rows) if int(n) in set(items)]
    arms = model.places[[model.index[int(n)] for n in model.rows[rows, 0]]] - middle
    block = lil_matrix((len(model.rows), 6))
    block[rows] = rigid_motions(arms, model.rows[rows])
    return middle, block.tocsc()


def _known(model: FiniteElements, name: str, given: Nodes) -> list[int]:
    items = [given] if isinstance(given, int) else list(given)
    if not items:
        raise InputError(f"interface.{name}: names no node; give one or several")
    lost = [n for n in items if n not in model.index]
    if lost:
        near = min(model.index, key=lambda known: abs(known - lost[0]))
        raise InputError(
            f"interface.{name}: {model.source} has no node {lost[0]}; the nearest number is {near}"
        )
    return list(dict.fromkeys(items))


def _refuse_shared(nodes: Mapping[str, Sequence[int]]) -> None:
    seen: dict[int, str] = {}
    for name, items in nodes.items():
        for n in items:
            if n in seen:
                words = f"interface.{name}: node {n} is also of '{seen[n]}'"
                raise InputError(f"{words}; attach both to one interface, or take another node")
            seen[n] = name


def _refuse_straight(model: FiniteElements, name: str, arms: Array) -> None:
    sizes = np.linalg.svd(arms, compute_uv=False)
    if sizes[1] <= _STRAIGHT * max(sizes[0], 1e-300) and model.rows[:, 1].max() <= 3:
        raise InputError(
            f"interface.{name}: its nodes stand on a line, about which nothing holds the rotation; "
            "give a further node beside it"
        )
