"""The names that expressions of a system file may use besides parameters."""

from __future__ import annotations

import math
from collections import ChainMap
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from typing import Any

from vehicledyn.files.expressions.dimensions import measure_of
from vehicledyn.files.system.joints import Coordinate

_USING_TIME = ("time", "motion", "force", "geometry", "movement", "event")
_USING_PLACES = ("motion", "force", "geometry", "movement", "event")
_USING_RATES = ("motion", "force", "movement", "event")


class Variables:
    """Measures of the names that expressions may use, those of coordinates found once for all.

    Parameters
    ----------
    coordinates
        All coordinates by name.
    """

    def __init__(self, coordinates: dict[str, Coordinate]) -> None:
        self._coordinates = coordinates

    def of(self, kind: str, length: str, points: Iterable[str] = ()) -> ChainMap[str, Any]:
        """Return the measures of the names that one expression may use, a tuple of a vector.

        Parameters
        ----------
        kind
            As in :func:`vehicledyn.files.expressions.fields.measured`, or "geometry", "movement"
            or "event".
        length
            Unit of the length or coordinate that a law is about.
        points
            Names of points.
        """
        rate = f"{length}/s"
        found: dict[str, Any] = {}
        if kind == "law":
            found = {"length": measure_of(length), "rate": measure_of(rate)}
        if kind == "force":
            found = {"position": measure_of(length), "rate": measure_of(rate)}
        if kind in _USING_TIME:
            found["time"] = measure_of("s")
        for point in points:
            found[point] = (measure_of("m"),) * 3
            if kind in ("movement", "event"):
                found[f"{point}_velocity"] = (measure_of("m/s"),) * 3
        layers = [found]
        if kind in _USING_RATES:
            layers.append(self._rates)
        if kind in _USING_PLACES:
            layers.append(self._places)
        return ChainMap(*layers)

    @cached_property
    def _places(self) -> dict[str, Any]:
        return {name: measure_of(c.unit) for name, c in self._coordinates.items()}

    @cached_property
    def _rates(self) -> dict[str, Any]:
        return {f"{n}_rate": measure_of(f"{c.unit}/s") for n, c in self._coordinates.items()}


class Unknown(Mapping[str, Any]):
    """Names of which only is known whether they are numbers or vectors: each is not a number."""

    def __init__(self, names: Mapping[str, Any]) -> None:
        self._names = names

    def __getitem__(self, name: str) -> Any:
        """Return what stands for the unknown value."""
        return (math.nan,) * 3 if isinstance(self._names[name], tuple) else math.nan

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return iter(self._names)

    def __len__(self) -> int:
        """Return how many names there are."""
        return len(self._names)
