"""Straight frames of beam elements with 12 displacements, as matrices for tests."""

import numpy as np

from vehicledyn.multibody.bodies.finite_elements.model import FiniteElements, all_rows


def element(length, *, axial, torsion, bending, mass, polar):
    """Return stiffness and consistent mass of an Euler-Bernoulli element along x.

    ``bending`` is E I along y and z, ``mass`` and ``polar`` are over the length.
    """
    k, m = np.zeros((12, 12)), np.zeros((12, 12))
    for row, stiff, inertia in ((0, axial, mass), (3, torsion, polar)):
        own = np.ix_((row, row + 6), (row, row + 6))
        k[own] += stiff / length * np.array([[1, -1], [-1, 1]])
        m[own] += inertia * length / 6 * np.array([[2, 1], [1, 2]])
    h = length
    bend = np.array([[12, 6*h, -12, 6*h], [6*h, 4*h*h, -6*h, 2*h*h],
                     [-12, -6*h, 12, -6*h], [6*h, 2*h*h, -6*h, 4*h*h]])  # fmt: skip
    heavy = np.array([[156, 22*h, 54, -13*h], [22*h, 4*h*h, 13*h, -3*h*h],
                      [54, 13*h, 156, -22*h], [-13*h, -3*h*h, -22*h, 4*h*h]])  # fmt: skip
    for (row, turn, sign), stiff in zip(((1, 5, 1.0), (2, 4, -1.0)), bending, strict=True):
        rows = (row, turn, row + 6, turn + 6)
        signs = np.diag([1.0, sign, 1.0, sign])
        k[np.ix_(rows, rows)] += stiff / h**3 * signs @ bend @ signs
        m[np.ix_(rows, rows)] += mass * h / 420 * signs @ heavy @ signs
    return k, m


def assembled(places, members, given, *, source="frame"):
    """Return the model of members between nodes; ``members`` are (first, second, up)."""
    places = np.asarray(places, dtype=float)
    numbers = np.arange(1, len(places) + 1)
    size = 6 * len(places)
    k, m = np.zeros((size, size)), np.zeros((size, size))
    for a, b, up in members:
        x = places[b] - places[a]
        length = np.linalg.norm(x)
        x = x / length
        y = np.cross(up, x) / np.linalg.norm(np.cross(up, x))
        turn = np.kron(np.eye(4), np.array([x, y, np.cross(x, y)]))
        own_k, own_m = element(length, **given)
        rows = np.r_[6 * a : 6 * a + 6, 6 * b : 6 * b + 6]
        k[np.ix_(rows, rows)] += turn.T @ own_k @ turn
        m[np.ix_(rows, rows)] += turn.T @ own_m @ turn
    return FiniteElements(source, numbers, places, all_rows(numbers, size), m, k)


def straight(length, count, given):
    """Return a beam along x, its nodes numbered from 1 to ``count`` + 1."""
    places = np.zeros((count + 1, 3))
    places[:, 0] = np.linspace(0.0, length, count + 1)
    members = [(j, j + 1, (0.0, 0.0, 1.0)) for j in range(count)]
    return assembled(places, members, given, source="beam")


def lattice(counts, pitch, *, mass=0.3, stiffness=4e5):
    """Return a block of nodes with three displacements each, joined by bars along edges and across.

    ``counts`` are the nodes along x, y and z; each weighs ``mass``.
    """
    grid = np.array([(i, j, k) for i in range(counts[0]) for j in range(counts[1])
                     for k in range(counts[2])], dtype=float)  # fmt: skip
    places = pitch * grid
    size = 3 * len(places)
    k = np.zeros((size, size))
    for a in range(len(grid)):
        for b in range(a + 1, len(grid)):
            if np.abs(grid[a] - grid[b]).max() <= 1.0:
                axis = (places[b] - places[a]) / np.linalg.norm(places[b] - places[a])
                bar = stiffness * np.outer(axis, axis)
                own, other = (np.arange(3 * node, 3 * node + 3) for node in (a, b))
                for first, second, sign in ((own, own, 1), (other, other, 1), (own, other, -1),
                                            (other, own, -1)):  # fmt: skip
                    k[np.ix_(first, second)] += sign * bar
    numbers = np.arange(1, len(grid) + 1)
    return FiniteElements("block", numbers, places, all_rows(numbers, size), mass * np.eye(size), k)
