"""A path with its corridor as curves, for numbers and expressions alike."""

from __future__ import annotations

from typing import Any

from vehicledyn.analyse.optimal_control.problem import Corridor
from vehicledyn.symbolic.tables import CurveTable


class PathCurves:
    """Cubic splines through the places of a path and its sides.

    Parameters
    ----------
    path
        Places at equal distances.
    """

    def __init__(self, path: Corridor) -> None:
        start = float(path.distance[0])
        step = float(path.distance[-1] - start) / (len(path.distance) - 1)
        self.tables = tuple(
            CurveTable.through(f"path {name}", start, step, getattr(path, name))
            for name in ("x", "y", "right", "left")
        )

    def seen(self, distance: Any, x: Any, y: Any) -> tuple[Any, Any]:
        """Return how far a place is ahead of a distance along the path, and to the left of it."""
        centre = [table.value(distance) for table in self.tables[:2]]
        along = [table.slope(distance) for table in self.tables[:2]]
        length = (along[0] ** 2 + along[1] ** 2) ** 0.5
        away = x - centre[0], y - centre[1]
        gap = (away[0] * along[0] + away[1] * along[1]) / length
        return gap, (along[0] * away[1] - along[1] * away[0]) / length

    def sides(self, distance: Any) -> tuple[Any, Any]:
        """Return how far the corridor reaches to the right and to the left."""
        return self.tables[2].value(distance), self.tables[3].value(distance)
