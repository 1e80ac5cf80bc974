"""Functions through known values and gradients at some points, with lengths that suit them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_LENGTHS = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Lengths over which a function may keep its shape, as parts of the variables' ranges."""

_SHORTEST, _LONGEST = 0.1, 8.0
_MOST_OWN = 10
"""Variables up to which each has its own length."""

_LIKELIER = 0.1
"""By which the logarithm of the likelihood must rise for another length."""

_NUGGET = 1e-10
"""Added to the diagonal of the covariances, so that points close to each other do no harm."""

_SAME = 1e-14


class Interpolant:
    """A quadratic at the first point, and a Gaussian process of what other points differ by.

    At the first point, the centre, values and gradients are exact; elsewhere they are the most
    likely ones of a process with covariance exp(-r²/2) of values, r the distance in lengths. These
    are chosen by likelihood, at first one for all variables, then for one after the other.

    Parameters
    ----------
    points
        Shape (k, n), the centre first.
    values
        Of s functions, shape (k, s).
    slopes
        Their gradients, shape (k, s, n).
    bends
        Estimates of their second derivatives at the centre, shape (s, n, n); zero if None.

    References
    ----------
    Rasmussen, Williams (2006), Gaussian Processes for Machine Learning, sections 2.2, 5.4 and 9.4.
    """

    def __init__(
        self, points: Floats, values: Floats, slopes: Floats, bends: Floats | None = None
    ) -> None:
        self._points, self._centre = points, points[0]
        self._base = values[0], slopes[0], bends
        self._weights: Floats | None = None
        ahead = [self._quadratic(point) for point in points]
        rest = np.concatenate(
            [
                (values - np.array([value for value, _ in ahead]))[:, None, :],
                (slopes - np.array([slope for _, slope in ahead])).transpose(0, 2, 1),
            ],
            axis=1,
        )
        if np.max(np.abs(rest)) <= _SAME * max(1.0, float(np.max(np.abs(values)))):
            return
        self._lengths = _likeliest(points, _shortened(rest))
        scaled = _in_lengths(rest, self._lengths)
        self._weights = _solved(points, self._lengths, scaled)[1]
        self._moved = self._process(self._centre)

    def _quadratic(self, x: Floats) -> tuple[Floats, Floats]:
        """Return values (s,) and gradients (s, n) of the function around the centre."""
        (value, slope, bends), step = self._base, x - self._centre
        if bends is None:
            return value + slope @ step, slope
        return value + slope @ step + 0.5 * (bends @ step) @ step, slope + bends @ step

    def _process(self, x: Floats) -> tuple[Floats, Floats]:
        """Return the mean of the process, values (s,) and gradients (s, n)."""
        assert self._weights is not None
        rows = _covariance(x[None], self._points, self._lengths) @ self._weights
        return rows[0], (rows[1:] / self._lengths[:, None]).T

    def __call__(self, x: Floats) -> tuple[Floats, Floats]:
        """Return values (s,) and gradients (s, n) at a point (n,)."""
        value, slope = self._quadratic(x)
        if self._weights is None:
            return value, slope
        (more, leaning), (known, known_slope) = self._process(x), self._moved
        straight = known + known_slope @ (x - self._centre)
        return value + more - straight, slope + leaning - known_slope


def _shortened(rest: Floats) -> Floats:
    """Return fewer columns with the same products of rows, for the likelihood of many functions."""
    k, width, s = rest.shape
    if s <= k * width:
        return rest
    triangle = np.asarray(np.linalg.qr(rest.reshape(k * width, s).T, mode="r"), dtype=float)
    return triangle.T.reshape(k, width, -1)


def _in_lengths(rest: Floats, lengths: Floats) -> Floats:
    """Return values and gradients by lengths, shape (k (1 + n), s)."""
    scaled = rest * np.concatenate([[1.0], lengths])[None, :, None]
    return np.asarray(scaled.reshape(-1, rest.shape[2]))


def _solved(points: Floats, lengths: Floats, data: Floats) -> tuple[float, Floats]:
    """Return half the logarithm of the covariances' determinant, and their inverse times data."""
    from scipy.linalg import cho_factor, cho_solve

    covariances = _covariance(points, points, lengths)
    covariances[np.diag_indices_from(covariances)] += _NUGGET
    factor = cho_factor(covariances, lower=True)
    return float(np.log(np.diag(factor[0])).sum()), np.asarray(cho_solve(factor, data))


def _likelihood(points: Floats, lengths: Floats, rest: Floats) -> float:
    """Return the logarithm of the likelihood, but for a constant, at the likeliest variance."""
    data = _in_lengths(rest, lengths)
    try:
        spread, solved = _solved(points, lengths, data)
    except np.linalg.LinAlgError:
        return -np.inf
    variance = float(np.sum(data * solved)) / len(data)
    fit = -0.5 * len(data) * np.log(max(variance, 1e-300))
    return float(fit - spread + len(points) * np.log(lengths).sum())


def _likeliest(points: Floats, rest: Floats) -> Floats:
    """Return the likeliest lengths (n,)."""
    n = points.shape[1]
    tried = [np.full(n, length) for length in _LENGTHS]
    best, lengths = max(
        ((_likelihood(points, item, rest), item) for item in tried), key=lambda pair: pair[0]
    )
    if n > _MOST_OWN or len(points) < 3:
        return lengths
    for k in (*range(n), *range(n)):
        for factor in (0.5, 2.0):
            moved = lengths.copy()
            moved[k] = np.clip(factor * moved[k], _SHORTEST, _LONGEST)
            found = _likelihood(points, moved, rest)
            if found > best + _LIKELIER:
                best, lengths = found, moved
    return lengths


def _covariance(left: Floats, right: Floats, lengths: Floats) -> Floats:
    """Return covariances of values and gradients by lengths, shape (a (1 + n), b (1 + n))."""
    (a, n), b = left.shape, len(right)
    apart = (left[:, None] - right[None]) / lengths
    own = np.exp(-0.5 * np.sum(apart**2, axis=2))
    found = np.empty((a, 1 + n, b, 1 + n))
    found[:, 0, :, 0] = own
    found[:, 0, :, 1:] = own[:, :, None] * apart
    found[:, 1:, :, 0] = -(own[:, :, None] * apart).transpose(0, 2, 1)
    products = np.eye(n) - apart[:, :, :, None] * apart[:, :, None, :]
    found[:, 1:, :, 1:] = (own[:, :, None, None] * products).transpose(0, 2, 1, 3)
    return found.reshape(a * (1 + n), b * (1 + n))
