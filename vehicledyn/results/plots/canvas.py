"""Figures whose axes leave out what no scale reaches, such as numbers of damaged files."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LARGEST = 1e100
"""Size of the largest numbers drawn; squares and differences of them are still numbers."""

MOST_INCHES = 60.0
"""Of a figure's height; a picture of 9000 dots."""


def new_canvas(width: float, height: float) -> Figure:
    """Return an empty figure, sizes in inches, whose axes are bounded."""
    made: Figure = _figure_class()(figsize=(width, min(height, MOST_INCHES)), layout="constrained")
    return made


def drawable(values: Any) -> NDArray[np.float64]:
    """Return numbers, NaN where they are too large for any scale.

    >>> drawable([1.0, 1e308]).tolist()
    [1.0, nan]
    """
    given = np.asarray(values, dtype=float)
    with np.errstate(invalid="ignore"):
        beyond = ~(np.abs(given) <= LARGEST)
    return np.where(beyond, np.nan, given) if beyond.any() else given


@cache
def _figure_class() -> Any:
    """Return the class of figures; made when one is drawn, as matplotlib is slow to import."""
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.patches import Rectangle
    from matplotlib.projections import register_projection

    class BoundedAxes(Axes):
        """Axes that leave out numbers which are not finite or beyond ``LARGEST``."""

        name = "bounded"

        def add_line(self, line: Any) -> Any:
            """Add a line, with gaps where its points are left out."""
            kept = [_drawable_or_same(v) for v in (line.get_xdata(), line.get_ydata())]
            line.set_data(*kept)
            return super().add_line(line)

        def add_patch(self, p: Any) -> Any:
            """Add a patch; a bar that no scale reaches has no size."""
            if isinstance(p, Rectangle) and np.isnan(drawable(p.get_bbox().bounds)).any():
                p.set_bounds(0.0, 0.0, 0.0, 0.0)
            return super().add_patch(p)

        def hist(self, x: Any, *args: Any, **options: Any) -> Any:
            """Count what can be drawn."""
            known = drawable(x)
            known = known[~np.isnan(known)]
            if known.size and np.ptp(known) <= 1e-9 * np.abs(known).max():
                options["bins"] = 1  # no more can be told apart
            return super().hist(known, *args, **options)

        def scatter(self, x: Any, y: Any, *args: Any, **options: Any) -> Any:
            """Draw the dots that can be drawn."""
            return super().scatter(drawable(x), drawable(y), *args, **options)

        def fill_between(self, x: Any, y1: Any, y2: Any = 0, *args: Any, **options: Any) -> Any:
            """Fill where both edges can be drawn."""
            across, one, two = (drawable(each) for each in (x, y1, y2))
            return super().fill_between(across, one, two, *args, **options)

        def text(self, x: Any, y: Any, s: Any, *args: Any, **options: Any) -> Any:
            """Write a text, none where its place cannot be drawn."""
            known = not np.isnan(drawable([x, y])).any()
            place = (x, y, s) if known else (0.0, 0.0, "")
            return super().text(*place, *args, **options)

        def annotate(self, text: Any, xy: Any, *args: Any, **options: Any) -> Any:
            """Write a text at a point, none where that cannot be drawn."""
            known = not np.isnan(drawable(xy)).any()
            return super().annotate(*((text, xy) if known else ("", (0.0, 0.0))), *args, **options)

        def set_xlim(self, *args: Any, **options: Any) -> Any:
            """Set the scale across, as far as scales reach."""
            return _limit(super().set_xlim, self.get_xlim, args, options)

        def set_ylim(self, *args: Any, **options: Any) -> Any:
            """Set the upright scale, as far as scales reach."""
            return _limit(super().set_ylim, self.get_ylim, args, options)

    class BoundedFigure(Figure):
        """A figure whose axes are bounded."""

        def add_subplot(self, *args: Any, **options: Any) -> Any:
            """Add bounded axes."""
            return super().add_subplot(*args, **({"projection": BoundedAxes.name} | options))

    register_projection(BoundedAxes)
    return BoundedFigure


def _drawable_or_same(values: Any) -> Any:
    try:
        return drawable(values)
    except (TypeError, ValueError):  # names of categories
        return values


def _limit(put: Any, get: Any, args: tuple[Any, ...], options: dict[str, Any]) -> Any:
    """Set limits whose numbers are cut to what is drawn; leave the old ones where they are none."""
    ends = args[0] if len(args) == 1 and np.ndim(args[0]) else args
    cut = [None if end is None else float(np.clip(end, -LARGEST, LARGEST)) for end in ends]
    numbers = np.array([end for end in cut if end is not None])
    if np.isnan(numbers).any() or (numbers.size > 1 and numbers[0] == numbers[1]):
        return get()
    return put(*cut, **options)
