"""Derivatives of numbers drawn from sampled channels: extremes, means, integrals, any function."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_FACTOR = re.compile(r"([A-Za-z%°]+)(?:\^(-?\d+))?")

_TIE = 1e-12
"""Part of a channel's range within which two samples far apart are equally extreme."""

_STEPS = 1e-3, 1e-4, 1e-5
"""Parts of a channel's range by which samples are moved to see how a function of them changes: the
first at which its differences agree, since larger ones feel rounding less."""

_AGREES = 1e-11
"""Part of a derivative within which two of Richardson's differences agree."""

_ROUNDING = 1e-15
"""Part of a function that rounding makes of it."""

_CORNER = 1e-3
"""Part of a derivative by which those to both sides may differ, where they do not come closer."""


@dataclass(frozen=True)
class FigureSlope:
    """A key figure, and its derivatives (n_directions,); ``trouble`` says why there are none.

    ``time`` is where an extreme lies [s], not a number for others.
    """

    value: float
    slope: Floats
    trouble: str = ""
    time: float = np.nan


def figure_slope(
    kind: str, time: Floats, values: Floats, slopes: Floats, end: Floats | None = None
) -> FigureSlope:
    """Return one of :data:`KINDS` of a channel.

    Parameters
    ----------
    kind
        Name of the figure.
    time, values
        Samples, shape (n_times,).
    slopes
        Their derivatives, shape (n_times, n_directions).
    end
        How the time of the last sample moves, shape (n_directions,); not at all if None.
    """
    end = np.zeros(slopes.shape[1]) if end is None else end
    with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is reported
        found = KINDS[kind](time, values, slopes, end)
    if found.trouble or (np.isfinite(found.value) and np.isfinite(found.slope).all()):
        return found
    lost = np.flatnonzero(~(np.isfinite(values) & np.isfinite(slopes).all(axis=1)))
    return replace(found, trouble=f"it is not finite at {time[lost[0]] if lost.size else 0.0:g} s")


def unit_of(kind: str, unit: str) -> str:
    """Return the unit of a figure of a channel.

    >>> unit_of("integral", "m"), unit_of("mean_square", "m/s"), unit_of("max", "N")
    ('m*s', 'm^2/s^2', 'N')
    """
    if kind == "integral":
        return f"{unit}*s"
    if kind == "mean_square":
        return _FACTOR.sub(lambda found: f"{found[1]}^{2 * int(found[2] or 1)}", unit)
    return unit


def _extreme(time: Floats, values: Floats, slopes: Floats, ranks: Floats) -> FigureSlope:
    """Return the sample of highest rank; its instant adds nothing, there the rate is zero."""
    place = int(np.argmax(ranks))
    ties = np.flatnonzero(ranks >= ranks[place] - _TIE * np.ptp(ranks))
    trouble, apart = "", ties[np.abs(ties - place) > 1]
    scale = np.max(np.abs(slopes), axis=0, initial=0.0)
    differ = [k for k in apart if np.any(np.abs(slopes[k] - slopes[place]) > _CORNER * scale)]
    if differ and np.ptp(ranks) > 0.0:
        trouble = f"it is as extreme at {time[place]:g} s as at {time[differ[0]]:g} s"
    return FigureSlope(float(values[place]), slopes[place], trouble, float(time[place]))


def _integral(time: Floats, values: Floats, slopes: Floats, end: Floats) -> FigureSlope:
    sums = np.asarray(np.trapezoid(slopes, time, axis=0), dtype=float)
    return FigureSlope(float(np.trapezoid(values, time)), sums + np.mean(values[-2:]) * end)


def _mean(time: Floats, values: Floats, slopes: Floats, end: Floats) -> FigureSlope:
    span, whole = time[-1] - time[0], _integral(time, values, slopes, end)
    mean = whole.value / span
    return FigureSlope(mean, np.asarray((whole.slope - mean * end) / span))


def _square(time: Floats, values: Floats, slopes: Floats, end: Floats) -> FigureSlope:
    return _mean(time, values**2, 2.0 * values[:, None] * slopes, end)


def _mean_square(time: Floats, values: Floats, slopes: Floats, end: Floats) -> FigureSlope:
    square = _square(time, values, slopes, end)
    root = float(np.sqrt(square.value))
    if root == 0.0:
        return FigureSlope(0.0, np.zeros(slopes.shape[1]), "the channel is zero all along")
    return FigureSlope(root, square.slope / (2.0 * root))


KINDS: dict[str, Callable[[Floats, Floats, Floats, Floats], FigureSlope]] = {
    "max": lambda t, y, dy, _: _extreme(t, y, dy, y),
    "min": lambda t, y, dy, _: _extreme(t, y, dy, -y),
    "peak": lambda t, y, dy, _: _extreme(t, np.abs(y), np.sign(y)[:, None] * dy, np.abs(y)),
    "rms": _mean_square,
    "mean": _mean,
    "mean_square": _square,
    "integral": _integral,
    "initial": lambda t, y, dy, _: FigureSlope(float(y[0]), dy[0]),
    "final": lambda t, y, dy, _: FigureSlope(float(y[-1]), dy[-1]),
}
"""Figures by name; the peak is the largest magnitude."""


NOT_LINEAR = ("max", "min", "peak", "rms", "mean_square")
"""Figures that are not linear in their channel."""


def moved_slope(kind: str, time: Floats, values: Floats, tangent: Floats) -> Floats:
    """Return how the derivatives of a figure by the samples change along a tangent of these.

    They do for mean squares m = w . y², with 2 w ẏ, and their roots r, with
    w ẏ / r - w y (w y . ẏ) / r³; other figures are linear in the samples. Shape (n_times,).
    """
    if kind not in ("rms", "mean_square"):
        return np.zeros(len(time))
    own = figure_slope("mean_square", time, values, np.eye(len(time))).slope
    moved = figure_slope("mean_square", time, tangent, np.eye(len(time))).slope
    if kind == "mean_square":
        return moved
    root = figure_slope("rms", time, values, np.zeros((len(time), 0))).value
    if root == 0.0:
        return np.zeros(len(time))
    return np.asarray(0.5 * moved / root - 0.25 * own * float(own @ tangent) / root**3)


def gauss_newton(kind: str, time: Floats, values: Floats, slopes: Floats) -> Floats | None:
    """Return the part of a figure's second derivatives that its channel's first ones make.

    For mean squares m = w . y² it is 2 w . ẏ ẏᵀ, for their roots r (w . ẏ ẏᵀ - r' r'ᵀ) / r; never
    negative along a direction, and all of it where the channel is linear in the parameters.

    Parameters
    ----------
    kind
        Name of the figure.
    time, values
        Samples, shape (n_times,).
    slopes
        Their derivatives, shape (n_times, n_directions).

    Returns
    -------
    Floats | None
        Shape (n_directions, n_directions); none for other figures and channels that are zero.
    """
    if kind not in ("rms", "mean_square"):
        return None
    products = slopes[:, :, None] * slopes[:, None, :]
    mean = np.asarray(np.trapezoid(products, time, axis=0) / (time[-1] - time[0]), dtype=float)
    if kind == "mean_square":
        return 2.0 * mean
    root = figure_slope("rms", time, values, slopes)
    return None if root.trouble else (mean - np.outer(root.slope, root.slope)) / root.value


def sampled_slopes(
    function: Callable[[Floats], dict[str, float]], values: Floats, slopes: Floats
) -> dict[str, FigureSlope]:
    """Return the derivatives of any numbers that a function draws from samples.

    The samples are moved along each direction by a little, to both sides; what they are moved by
    is exact, so nothing is simulated again.

    Parameters
    ----------
    function
        Returns numbers by name for samples of shape (n_times, n_channels).
    values
        The samples.
    slopes
        Their derivatives, shape (n_times, n_channels, n_directions).
    """
    known = function(values)
    n = slopes.shape[2]
    found = {name: np.full(n, np.nan) for name in known}
    troubles = dict.fromkeys(known, "")
    spread = np.maximum(np.ptp(values, axis=0), 1e-9 * np.max(np.abs(values), axis=0, initial=0.0))
    for k in range(n):
        size = np.max(np.abs(slopes[:, :, k]), axis=0)
        if not np.isfinite(size).all():
            troubles = dict.fromkeys(known, "a channel behind it has no finite derivative")
            continue
        if not np.any(size):
            for name in known:
                found[name][k] = 0.0
            continue
        ratios = size[spread > 0.0] / spread[spread > 0.0]
        whole = 1.0 / max(float(np.max(ratios, initial=0.0)), 1e-300)
        errors = dict.fromkeys(known, np.inf)
        for step in (part * whole for part in _STEPS):
            moves = [function(values + h * slopes[:, :, k]) for h in _both_sides(step)]
            for name, middle in known.items():
                if errors[name] == 0.0:
                    continue
                numbers = np.array([item.get(name, np.nan) for item in moves])
                slope, error = _romberg(numbers, step)
                if not error > errors[name]:
                    found[name][k], errors[name] = slope, error
                if _is_corner(numbers, middle, step):
                    errors[name] = np.inf
                    if step == _STEPS[-1] * whole:
                        troubles[name] = "it has a corner here"
                elif error <= _AGREES * abs(slope) + _ROUNDING * abs(middle) / step:
                    errors[name] = 0.0
            if not any(errors.values()):
                break
    return {name: FigureSlope(value, found[name], troubles[name]) for name, value in known.items()}


def _both_sides(step: float) -> list[float]:
    return [side * part * step for part in (1.0, 0.5, 0.25) for side in (1.0, -1.0)]


def _romberg(numbers: Floats, step: float) -> tuple[float, float]:
    """Return a derivative by differences of three sizes, and how far two guesses of it differ."""
    wide, narrow, least = (numbers[::2] - numbers[1::2]) / (step * np.array([2.0, 1.0, 0.5]))
    first, second = (4.0 * narrow - wide) / 3.0, (4.0 * least - narrow) / 3.0
    return float((16.0 * second - first) / 15.0), float(abs(second - first))


def _is_corner(numbers: Floats, middle: float, step: float) -> bool:
    """Return whether differences to both sides stay apart."""
    ahead, behind, near, nearer = numbers[:4]
    bend = abs(ahead - 2.0 * middle + behind) / step
    bend_near = abs(near - 2.0 * middle + nearer) / (step / 2.0)
    floor = max(_CORNER * abs(near - nearer) / step, 1e-9 * abs(middle) / step)
    return bool(not np.isfinite(bend) or (bend_near > floor and bend_near > 0.75 * bend))
