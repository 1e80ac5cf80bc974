"""How uncertain parameters make figures uncertain: samples and derivatives.

Distributions and low-discrepancy sequences are scipy's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Distribution:
    """A distribution of scipy.stats, frozen; ``mean`` and ``deviation`` in SI.

    ``pieces`` are the ends of intervals within which its density is a line; none of a normal one.
    """

    law: Any
    pieces: tuple[float, ...] = ()

    @property
    def mean(self) -> float:
        """Expected value."""
        return float(self.law.mean())

    @property
    def deviation(self) -> float:
        """Standard deviation."""
        return float(self.law.std())

    def quadrature(self, order: int) -> tuple[Floats, Floats]:
        """Return nodes and weights of expected values, exact for polynomials up to an order."""
        number = order // 2 + 2
        if not self.pieces:
            nodes, weights = np.polynomial.hermite_e.hermegauss(number)
            return self.mean + self.deviation * nodes, weights / weights.sum()
        nodes, weights = np.polynomial.legendre.leggauss(number)
        ends = np.unique(self.pieces)
        half = 0.5 * np.diff(ends)[:, None]
        places = (ends[:-1, None] + half * (1.0 + nodes)).ravel()
        weights = (half * weights).ravel() * self.law.pdf(places)
        return places, weights / weights.sum()

    def moments(self) -> tuple[float, float]:
        """Return the third and fourth central moments."""
        nodes, weights = self.quadrature(4)
        away = nodes - self.mean
        return float(weights @ away**3), float(weights @ away**4)


def normal(mean: float, deviation: float) -> Distribution:
    """Return a normal distribution."""
    from scipy.stats import norm

    return Distribution(norm(mean, deviation))


def uniform(low: float, high: float) -> Distribution:
    """Return an even distribution between two values."""
    from scipy.stats import uniform as law

    return Distribution(law(low, high - low), (low, high))


def triangular(low: float, mode: float, high: float) -> Distribution:
    """Return a triangular distribution with its peak at a value."""
    from scipy.stats import triang

    law = triang((mode - low) / (high - low), low, high - low)
    return Distribution(law, (low, mode, high))


@dataclass(frozen=True)
class Spread:
    """Mean and standard deviation of figures (m,), with the standard errors of both."""

    mean: Floats
    deviation: Floats
    mean_error: Floats
    deviation_error: Floats


@dataclass(frozen=True)
class Shares:
    """Parts of the variance of figures that parameters bring, each (m, n), with standard errors.

    ``first`` are those of a parameter alone, ``total`` those with its interactions.
    """

    first: Floats
    total: Floats
    first_error: Floats
    total_error: Floats


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


def second_order(
    values: Floats, slopes: Floats, curvatures: Floats, laws: Sequence[Distribution]
) -> tuple[Spread, Floats, Floats]:
    """Return spread, first-order and total shares of figures that are quadratic in parameters.

    With f = f0 + g d + d H d / 2, d = p - E p, independent of each other, and the central moments
    σ², μ₃, μ₄ the mean is f0 + Σ Hₖₖ σₖ² / 2, and the variance the sum of gₖ² σₖ² + gₖ Hₖₖ μ₃ₖ +
    Hₖₖ² (μ₄ₖ - σₖ⁴) / 4 by parameter and Hₖₗ² σₖ² σₗ² by pair.

    Parameters
    ----------
    values, slopes, laws
        As for :func:`first_order`.
    curvatures
        Second derivatives, shape (m, n, n).
    """
    variance = np.array([law.deviation for law in laws]) ** 2
    third, fourth = np.array([law.moments() for law in laws]).T
    own = np.einsum("mkk->mk", curvatures)
    alone = slopes**2 * variance + slopes * own * third + 0.25 * own**2 * (fourth - variance**2)
    pairs = curvatures**2 * np.outer(variance, variance)
    mixed = pairs.sum(axis=2) - np.einsum("mkk->mk", pairs)
    whole = alone.sum(axis=1) + 0.5 * mixed.sum(axis=1)
    zero, parts = np.zeros(len(values)), np.where(whole > 0.0, whole, 1.0)[:, None]
    mean = values + 0.5 * own @ variance
    found = Spread(mean, np.sqrt(np.maximum(whole, 0.0)), zero, zero)
    return found, alone / parts, (alone + mixed) / parts


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
    """Return the share of samples beyond a limit and its 95 % interval (Wilson's).

    Samples that are not a number may be on either side: the interval holds both.
    """
    from scipy.stats import binomtest

    count = int(np.sum(figures > limit if above else figures < limit))
    unknown = int(np.sum(np.isnan(figures)))
    low, high = (
        binomtest(number, len(figures)).proportion_ci(method="wilson")
        for number in (count, count + unknown)
    )
    return count / (len(figures) - unknown), float(low.low), float(high.high)
