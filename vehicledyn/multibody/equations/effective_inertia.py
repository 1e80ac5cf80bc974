"""Effective inertia at each joint of an open tree, in a time that grows with the number of links.

What a link carries is kept as rows S with kinetic energy ½ |S v|² of its motion v = (ω, velocity).
A free joint with the unit motion s and the reflected inertia I feels √(|S s|² + I); beyond it, seen
from its parent, S without its part along S s is left, and of that part what I keeps. So roots of
inertias are compared, not inertias, and a share of 1e-8 is still above rounding. This is the
recursion of :mod:`vehicledyn.multibody.recursion.articulated_body` in square-root form (Bierman
(1977), Factorization Methods for Discrete Sequential Estimation).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_WIDTH = 6
_NONE = np.zeros((0, _WIDTH))


@dataclass(frozen=True)
class LinkNumbers:
    """A link in numbers.

    ``rotation`` leads from its axes to those of its parent, ``arm`` [m] to its origin, in the
    parent's axes; ``motion`` is the unit motion (ω, v) of its free joint in its axes, if it has
    one, and ``reflected`` the inertia that its coordinate alone feels [kg, kg m²].
    """

    parent: int
    rotation: Array
    arm: Array
    motion: Array | None
    reflected: float = 0.0


def body_rows(mass: float, com: Array, inertia: Array) -> Array:
    """Return the rows S of a body about the origin of its axes, shape (6, 6).

    Parameters
    ----------
    mass
        Mass [kg].
    com, inertia
        Centre of mass [m], and the matrix about it, shape (3, 3) [kg m²].
    """
    sizes, axes = np.linalg.eigh(inertia)
    rows = np.zeros((_WIDTH, _WIDTH))
    rows[:3, :3] = np.sqrt(np.maximum(sizes, 0.0))[:, None] * axes.T
    root = np.sqrt(max(mass, 0.0))
    rows[3:, :3], rows[3:, 3:] = -root * _skew(com), root * np.eye(3)
    return rows


def smallest_share(links: Sequence[LinkNumbers], bodies: Mapping[int, Array]) -> float:
    """Return the least inertia of a free joint with the joints beyond free, over that with none.

    It is a share of roots of inertias; infinite for a tree without free joints, zero where a
    joint carries no inertia at all. Negative reflected inertias are left out, see
    :func:`first_negative`.

    Parameters
    ----------
    links
        The tree, parents first.
    bodies
        Rows of the bodies, see :func:`body_rows`, by the index of their link.
    """
    gathered: list[list[Array]] = [[bodies.get(k, _NONE)] for k in range(len(links))]
    whole: list[list[Array]] = [[bodies.get(k, _NONE)] for k in range(len(links))]
    smallest = np.inf
    for k in reversed(range(len(links))):
        item = links[k]
        rows, all_rows = _compressed(gathered[k]), _compressed(whole[k])
        if item.motion is not None:
            column, own = rows @ item.motion, np.sqrt(max(item.reflected, 0.0))
            bodies_size = float(np.linalg.norm(column))
            size = float(np.hypot(bodies_size, own))
            most = float(np.hypot(np.linalg.norm(all_rows @ item.motion), own))
            if size == 0.0 or not np.isfinite(most):
                return 0.0
            smallest = min(smallest, size / most)
            if bodies_size > 0.0:
                lost = (1.0 - own / size) / bodies_size**2
                rows = rows - lost * np.outer(column, column @ rows)
        if item.parent >= 0:
            carried = _carried(item)
            gathered[item.parent].append(rows @ carried)
            whole[item.parent].append(all_rows @ carried)
    return smallest


def first_negative(links: Sequence[LinkNumbers], bodies: Mapping[int, Array]) -> int | None:
    """Return the first link, from the leaves, whose free joint feels no positive inertia.

    Reflected inertias may be negative; None says that the mass matrix is positive definite, for
    what the joints feel, those beyond free, are the pivots of its factorisation. Parameters are
    those of :func:`smallest_share`.
    """
    gathered = [rows.T @ rows for rows in (bodies.get(k, _NONE) for k in range(len(links)))]
    for k in reversed(range(len(links))):
        item, inertia = links[k], gathered[k]
        if item.motion is not None:
            column = inertia @ item.motion
            size = float(item.motion @ column) + item.reflected
            if not size > 0.0:
                return k
            inertia = inertia - np.outer(column, column) / size
        if item.parent >= 0:
            carried = _carried(item)
            gathered[item.parent] = gathered[item.parent] + carried.T @ inertia @ carried
    return None


def _compressed(parts: list[Array]) -> Array:
    """Return at most six rows with the same energy as all of these."""
    rows = np.vstack(parts)
    return rows if len(rows) <= _WIDTH else np.asarray(np.linalg.qr(rows, mode="r"))


def _carried(item: LinkNumbers) -> Array:
    """Return what the motion of the parent gives the link, its joint at rest."""
    back = item.rotation.T
    found = np.zeros((_WIDTH, _WIDTH))
    found[:3, :3] = found[3:, 3:] = back
    found[3:, :3] = -back @ _skew(item.arm)
    return found


def _skew(v: Array) -> Array:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
