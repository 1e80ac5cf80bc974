"""How uncertain parameters make figures uncertain: samples, first order, Sobol indices.

Distributions, low-discrepancy sequences and the estimators of Sobol indices are scipy's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Distribution:
    """A distribution of scipy.stats, frozen; ``mean`` and ``deviation`` in SI."""

    law: Any

    @property
    def mean(self) -> float:
        """Expected value."""
        return float(self.law.mean())

    @property
    def deviation(self) -> float:
        """Standard deviation."""
        return float(self.law.std())


def normal(mean: float, deviation: float) -> Distribution:
    """Return a normal distribution."""
    from scipy.stats import norm

    return Distribution(norm(mean, deviation))


def uniform(low: float, high: float) -> Distribution:
    """Return an even distribution between two values."""
    from scipy.stats import uniform as law

    return Distribution(law(low, high - low))


def triangular(low: float, mode: float, high: float) -> Distribution:
    """Return a triangular distribution with its peak at a value."""
    from scipy.stats import triang

    return Distribution(triang((mode - low) / (high - low), low, high - low))


@dataclass(frozen=True)
class Spread:
    """Mean and standard deviation of figures (m,), with the standard errors of both."""

    mean: Floats
    deviation: Floats
    mean_error: Floats
    deviation_error: Floats


def first_order(values: Floats, slopes: Floats, laws: Sequence[Distribution]) -> Spread:
    """Return the spread of figures that are linear in independent parameters.

    σ² = Σ (∂f/∂pₖ σₖ)²

    Parameters
    ----------
    values
        Figures at the means of the parameters, shape (m,).
    slopes
        Their derivatives, shape (m, n).
    laws
        Distributions of the n parameters.
    """
    parts = slopes * np.array([law.deviation for law in laws])
    zero = np.zeros(len(values))
    return Spread(values, np.sqrt(np.sum(parts**2, axis=1)), zero, zero)


def first_order_shares(slopes: Floats, laws: Sequence[Distribution]) -> Floats:
    """Return the part of each figure's variance that each parameter brings, shape (m, n)."""
    parts = (slopes * np.array([law.deviation for law in laws])) ** 2
    whole = np.sum(parts, axis=1, keepdims=True)
    found: Floats = np.zeros_like(parts)
    np.divide(parts, whole, out=found, where=whole > 0.0)
    return found


def samples(laws: Sequence[Distribution], number: int, seed: int, *, scrambled: bool) -> Floats:
    """Return points drawn from independent distributions, shape (number, n).

    Parameters
    ----------
    laws
        The distributions.
    number
        How many points; of a sequence best a power of two.
    seed
        Equal seeds give equal points.
    scrambled
        Whether they are those of a scrambled Sobol sequence; else they are independent.
    """
    generator = np.random.default_rng(seed)
    if scrambled:
        import warnings

        from scipy.stats import qmc

        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # numbers that are no power of two serve
            shares = qmc.Sobol(len(laws), rng=generator).random(number)
    else:
        shares = generator.random((number, len(laws)))
    shares = np.clip(shares, 1e-15, 1.0 - 1e-15)
    columns = [law.law.ppf(shares[:, k]) for k, law in enumerate(laws)]
    return np.asarray(np.stack(columns, axis=1), dtype=float)


def spread(figures: Floats) -> Spread:
    """Return the spread of sampled figures, shape (number, m); errors are those of free samples."""
    number = len(figures)
    deviation = np.std(figures, axis=0, ddof=1)
    fourth = np.mean((figures - np.mean(figures, axis=0)) ** 4, axis=0)
    scatter = np.maximum(fourth - deviation**4, 0.0) / number
    error = np.sqrt(scatter) / np.where(deviation > 0.0, 2.0 * deviation, 1.0)
    return Spread(np.mean(figures, axis=0), deviation, deviation / np.sqrt(number), error)


def failing(figures: Floats, limit: float, *, above: bool) -> tuple[float, float, float]:
    """Return the share of samples beyond a limit and its 95 % interval (Wilson's)."""
    from scipy.stats import binomtest

    count = int(np.sum(figures > limit if above else figures < limit))
    interval = binomtest(count, len(figures)).proportion_ci(method="wilson")
    return count / len(figures), float(interval.low), float(interval.high)


def sobol(
    function: Callable[[Floats], Floats], laws: Sequence[Distribution], number: int, seed: int
) -> tuple[Floats, Floats]:
    """Return first-order and total Sobol indices of figures, shapes (m, n).

    Parameters
    ----------
    function
        Returns figures (number, m) of points (number, n); it gets number (n + 2) points in all.
    laws
        Distributions of the n parameters.
    number
        Points of each sample, a power of two.
    seed
        Equal seeds give equal indices.

    References
    ----------
    Saltelli et al. (2010), Computer Physics Communications 181, 259-270.
    """
    from scipy.stats import sobol_indices

    def figures(points: Floats) -> Floats:
        # SciPy drops dimensions of length one, and fails for one figure of one parameter.
        found = function(points.T).T
        return np.concatenate([found, found[:1]])

    found = sobol_indices(
        func=figures,
        n=number,
        dists=[law.law for law in laws],
        rng=np.random.default_rng(seed),
    )
    first, total = (
        np.reshape(indices, (-1, len(laws)))[:-1]
        for indices in (found.first_order, found.total_order)
    )
    return first, total
