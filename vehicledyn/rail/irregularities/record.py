"""Irregularities from a measured record."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from pydantic import Field

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.column_files import ColumnKind
from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.rail.track.track_set import IrregularitySet

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from vehicledyn.rail.track.track_tables import TabledShift

    Columns = dict[str, NDArray[np.float64]]

LARGEST = 0.2
"""Irregularity beyond which the unit of a column is taken for a mistake [m]."""

_QUANTITIES = ("alignment", "level", "cross_level", "gauge")
_COLUMNS = {"s": ColumnKind("m", required=True), **{name: ColumnKind("m") for name in _QUANTITIES}}
_EVEN = 1e-6

MOST_VALUES = 2_000_000
_GAP = 3.0
"""Ratio of the largest distance of two lines to the smallest from which on a spline swings out."""

_FINER = 4
"""Places for each smallest distance of such lines."""


@register("irregularity", "record")
class Record(IrregularitySet):
    """Irregularities from a table of s, alignment, level, cross_level and gauge.

    The columns but s may be left out; every head states its unit, such as ``s [m], level [mm]``.
    Alignment is the shift of the track to the left, level upwards, cross level the height of the
    right rail over the left one, gauge the excess over the nominal one. Lines that are not at
    equal distances are joined by a spline and taken at the closest distance of two. A spline
    swings out where distances differ much, as beside a single bump: then they are joined by
    cubics without an extremum between two lines (Fritsch, Carlson 1980, SIAM Journal on
    Numerical Analysis 17, 238-246), which keep a flat rail flat.
    """

    names_files: ClassVar[bool] = True

    file: str = Field(description="Table of the irregularities, as CSV")
    start: float = quantity("m", "Where its first line lies on the track", default=0.0)
    fade: float = quantity("m", "Length over which it comes and goes at its ends", ge=0.0)
    scale: float = quantity("1", "Factor on all values", default=1.0, ge=-100.0, le=100.0)

    def shift(self, folder: Path) -> TabledShift:
        """Return the displacement of the rails."""
        import numpy as np

        from vehicledyn.base.problems import refusal
        from vehicledyn.rail.irregularities.irregularity import rails_of
        from vehicledyn.rail.track.track_columns import read_along

        path = folder / self.file
        largest = dict.fromkeys(_QUANTITIES, (LARGEST, "an irregularity"))
        columns, values = read_along(path, _COLUMNS, largest)
        s = values.pop("s")
        if not values:
            words = f"there is no column of irregularities; known are {', '.join(_QUANTITIES)}"
            raise refusal([columns.problem(0, "s", words)], str(path))
        length, steps = float(s[-1] - s[0]), np.diff(s)
        if 2.0 * self.fade > length:
            words = f"the record of {length:g} m is shorter than twice the fade of {self.fade:g} m"
            raise refusal([columns.problem(len(s) - 1, "s", words)], str(path))
        step = float(steps.mean())
        if float(np.abs(steps - step).max()) > _EVEN * step:
            try:
                step, values = _evened(s, values)
            except InputError as error:
                row = int(np.argmin(steps)) + 1
                raise refusal([columns.problem(row, "s", str(error))], str(path)) from None
        scaled = {name: self.scale * v for name, v in values.items()}
        return rails_of(self.start, step, scaled, self.fade)


def _evened(s: NDArray[np.float64], values: Columns) -> tuple[float, Columns]:
    """Return a distance and the values at places that far apart [m]."""
    import numpy as np
    from scipy.interpolate import CubicSpline, PchipInterpolator

    steps = np.diff(s)
    has_gaps = float(steps.max()) > _GAP * float(steps.min())
    closest = float(steps.min()) / (_FINER if has_gaps else 1)
    count = int(np.ceil(float(s[-1] - s[0]) / closest - 1e-9))
    if count > MOST_VALUES:
        raise InputError(
            f"lines {closest:g} m apart on {float(s[-1] - s[0]):g} m are too uneven; "
            "give values at equal distances"
        )
    even = np.linspace(s[0], s[-1], count + 1)
    curve = PchipInterpolator if has_gaps else CubicSpline
    return float(even[1] - even[0]), {n: curve(s, v)(even) for n, v in values.items()}
