"""Find the folds and bifurcations between two points of a branch of cycles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from vehicledyn.analyse.periodic.cycle_points import CyclePoint
from vehicledyn.analyse.periodic.floquet import STABLE
from vehicledyn.analyse.periodic.orbit_steps import BranchSteps
from vehicledyn.base.errors import NumericalError

_NO_TURN = 1e-5
"""Scaled slope of the parameter along the branch below which its sign may be rounding [1]."""

_BEFORE = 1.0 - 1e-5, 1.0 - 1e-3, 0.7, 0.4
"""Parts of the way to a corner at which it is reported, the first at which an orbit is found."""

_NEUTRAL = 1e-6
"""Distance from 1 at which a multiplier counts as 1 all along the branch."""

_LOCATED, _FOLD, _AS_MULTIPLIERS = 1e-6, 1e-8, 1e-4
"""Part of a step to which special points are located; those that integration finds also where the
parameter of a fold is known to a part of its scale, and others to a part of a step, as their
multipliers err."""

_COMPLEX = 1e-6


def _slope(point: CyclePoint) -> float:
    return float(point.tangent.parameter)


_MEASURES: dict[str, Callable[[CyclePoint], float]] = {
    "fold": _slope,
    "branch_point": lambda point: point.multipliers.test_branch,
    "period_doubling": lambda point: point.multipliers.test_doubling,
}


class _LocatedError(Exception):
    """A place is near enough to a special point."""

    def __init__(self, place: float) -> None:
        super().__init__()
        self.place = place


@dataclass
class SpecialPoints:
    """Looks for special points; ``remarks`` name those that could not be located.

    ``side`` is the sign of the parameter's last slope along the branch.
    """

    steps: BranchSteps
    remarks: list[str]
    side: float = field(default=0.0)

    def begin(self, first: CyclePoint) -> None:
        """Note to which side the parameter runs at first."""
        self.side = self._side(first)

    def along(self, base: CyclePoint, after: CyclePoint, size: float) -> list[CyclePoint]:
        """Return the folds and bifurcations on a step, in their order."""
        found: list[tuple[float, CyclePoint]] = []
        turned = self._has_turned(after)
        if turned and _slope(base) * _slope(after) >= 0.0:
            found.append((0.0, replace(base, kind="fold")))
        for kind, measure in _MEASURES.items():
            low, high = measure(base), measure(after)
            wanted = turned if kind == "fold" else self._crosses(kind, base, after, turned)
            if low * high < 0.0 and wanted:
                located = self._locate(base, size, measure, after=after, kind=kind)
                if located is not None:
                    found.append((located[0], replace(located[1], kind=kind)))
        if base.multipliers.turning != after.multipliers.turning:
            located = self._torus(base, after, size)
            if located is not None:
                found.append((located[0], replace(located[1], kind="torus")))
        return [point for _, point in sorted(found, key=lambda item: item[0])]

    def _crosses(self, kind: str, base: CyclePoint, after: CyclePoint, turned: bool) -> bool:
        """Return whether a multiplier passes 1, elsewhere than at a fold, or -1."""
        place = -1.0 if kind == "period_doubling" else 1.0
        if turned and kind == "branch_point":
            return False
        nearest = [np.abs(p.multipliers.others - place).min() for p in (base, after)]
        return bool(min(nearest) > _NEUTRAL)

    def _has_turned(self, after: CyclePoint) -> bool:
        """Return whether the parameter now runs the other way, beyond rounding."""
        before, now = self.side, self._side(after)
        self.side = now or before
        return before * now < 0.0

    def _side(self, point: CyclePoint) -> float:
        slope = point.tangent.parameter / self.steps.parameter_scale
        return float(np.sign(slope)) if abs(slope) > _NO_TURN else 0.0

    def _locate(
        self,
        base: CyclePoint,
        size: float,
        measure: Callable[[CyclePoint], float],
        *,
        after: CyclePoint,
        kind: str,
    ) -> tuple[float, CyclePoint] | None:
        """Return where a measure passes zero on a step, and the point there.

        Where points on the way are not found it is the nearest one that is, with a remark.
        """
        from scipy.optimize import brentq

        if after.corner is not None:
            return self._at_corner(base, after.corner)
        points: dict[float, CyclePoint] = {0.0: base, size: after}

        def value(part: float) -> float:
            if part not in points:
                points[part] = self.steps.between(points, part)
                missed = _way_to_zero({p: measure(own) for p, own in points.items()}, part)
                if self._is_near(points[part], missed, size, kind):
                    raise _LocatedError(part)
            return measure(points[part])

        try:
            place = float(brentq(value, 0.0, size, xtol=_LOCATED * size, maxiter=40, disp=False))
            value(place)
        except _LocatedError as located:
            place = located.place
        except NumericalError:
            place = min(points, key=lambda part: abs(measure(points[part])))
            self._remark(kind, [p for _, p in sorted(points.items())], measure)
        except ValueError:
            return None
        return place, points[place]

    def _is_near(self, point: CyclePoint, missed: float, size: float, kind: str) -> bool:
        """Return whether a point is near enough to a special one, some way from it."""
        if point.passages is None:
            return False
        if kind == "fold":
            return abs(_slope(point)) * missed < _FOLD * self.steps.parameter_scale
        return missed < _AS_MULTIPLIERS * size

    def _at_corner(self, base: CyclePoint, way: float) -> tuple[float, CyclePoint]:
        """Return a point just before a corner."""
        for part in _BEFORE:
            with suppress(NumericalError):
                return part * way, self.steps.ahead_of(base, part * way)
        return 0.0, base

    def _remark(
        self, kind: str, points: list[CyclePoint], measure: Callable[[CyclePoint], float]
    ) -> None:
        """Return between which points, in their order, one lies at which a measure passes zero."""
        ends = [
            f"{point.orbit.parameter:.8g}"
            for pair in pairwise(points)
            if measure(pair[0]) * measure(pair[1]) <= 0.0
            for point in pair
        ][:2] or [f"{p.orbit.parameter:.8g}" for p in (points[0], points[-1])]
        self.remarks.append(
            f"{kind.replace('_', ' ')} not located: it lies on the branch between the cycles at "
            f"{self.steps.model.parameter} = {' and '.join(ends)}; one of them is reported"
        )

    def _torus(
        self, base: CyclePoint, after: CyclePoint, size: float
    ) -> tuple[float, CyclePoint] | None:
        """Return where a complex pair crosses the unit circle, None if that is not how."""
        outside = max((base, after), key=lambda point: point.multipliers.turning)
        values = outside.multipliers.others
        grown = values[(values.imag > _COMPLEX) & (np.abs(values) > STABLE)]
        if not grown.size:
            return None
        crossing = grown[np.argmin(np.abs(grown))]

        def measure(point: CyclePoint) -> float:
            others = point.multipliers.others
            nearest = others[np.argmin(np.abs(others - crossing))]
            return float(np.abs(nearest) - STABLE) if nearest.imag > _COMPLEX else np.nan

        ends = measure(base), measure(after)
        if not ends[0] * ends[1] < 0.0:
            return None
        return self._locate(base, size, measure, after=after, kind="torus")


def _way_to_zero(values: Mapping[float, float], place: float) -> float:
    """Return how far a function, known at some places, is zero from one of them at most.

    Its slope is taken for the smaller one of those to both neighbours.
    """
    places = sorted(values)
    k = places.index(place)
    slopes = [
        abs((values[place] - values[other]) / (place - other))
        for other in (places[k - 1], places[k + 1])
    ]
    least = min(slopes)
    return abs(values[place]) / least if least > 0.0 else np.inf
