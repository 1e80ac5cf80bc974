"""Ground whose height along x comes from a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.column_files import ColumnKind, Columns, read_columns
from vehicledyn.base.parameters import quantity
from vehicledyn.base.problems import Problem, refusal
from vehicledyn.base.registry import register
from vehicledyn.road.surfaces.file_surface import FileSurface
from vehicledyn.road.surfaces.surface import Lines, SteepPlace
from vehicledyn.symbolic.ops import Scalar

if TYPE_CHECKING:
    from vehicledyn.base.numbers.shape_preserving import Vector
    from vehicledyn.symbolic.tables import CurveTable

LARGEST_DEVIATION = 1e-6
"""Most that the curve may miss a point of the file by [m]."""

MOST_CELLS = 2_000_000
_FEWEST = 2
_HIGHEST = 10.0
_FARTHEST = 1e6
_COLUMNS = {"x": ColumnKind("m", required=True), "z": ColumnKind("m", required=True)}


@register("road", "profile")
class ProfileRoad(FileSurface):
    """Ground z = h(x - start) through the points of a file, equal across the road.

    The file is a table with the columns x and z and their units, such as ``x [m], z [mm]``. A
    curve with continuous slope goes through the points, level at both ends, from where the
    ground stays as it is: a cubic spline where the points resolve the curve, monotone cubics
    where a spline would swing out, as beside a kerb in few points. Places at unequal distances
    are put on an even grid, which misses no point by more than 1 µm. A disc touches the ground
    in one point only while its radius stays below the smallest radius of curvature.
    """

    start: float = quantity("m", "World x where the x of the file is zero", default=0.0)

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the height of the ground [m]."""
        return self.ground().value(x - self.start)

    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the slope along x [1]; the slope along y is zero."""
        return self.ground().slope(x - self.start), 0.0

    def lines(self) -> Lines:
        """Return the extent of the curve, which is equal across the road."""
        table: CurveTable = self.ground()
        first, last = (place + self.start for place in (table.start, table.stop))
        return Lines(first, last, (-1.0, 1.0), straight=True)

    def steepest(self) -> SteepPlace:
        """Return the steepest place of the curve, which is equal across the road."""
        import numpy as np

        table: CurveTable = self.ground()
        halves = table.start + 0.5 * table.step * np.arange(2 * len(table.coefficients) + 1)
        slopes = np.abs(table.slope(halves))
        at = int(np.argmax(slopes))
        return SteepPlace(float(slopes[at]), float(halves[at]) + self.start, 0.0)

    @classmethod
    def read(cls, path: Path, *settings: object) -> CurveTable:
        """Return the curve in a file; see :meth:`FileSurface.read`."""
        import numpy as np

        columns = read_columns(path, _COLUMNS)
        x, z = (np.array(columns.numbers[name]) for name in _COLUMNS)
        problems = _problems(columns, x.tolist(), z.tolist())
        if problems:
            raise refusal(problems, str(path))
        return _through(path, x, z)


def _problems(columns: Columns, x: list[float], z: list[float]) -> list[Problem]:
    if len(x) < _FEWEST:
        return [columns.problem(0, "x", f"a road needs {_FEWEST} points at least")]
    for row in range(1, len(x)):
        if not x[row] > x[row - 1]:
            same = x[row] == x[row - 1]
            words = "the place is there twice" if same else "the places do not grow; sort them by x"
            return [columns.problem(row, "x", words)]
    far = [row for row, place in enumerate(x) if abs(place) > _FARTHEST]
    if far:
        words = f"farther than {_FARTHEST:g} m; is the unit in the head right?"
        return [columns.problem(far[0], "x", words)]
    steep = [row for row, height in enumerate(z) if abs(height - z[0]) > _HIGHEST]
    words = f"{_HIGHEST:g} m away from the first height; is the unit in the head right?"
    return [columns.problem(row, "z", f"more than {words}") for row in steep[:1]]


def _through(path: Path, x: object, z: object) -> CurveTable:
    """Return the curve through points, on an even grid that is as fine as it must be."""
    import numpy as np
    from scipy.interpolate import CubicHermiteSpline

    from vehicledyn.base.numbers.shape_preserving import level_slopes, limited_slopes

    places, heights = np.asarray(x, dtype=float), np.asarray(z, dtype=float)
    exact = CubicHermiteSpline(places, heights, level_slopes(places, heights))
    length, finest = places[-1] - places[0], np.diff(places).min()
    cells = max(_FEWEST, round(length / finest))
    while cells <= MOST_CELLS:
        knots = np.linspace(places[0], places[-1], cells + 1)
        slopes = limited_slopes(knots, exact(knots), exact(knots, nu=1))
        curve = _table(knots, exact(knots), slopes)
        if np.abs(curve.value(places) - heights).max() <= LARGEST_DEVIATION:
            return curve
        cells *= 2
    raise InputError(
        f"{path}: points {finest:g} m apart on {length:g} m are too uneven for an even grid; "
        "give heights at equal distances"
    )


def _table(knots: Vector, values: Vector, slopes: Vector) -> CurveTable:
    """Return the cubics of values and slopes at knots at equal distances."""
    import numpy as np

    from vehicledyn.symbolic.tables import CurveTable

    step = float(knots[-1] - knots[0]) / (len(knots) - 1)
    rises, first, last = np.diff(values), step * slopes[:-1], step * slopes[1:]
    rows = [values[:-1], first, 3.0 * rises - 2.0 * first - last, first + last - 2.0 * rises]
    return CurveTable("road profile", float(knots[0]), step, np.stack(rows, axis=1))
