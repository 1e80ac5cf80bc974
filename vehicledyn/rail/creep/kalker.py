"""Kalker's creep coefficients for any ratio of the contact's axes and any Poisson's ratio.

F_x = -G c² C11 ξ,    F_y = -G (c² C22 η + c³ C23 φ),    M_z = G (c³ C32 η - c⁴ C33 φ),

with c² = a b, C32 = C23. The table covers a/b = 0.1 to 10. A natural cubic spline in
l = ln(a/b) passes through all its entries, and beyond them through Kalker's asymptotes, joined
to the table by factors that fade out; beyond 10⁻⁴ and 10⁴ the logarithms of the asymptotes stay
as they are there. What is splined has no powers of a/b left in it and is a parabola in ν: h/C11,
h/C22, C23 (1 - ν)/(√(a/b) h) and C33 (1 - ν) (a/b)/h, with h = √(1 + (a/b)²).

Against an exact no-slip solution of the half-space, which the tests hold, the table is within
1.3 %, most of it within its rounding, and so is the spline between its entries. For a ≫ b the
moment of spin C33 is a small difference of large moments and less certain.

References
----------
Kalker (1990), Three-Dimensional Elastic Bodies in Rolling Contact, appendix E.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from typing import Any

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

BEYOND = (0.05, 0.015, 1e-3, 1e-4)
"""Ratios of short to long axis at which the spline follows the asymptotes [1]."""

_JOIN = 0.1


@dataclass(frozen=True)
class CreepCoefficients:
    """Kalker's coefficients C11, C22, C23 (and C32, the same) and C33 [1]."""

    longitudinal: Scalar
    lateral: Scalar
    lateral_spin: Scalar
    spin: Scalar


def creep_coefficients(axis_ratio: Scalar, poissons_ratio: Scalar) -> CreepCoefficients:
    """Return the coefficients for a/b, a in the rolling direction, and Poisson's ratio.

    Parameters
    ----------
    axis_ratio
        a/b, positive [1].
    poissons_ratio
        ν between 0 and 0.5 [1]. As a number it costs a third of what it costs as an expression.
    """
    spline = _spline()
    held = ops.minimum(ops.maximum(ops.log(axis_ratio), spline.places[0]), spline.places[-1])
    basis = [held - spline.places[0]]
    for place in spline.places[:-1]:
        over = ops.maximum(held - place, 0.0)
        basis.append(over * over * over)
    f11, f22, f23, f33 = (_at(weights, basis, poissons_ratio) for weights in spline.weights)
    h = ops.sqrt(1.0 + axis_ratio * axis_ratio)
    softer = h / (1.0 - poissons_ratio)
    return CreepCoefficients(
        h / f11, h / f22, f23 * ops.sqrt(axis_ratio) * softer, f33 * softer / axis_ratio
    )


def asymptotes(axis_ratio: float, poissons_ratio: float) -> tuple[float, float, float, float]:
    """Return C11, C22, C23, C33 of a very slender contact, a/b ≪ 1 or a/b ≫ 1.

    That of C33 is from recollection of the source.
    """
    nu = poissons_ratio
    if axis_ratio < 1.0:
        g = axis_ratio
        lateral = math.pi**2 / 4.0
        spin = math.pi * math.sqrt(g) / (3.0 * (1.0 - nu)) * (1.0 + nu * (math.log(16.0 / g) - 5.0))
        return lateral / (1.0 - nu), lateral, spin, lateral / (4.0 * (1.0 - nu) * g)
    g = 1.0 / axis_ratio
    big = math.log(16.0 / g**2)
    one, two = big - 2.0 * nu, (1.0 - nu) * big + 2.0 * nu
    three = (1.0 - nu) * big - 2.0 + 4.0 * nu
    rest = 3.0 - math.log(4.0)
    return (
        2.0 * math.pi / (g * one) * (1.0 + rest / one),
        2.0 * math.pi / (g * two) * (1.0 + (1.0 - nu) * rest / two),
        2.0 * math.pi / (3.0 * g**1.5 * three),
        math.pi / 4.0 * (1.0 - nu * (big - 2.0) / three),
    )


@dataclass(frozen=True)
class _Spline:
    """Knots in l and, for each coefficient and tabulated ν, a constant and basis weights."""

    places: tuple[float, ...]
    weights: tuple[tuple[tuple[float, ...], ...], ...]


@lru_cache(maxsize=1)
def _spline() -> _Spline:
    entries = _entries()
    ratios = sorted(entries)
    places = [math.log(ratio) for ratio in ratios]
    weights = tuple(
        tuple(
            _truncated_powers(places, [_smooth(r, nu, entries[r][i])[k] for r in ratios])
            for i, nu in enumerate(_table()["poissons_ratio"])
        )
        for k in range(4)
    )
    return _Spline(tuple(places), weights)


def _entries() -> dict[float, list[tuple[float, ...]]]:
    """Return C11, C22, C23, C33 for each tabulated ν by a/b, the asymptotes' knots included."""
    table = _table()
    entries: dict[float, list[tuple[float, ...]]] = {}
    for side, power in (("narrow", 1.0), ("long", -1.0)):
        for g, *cells in table[side]:
            entries[g**power] = [tuple(cells[4 * i : 4 * i + 4]) for i in range(3)]
        for g in BEYOND:
            entries[g**power] = [
                _joined(g**power, nu, entries[_JOIN**power][i])
                for i, nu in enumerate(table["poissons_ratio"])
            ]
    return entries


def _joined(ratio: float, nu: float, last: Sequence[float]) -> tuple[float, ...]:
    """Return the asymptotes with what the last entry differs from them, fading out.

    It fades with g^(3/2) or, where the asymptotes have logarithms, with the square of these, as
    the exact solution does.
    """
    g = min(ratio, 1.0 / ratio)
    edge = asymptotes(_JOIN if ratio < 1.0 else 1.0 / _JOIN, nu)
    power = (g / _JOIN) ** 1.5
    logarithm = (math.log(16.0 / _JOIN**2) / math.log(16.0 / g**2)) ** 2
    fading = (power,) * 4 if ratio < 1.0 else (logarithm, logarithm, power, logarithm)
    return tuple(
        far * (1.0 + (near / at_edge - 1.0) * fade)
        for far, near, at_edge, fade in zip(asymptotes(ratio, nu), last, edge, fading, strict=True)
    )


def _smooth(ratio: float, nu: float, entry: Sequence[float]) -> tuple[float, ...]:
    h = math.sqrt(1.0 + ratio * ratio)
    c11, c22, c23, c33 = entry
    stiffer = (1.0 - nu) / h
    return h / c11, h / c22, c23 * stiffer / math.sqrt(ratio), c33 * stiffer * ratio


@lru_cache(maxsize=1)
def _table() -> dict[str, Any]:
    from ruamel.yaml import YAML

    text = files("vehicledyn.rail.creep").joinpath("kalker.yaml").read_text(encoding="utf-8")
    table: dict[str, Any] = YAML(typ="safe", pure=True).load(text)
    return table


def _truncated_powers(places: Sequence[float], values: Sequence[float]) -> tuple[float, ...]:
    """Return the weights of 1, l - l₀ and max(l - l_k, 0)³ of the natural cubic spline."""
    import numpy as np

    steps, slopes = np.diff(places), np.diff(values) / np.diff(places)
    matrix = np.diag(2.0 * (steps[:-1] + steps[1:]))
    matrix += np.diag(steps[1:-1], 1) + np.diag(steps[1:-1], -1)
    second = np.concatenate([[0.0], np.linalg.solve(matrix, 6.0 * np.diff(slopes)), [0.0]])
    third = np.concatenate([[0.0], np.diff(second) / steps])
    first = slopes[0] - steps[0] * second[1] / 6.0
    return (float(values[0]), float(first), *(float(x) for x in np.diff(third) / 6.0))


def _at(columns: Sequence[Sequence[float]], basis: Sequence[Scalar], nu: Scalar) -> Scalar:
    """Return the spline at a Poisson's ratio; for a number, the weights are joined first."""
    if isinstance(nu, int | float):
        return _dot([float(_parabola(row, nu)) for row in zip(*columns, strict=True)], basis)
    return _parabola([_dot(weights, basis) for weights in columns], nu)


def _dot(weights: Sequence[float], basis: Sequence[Scalar]) -> Scalar:
    total: Scalar = weights[0]
    for weight, value in zip(weights[1:], basis, strict=True):
        total = total + weight * value
    return total


def _parabola(values: Sequence[Scalar], nu: Scalar) -> Scalar:
    """Return the parabola through values at ν = 0, 1/4, 1/2."""
    return (
        values[0] * (1.0 - 4.0 * nu) * (1.0 - 2.0 * nu)
        + values[1] * 8.0 * nu * (1.0 - 2.0 * nu)
        + values[2] * 2.0 * nu * (4.0 * nu - 1.0)
    )
