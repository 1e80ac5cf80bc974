"""Equivalent conicities of a wheelset on its track, from tables of Δr as long as they need be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.rail.geometry.conicity import (
    RadiusDifference,
    equivalent_conicity,
    free_path,
    harmonic_conicity,
    regression_conicity,
)
from vehicledyn.rail.geometry.gauge_fit import climbed_side
from vehicledyn.rail.geometry.wheelset_geometry import (
    WheelsetOnTrack,
    WheelsetPosition,
    stand,
    stand_level,
)

NAMES = ("conicity", "conicity_with_roll", "conicity_harmonic", "conicity_regression")

Method = Callable[[WheelsetOnTrack, float, float], WheelsetPosition]

_FINE = 1e-4  # m, the distance of shifts, as EN 15302 has it
_BEYOND = 10  # shifts by which a table is longer than asked, and lengthened


def conicities(
    wheelset: WheelsetOnTrack, yaw: float, amplitudes: Any, radius: float, base: float
) -> tuple[dict[str, Any], list[str]]:
    """Return the conicities by name, nan where there is none, and what is to be said of them.

    Parameters
    ----------
    wheelset
        Wheels and rails.
    yaw
        Yaw of the wheelset [rad].
    amplitudes
        Amplitudes of the lateral motion, shape (n,) [m].
    radius, base
        Rolling radius in the middle and distance of the contacts [m].
    """
    found: dict[str, Any] = dict.fromkeys(NAMES, np.full(len(amplitudes), np.nan))
    if len(amplitudes) == 0:
        return found, []

    def is_enough(table: RadiusDifference) -> bool:
        largest = float(np.max(amplitudes))
        room = min(table.middle - table.shift[0], table.shift[-1] - table.middle)
        return room >= largest and free_path(table, largest, base, radius) is not None

    try:
        level, rolled = (
            differences_at(wheelset, yaw, float(np.max(amplitudes)), method, is_enough)
            for method in (stand_level, stand)
        )
    except InputError as error:
        return found, [str(error)]
    values = (
        equivalent_conicity(level, amplitudes, radius=radius, base=base),
        equivalent_conicity(rolled, amplitudes, radius=radius, base=base),
        harmonic_conicity(level, amplitudes),
        regression_conicity(level, amplitudes),
    )
    return dict(zip(NAMES, values, strict=True)), []


def differences_at(
    wheelset: WheelsetOnTrack,
    yaw: float,
    amplitude: float,
    method: Method,
    is_enough: Callable[[RadiusDifference], bool],
) -> RadiusDifference:
    """Return the rolling radius difference at shifts of EN 15302, outwards until one fails.

    Where both sides differ the wheelset runs about another place than the middle of the track,
    maybe far from it: the table grows until it holds the motion, to four times the amplitude.
    """
    shifts = int(np.ceil(amplitude / _FINE)) + _BEYOND
    differences = _Differences.of(wheelset, yaw, method)
    for reach in range(shifts, 4 * shifts, _BEYOND):
        differences.grow(reach)
        if differences.symmetric or not differences.growing:
            break
        try:
            if is_enough(differences.table()):
                break
        except InputError:  # no zero of the difference so far
            continue
    return differences.table()


@dataclass
class _Differences:
    """Rolling radius differences at shifts outwards from none, to both sides if they differ."""

    wheelset: WheelsetOnTrack
    yaw: float
    method: Method
    symmetric: bool
    values: dict[int, list[float]]
    growing: set[int]

    @staticmethod
    def of(wheelset: WheelsetOnTrack, yaw: float, method: Method) -> _Differences:
        """Return the difference at no shift; an InputError if the wheelset does not stand."""
        symmetric = wheelset.is_symmetric and yaw == 0.0 and wheelset.curvature == 0.0
        first = _difference(wheelset, method(wheelset, 0.0, yaw))
        directions = (1,) if symmetric else (1, -1)
        values = {direction: [first] for direction in directions}
        return _Differences(wheelset, yaw, method, symmetric, values, set(directions))

    def grow(self, reach: int) -> None:
        """Add values up to a number of shifts, on each side until a flange climbs its rail."""
        for direction in tuple(self.growing):
            for number in range(len(self.values[direction]), reach + 1):
                value = self._at(direction * number * _FINE)
                if value is None:
                    self.growing.remove(direction)
                    break
                self.values[direction].append(value)

    def table(self) -> RadiusDifference:
        """Return the differences; an InputError if they have no zero from which they rise."""
        left = self.values[1]
        right = [-value for value in left] if self.symmetric else self.values[-1]
        numbers = np.arange(1 - len(right), len(left), dtype=float)
        return RadiusDifference(_FINE * numbers, np.array([*right[:0:-1], *left]))

    def _at(self, shift: float) -> float | None:
        """Return the difference at a shift; None where a flange has climbed or a wheel left [m]."""
        if climbed_side(self.wheelset, shift) is not None:
            return None
        try:
            return _difference(self.wheelset, self.method(self.wheelset, shift, self.yaw))
        except InputError:
            return None


def _difference(wheelset: WheelsetOnTrack, position: WheelsetPosition) -> float:
    left, right = wheelset.left_wheel, wheelset.right_wheel
    of_left = left.radius + float(left.table.height(position.left.place[:1])[0])
    return of_left - right.radius - float(right.table.height(position.right.place[:1])[0])
