"""Finite-element models for tests: frames of beams, and blocks of nodes without rotations."""

import numpy as np

from vehicledyn.multibody.bodies.finite_elements.beam_frames import BeamElement, Member, beam_frame
from vehicledyn.multibody.bodies.finite_elements.model import FiniteElements, all_rows


def assembled(places, members, given):
    """Return a frame of equal members between nodes; ``members`` are (first, second) from 0."""
    element = BeamElement(**given)
    return beam_frame("frame", places, [Member(a + 1, b + 1, element) for a, b in members])


def straight(length, count, given):
    """Return a beam along x, its nodes numbered from 1 to ``count`` + 1."""
    places = np.zeros((count + 1, 3))
    places[:, 0] = np.linspace(0.0, length, count + 1)
    element = BeamElement(**given)
    return beam_frame("beam", places, [Member(k, k + 1, element) for k in range(1, count + 1)])


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
