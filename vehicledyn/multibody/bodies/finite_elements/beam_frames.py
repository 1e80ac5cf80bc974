"""Frames of straight beam elements as finite-element matrices, for where no other program is near.

Elements have two nodes with six directions each, cubic bending (Euler, Bernoulli), linear stretch
and twist, and consistent masses (Przemieniecki 1968, Theory of Matrix Structural Analysis,
chapters 5 and 11).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.bodies.finite_elements.model import FiniteElements, all_rows

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
    from scipy.sparse import coo_matrix

    at = np.asarray(places, dtype=float)
    numbers = np.arange(1, len(at) + 1)
    size = 6 * len(at)
    rows, columns, stiffness, mass = [], [], [], []
    for member in members:
        along = at[member.second - 1] - at[member.first - 1]
        length = float(np.linalg.norm(along))
        turn = np.kron(np.eye(4), _axes(along / length, np.asarray(member.upwards, dtype=float)))
        own = np.concatenate([np.arange(6 * n - 6, 6 * n) for n in (member.first, member.second)])
        k, m = (turn.T @ part @ turn for part in member.element.matrices(length))
        rows.append(np.repeat(own, 12))
        columns.append(np.tile(own, 12))
        stiffness.append(k.ravel())
        mass.append(m.ravel())
    index = np.concatenate(rows), np.concatenate(columns)
    whole = [
        coo_matrix((np.concatenate(part), index), shape=(size, size)).tocsr()
        for part in (mass, stiffness)
    ]
    whole = [0.5 * (part + part.T) for part in whole]
    return FiniteElements(source, numbers, at, all_rows(numbers, size), *whole)


def _axes(along: Array, upwards: Array) -> Array:
    """Return the axes of a member as rows."""
    across = np.cross(upwards, along)
    across /= np.linalg.norm(across)
    return np.array([along, across, np.cross(along, across)])


_BENT = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]], dtype=float)
_HEAVY = np.array(
    [[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]], dtype=float
)
