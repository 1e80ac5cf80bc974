"""Sobol indices of figures from samples, with their standard errors.

Saltelli et al. (2010), Computer Physics Communications 181, 259-270, table 2, (b) and (f); points
and indices are those of ``scipy.stats.sobol_indices``, which knows neither standard errors that
repeat nor runs that fail. The sequence is scipy's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.uncertainty import Distribution, Shares

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class SobolSamples:
    """Figures at two independent samples, and at the first with one parameter of the second.

    ``one`` and ``other`` are (number, m), ``mixed`` (n, number, m).
    """

    one: Floats
    other: Floats
    mixed: Floats

    @property
    def independent(self) -> Floats:
        """Figures of all points that do not depend on each other, shape (2 number, m)."""
        return np.concatenate([self.one, self.other])

    def complete(self) -> SobolSamples:
        """Return those of the points all of whose figures are numbers."""
        every = np.concatenate([self.one[None], self.other[None], self.mixed])
        kept = np.isfinite(every).all(axis=(0, 2))
        return SobolSamples(self.one[kept], self.other[kept], self.mixed[:, kept])

    def shares(self) -> Shares:
        """Return first-order and total indices.

        Both are means by the variance, whose standard error is that of the sum of their
        influences point by point (delta method); with points of a sequence an upper bound where
        they are many.
        """
        number = len(self.one)
        middle = self.independent.mean(axis=0)
        one, other, mixed = self.one - middle, self.other - middle, self.mixed - middle
        squares = 0.5 * (one**2 + other**2)
        variance = squares.mean(axis=0) - np.mean([one, other], axis=(0, 1)) ** 2

        def share(parts: Floats) -> tuple[Floats, Floats]:
            """Return the mean of parts (n, number, m) by the variance, and its error, (m, n)."""
            whole = np.where(variance > 0.0, variance, np.inf)
            found = parts.mean(axis=1) / whole
            influence = (parts - found[:, None] * squares) / whole
            return found.T, (influence.std(axis=1, ddof=1) / np.sqrt(number)).T

        first, first_error = share(other * (mixed - one))
        total, total_error = share(0.5 * (one - mixed) ** 2)
        return Shares(first, total, first_error, total_error)


def sobol_samples(
    function: Callable[[Floats], Floats], laws: Sequence[Distribution], number: int, seed: int
) -> SobolSamples:
    """Return figures at points of a scrambled Sobol sequence that Sobol indices need.

    Parameters
    ----------
    function
        Returns figures (number, m) of points (number, n); it gets number (n + 2) points in all.
    laws
        Distributions of the n parameters.
    number
        Points of each sample, a power of two.
    seed
        Equal seeds give equal points.
    """
    from scipy.stats import qmc

    n = len(laws)
    shares = qmc.Sobol(2 * n, bits=64, rng=np.random.default_rng(seed)).random(number)
    columns = [laws[k % n].law.ppf(shares[:, k]) for k in range(2 * n)]
    one, other = np.stack(columns[:n], axis=1), np.stack(columns[n:], axis=1)
    mixed = np.repeat(one[None], n, axis=0)
    for k in range(n):
        mixed[k, :, k] = other[:, k]
    found = [function(points) for points in (one, other, mixed.reshape(-1, n))]
    return SobolSamples(found[0], found[1], found[2].reshape(n, number, -1))
