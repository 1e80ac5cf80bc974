"""Functions of time as straight lines between knots whose places are parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from vehicledyn.base.errors import InputError
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.parameters import ParameterTable

KNOTS = 8
"""Knots of every table: equal for all manoeuvres, so that one compilation serves them all."""


@dataclass(frozen=True)
class TimeTable:
    """Values at times, linear between them and constant outside.

    ``times`` [s] increase; both have at most :data:`KNOTS` entries.
    """

    times: tuple[float, ...] = (0.0,)
    values: tuple[float, ...] = (0.0,)

    def __post_init__(self) -> None:
        """Refuse what is no table.

        Raises
        ------
        InputError
            If times do not increase or there are too many.
        """
        if not 0 < len(self.times) == len(self.values) <= KNOTS:
            raise InputError(f"a table of time has 1 to {KNOTS} times and as many values")
        if any(b <= a for a, b in zip(self.times, self.times[1:], strict=False)):
            raise InputError(f"the times of a table must increase, not {list(self.times)}")

    def at(self, time: float) -> float:
        """Return the value at a time [s]."""
        times, values = self._filled()
        found = values[0]
        for k in range(KNOTS - 1):
            part = (time - times[k]) / (times[k + 1] - times[k])
            found += (values[k + 1] - values[k]) * min(max(part, 0.0), 1.0)
        return found

    def settings(self, name: str) -> Iterator[tuple[str, float]]:
        """Yield the parameters by name with their values."""
        for k, (time, value) in enumerate(zip(*self._filled(), strict=True)):
            yield f"{name}.time_{k}", time
            yield f"{name}.value_{k}", value

    def enter(
        self, table: ParameterTable, name: str, unit: str, meaning: str
    ) -> Callable[[Scalar], Scalar]:
        """Enter the knots as parameters and return the function of time."""
        found = {}
        for key, value in self.settings(name):
            is_time = ".time_" in key[len(name) :]
            words = f"Knot of: {meaning}"
            found[key] = table.add(key, value, "s" if is_time else unit, words)
        times = [found[f"{name}.time_{k}"] for k in range(KNOTS)]
        values = [found[f"{name}.value_{k}"] for k in range(KNOTS)]

        def law(time: Scalar) -> Scalar:
            total = values[0]
            for k in range(KNOTS - 1):
                part = (time - times[k]) / (times[k + 1] - times[k])
                total += (values[k + 1] - values[k]) * ops.minimum(ops.maximum(part, 0.0), 1.0)
            return total

        return law

    def _filled(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        missing = KNOTS - len(self.times)
        later = tuple(self.times[-1] + 1.0 + k for k in range(missing))
        return self.times + later, self.values + (self.values[-1],) * missing
