"""Cubics fitted to many small sets of points at once."""

from __future__ import annotations

import numpy as np

from vehicledyn.rail.profiles.profile_pieces import Floats

_DEPENDENT = 1e-12
"""Length of a column beside the others below which its coefficient is taken as zero [1]."""


def powers(places: Floats) -> Floats:
    """Return 1, x, x² and x³ of places, shape (..., 4)."""
    square = places * places
    return np.stack([np.ones_like(places), places, square, square * places], axis=-1)


def fit_cubics(places: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Return the coefficients of least-squares cubics and what they leave of the values.

    Gram and Schmidt's way, for all sets at once: a library factorises one small matrix after the
    other, which takes ten times as long.

    Parameters
    ----------
    places
        Arguments of order one, shape (n_sets, n_points) [1].
    values
        Values there, shape (n_sets, n_points, n_columns).

    Returns
    -------
    tuple of arrays
        Coefficients of 1, x, x² and x³, shape (n_sets, 4, n_columns), and residuals, shape
        (n_sets, n_points, n_columns).
    """
    # Sets along the last axis, over which NumPy is quick.
    x, rest = np.ascontiguousarray(places.T), np.ascontiguousarray(values.transpose(2, 1, 0))
    square = x * x
    columns = [np.ones_like(x), x, square, square * x]
    lengths: list[Floats] = []
    above: dict[tuple[int, int], Floats] = {}
    found: list[Floats] = []
    for k in range(4):
        length = np.sqrt((columns[k] * columns[k]).sum(axis=0))
        independent = length > _DEPENDENT
        lengths.append(np.where(independent, length, 1.0))
        column = columns[k] * np.where(independent, 1.0 / lengths[k], 0.0)
        for later in range(k + 1, 4):
            above[k, later] = (column * columns[later]).sum(axis=0)
            columns[later] = columns[later] - above[k, later] * column
        found.append((column * rest).sum(axis=1))
        rest -= column * found[k][:, None, :]
    for k in (3, 2, 1, 0):
        for later in range(k + 1, 4):
            found[k] = found[k] - above[k, later] * found[later]
        found[k] = found[k] / lengths[k]
    return np.stack(found).transpose(2, 0, 1), rest.transpose(2, 1, 0)
