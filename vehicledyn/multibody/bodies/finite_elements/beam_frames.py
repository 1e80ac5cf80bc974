"""Frames of straight beam elements as finite-element matrices, for where no other program is near.

Elements have two nodes with six directions each, cubic bending (Euler, Bernoulli), linear stretch
and twist, and consistent masses (Przemieniecki 1968, Theory of Matrix Structural Analysis,
chapters 5 and 11).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.bodies.finite_elements.model import (
    FiniteElements,
    GeometricStiffness,
    Sparse,
    all_rows,
)

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class BeamElement:
    """Stiffness and mass of the section of a member.

    Parameters
    ----------
    axial, torsion
        E A [N] and G J [N m²].
    bending
        E I for deflections along the y and z axes of the section [N m²].
    mass, polar
        Mass [kg/m] and inertia about the axis [kg m] over the length.
    """

    axial: float
    torsion: float
    bending: tuple[float, float]
    mass: float
    polar: float

    def matrices(self, length: float) -> tuple[Array, Array]:
        """Return stiffness and mass of an element along x, shape (12, 12) each."""
        stiffness, mass = np.zeros((12, 12)), np.zeros((12, 12))
        for row, stiff, inertia in ((0, self.axial, self.mass), (3, self.torsion, self.polar)):
            own = np.ix_((row, row + 6), (row, row + 6))
            stiffness[own] += stiff / length * np.array([[1.0, -1.0], [-1.0, 1.0]])
            mass[own] += inertia * length / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
        for (row, turn, sign), stiff in zip(((1, 5, 1.0), (2, 4, -1.0)), self.bending, strict=True):
            own = np.ix_(*2 * ((row, turn, row + 6, turn + 6),))
            # Rotations are measured as slopes times the length, about y with the other sign.
            scale = np.diag([1.0, sign * length, 1.0, sign * length])
            stiffness[own] += stiff / length**3 * scale @ _BENT @ scale
            mass[own] += self.mass * length / 420.0 * scale @ _HEAVY @ scale
        return stiffness, mass

    def geometric(self, length: float) -> Array:
        """Return the stiffness of an element along x by a unit axial force, shape (12, 12).

        N ∫ (v'² + w'² + ϑ'² I_p/A) dx with the shapes of the element (Przemieniecki 1968, chapter
        15), which twist adds to by the lever that its fibres have.
        """
        found = np.zeros((12, 12))
        for row, turn, sign in ((1, 5, 1.0), (2, 4, -1.0)):
            own = np.ix_(*2 * ((row, turn, row + 6, turn + 6),))
            scale = np.diag([1.0, sign * length, 1.0, sign * length])
            found[own] += scale @ _PULLED @ scale / (30.0 * length)
        own = np.ix_((3, 9), (3, 9))
        found[own] += self.polar / self.mass / length * np.array([[1.0, -1.0], [-1.0, 1.0]])
        return found


@dataclass(frozen=True)
class Member:
    """An element between two nodes, by their numbers from 1.

    ``upwards`` is a direction in the plane of the x and z axes of its section.
    """

    first: int
    second: int
    element: BeamElement
    upwards: Sequence[float] = (0.0, 0.0, 1.0)


def beam_frame(
    source: str, places: Sequence[Sequence[float]], members: Sequence[Member]
) -> FiniteElements:
    """Return the model of a frame.

    Parameters
    ----------
    source
        What messages call it.
    places
        Where its nodes 1, 2, ... are, shape (n, 3) [m].
    members
        Its elements.

    Raises
    ------
    InputError
        If a node has no element, so that nothing holds it.
    """
    at = np.asarray(places, dtype=float)
    numbers = np.arange(1, len(at) + 1)
    placed = _placed(at, members)
    parts = zip(*(m.element.matrices(length) for m, (length, _, _) in placed), strict=True)
    stiffness, mass = (_assembled(placed, part, len(at)) for part in parts)
    return FiniteElements(source, numbers, at, all_rows(numbers, 6 * len(at)), mass, stiffness)


def stiffened(
    model: FiniteElements, members: Sequence[Member], held: int = 0, forces: Sequence[int] = ()
) -> FiniteElements:
    """Return a frame with the geometric stiffness that axial forces in its members give it.

    Parameters
    ----------
    model, members
        A frame that :func:`beam_frame` made, and its elements.
    held
        Node that will hold the body as its reference, 0 for none.
    forces
        Nodes at which others will take hold of it: its interfaces, and nodes with a frame.
    """
    placed = _placed(model.places, members)
    pulls = np.array([m.element.axial / length for m, (length, _, _) in placed])
    units = [m.element.geometric(length) for m, (length, _, _) in placed]

    def by(loads: Array) -> list[Sparse]:
        moved = _supported(model, loads, held)
        found = []
        for column in moved.T:
            own = [
                pull * float(turn[0, :3] @ (column[at[6:9]] - column[at[:3]]))
                for pull, (_, (_, turn, at)) in zip(pulls, placed, strict=True)
            ]
            parts = [n * unit for n, unit in zip(own, units, strict=True)]
            found.append(_assembled(placed, parts, len(model.places)))
        return found

    axes, rows = "xyz", model.translations
    pushed = [model.mass[:, rows[:, a]] @ np.ones(len(rows)) for a in range(3)]
    names = [f"acceleration_{axis}" for axis in axes]
    for i, along in enumerate(axes):
        for j, axis in enumerate(axes):
            names.append(f"inertia_{along}_{axis}")
            pushed.append(model.mass[:, rows[:, j]] @ model.places[:, i])
    loads = [-column for column in pushed]
    for node in forces:
        for axis, row in zip(axes, rows[model.index[node]], strict=True):
            names.append(f"force_{node}_{axis}")
            loads.append(np.eye(1, len(model.rows), row)[0])
    matrices = dict(zip(names, by(np.column_stack(loads)), strict=True))
    return replace(model, geometric=GeometricStiffness(held, matrices))


Placed: TypeAlias = list[tuple[Member, tuple[float, Array, NDArray[Any]]]]
"""Members with their lengths, the turns of their 12 directions, and their rows."""


def _placed(at: Array, members: Sequence[Member]) -> Placed:
    """Return members with their lengths, the turn of their 12 directions, and rows."""
    found: Placed = []
    for member in members:
        along = at[member.second - 1] - at[member.first - 1]
        length = float(np.linalg.norm(along))
        turn = np.asarray(
            np.kron(np.eye(4), _axes(along / length, np.asarray(member.upwards, dtype=float))),
            dtype=np.float64,
        )
        own = np.concatenate([np.arange(6 * n - 6, 6 * n) for n in (member.first, member.second)])
        found.append((member, (length, np.asarray(turn), own)))
    return found


def _assembled(placed: Placed, parts: Sequence[Array], count: int) -> Sparse:
    """Return the matrix of a frame of ``count`` nodes from those of its elements."""
    from scipy.sparse import coo_matrix

    rows = np.concatenate([np.repeat(own, 12) for _, (_, _, own) in placed])
    columns = np.concatenate([np.tile(own, 12) for _, (_, _, own) in placed])
    turned = [
        (turn.T @ part @ turn).ravel()
        for (_, (_, turn, _)), part in zip(placed, parts, strict=True)
    ]
    found = coo_matrix((np.concatenate(turned), (rows, columns)), shape=(6 * count,) * 2).tocsr()
    return 0.5 * (found + found.T)


def _supported(model: FiniteElements, loads: Array, held: int) -> Array:
    """Return displacements under loads, held at a node or balanced by inertia, as the loads."""
    from scipy.sparse import bmat
    from scipy.sparse.linalg import splu

    if held:
        gone = [row for (node, _), row in model.row_of.items() if node == held]
        kept = np.setdiff1d(np.arange(len(model.rows)), gone)
        found = np.zeros_like(loads)
        found[kept] = splu(model.stiffness[kept][:, kept].tocsc()).solve(loads[kept])
        return found
    border = model.mass @ model.rigid
    whole = bmat([[model.stiffness, border], [border.T, None]]).tocsc()
    solved = splu(whole).solve(np.vstack([loads, np.zeros((6, loads.shape[1]))]))
    return np.asarray(solved[: len(loads)])


def _axes(along: Array, upwards: Array) -> Array:
    """Return the axes of a member as rows."""
    across = np.cross(upwards, along)
    across /= np.linalg.norm(across)
    return np.array([along, across, np.cross(along, across)])


_BENT = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]], dtype=float)
_HEAVY = np.array(
    [[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]], dtype=float
)
_PULLED = np.array(
    [[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]], dtype=float
)
