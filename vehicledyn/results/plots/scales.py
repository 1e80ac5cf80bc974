"""Scales of axes: units that suit the values, and room around lines that do not move."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from vehicledyn.results.plots.plot_style import SUPERSCRIPTS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from numpy.typing import NDArray

ROUNDING = 1e-9
"""Extent that counts as none, as part of the values' size, at least of 1 in the unit shown."""

_LARGEST = 1e300
"""Values beyond it leave no room for a wider scale."""

_SHOWN_AS = {"rad": "deg", "rad/s": "deg/s", "rad/s^2": "deg/s^2"}
_SMALL_AS, _SMALL = {"m": "mm", "m/s": "mm/s"}, 0.1
_LARGE_AS, _LARGE = {"N": "kN", "N*m": "kN*m", "Pa": "MPa"}, 2e4


MOST_IN_DECADES = 1e100
"""Values beyond it, or closer to zero than its inverse, leave a logarithmic scale no margin."""


def in_decades(values: Any) -> NDArray[np.float64]:
    """Return values for a logarithmic scale, NaN where they are beyond any, as in damaged files.

    >>> in_decades([1.0, 1e308, 0.0]).tolist()
    [1.0, nan, nan]
    """
    given = np.asarray(values, dtype=float)
    size = np.abs(given)
    drawable = (size >= 1.0 / MOST_IN_DECADES) & (size <= MOST_IN_DECADES)
    return np.where(drawable, given, np.nan)


def leave_out_unbounded(axes: Axes) -> None:
    """Leave gaps in lines where values are too large for any scale, as in damaged files."""
    lines = [np.asarray(line.get_ydata(), dtype=float) for line in axes.lines]
    kept = [np.where(np.abs(values) > _LARGEST, np.nan, values) for values in lines]
    if all(np.array_equal(*pair, equal_nan=True) for pair in zip(lines, kept, strict=True)):
        return
    for line, values in zip(axes.lines, kept, strict=True):
        line.set_ydata(values)
    known = np.concatenate([np.ravel(values[np.isfinite(values)]) for values in kept])
    low, high = (known.min(), known.max()) if known.size else (-1.0, 1.0)
    axes.set_ylim(low, high if high > low else low + 1.0)


def leave_room(axes: Axes) -> None:
    """Widen a scale that would show nothing but rounding errors: zero from -1 to 1."""
    low, high = axes.get_ylim()
    centre = 0.5 * low + 0.5 * high
    lines = [np.asarray(line.get_ydata(), dtype=float) for line in axes.lines]
    values = np.concatenate([np.ravel(each) for each in lines]) if lines else np.empty(0)
    known = values[np.isfinite(values)]
    if not known.size or np.abs(known).max() > _LARGEST:
        return
    size = max(1.0, float(np.abs(known).max()))
    if np.ptp(known) >= ROUNDING * size:
        return
    if abs(centre) < ROUNDING * size:
        axes.set_ylim(-1.0, 1.0)
    else:
        axes.set_ylim(centre - 0.1 * abs(centre), centre + 0.1 * abs(centre))


def plain_ticks(axis: Axis) -> None:
    """Write ticks of a logarithmic axis as plain numbers: 5 and 0.01, not powers of ten.

    Over less than a decade the scale is linear in what is labelled: round numbers, evenly apart.
    """
    from matplotlib.ticker import FuncFormatter, MaxNLocator, NullLocator

    low, high = sorted(axis.get_view_interval())
    if axis.get_scale() == "log" and low > 0.0 and high < 10.0 * low:
        axis.set_major_locator(MaxNLocator(5))
        axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(_as_number))
    axis.set_minor_formatter(FuncFormatter(lambda value, place: ""))


def decade_ticks(axis: Axis) -> None:
    """Write ticks of a logarithmic axis as powers of ten in plain text."""
    from matplotlib.ticker import LogFormatterSciNotation

    class Plain(LogFormatterSciNotation):
        def __call__(self, x: float, pos: int | None = None) -> str:
            return without_formula(super().__call__(x, pos))

    axis.set_major_formatter(Plain())
    axis.set_minor_formatter(Plain())


def without_formula(text: str) -> str:
    r"""Return the text of a tick that matplotlib writes as a formula.

    >>> without_formula(r"$\mathdefault{2\times10^{-3}}$"), without_formula("")
    ('2×10⁻³', '')
    """
    plain = text.removeprefix(r"$\mathdefault{").removesuffix("}$").replace(r"\times", "×")
    return re.sub(r"\^\{(.*?)\}", lambda power: power[1].translate(SUPERSCRIPTS), plain)


def _as_number(value: float, place: float | None = None) -> str:
    r"""Return a tick's text with a true minus sign.

    >>> _as_number(-100.0), _as_number(0.01)
    ('−100', '0.01')
    """
    return f"{value:g}".replace("-", "\u2212")


def suitable_unit(unit: str, *columns: Any) -> str:
    """Return the unit to show values in: degrees, and thousands or thousandths where they suit.

    >>> suitable_unit("m", [0.0, 0.006]), suitable_unit("m", [3.0]), suitable_unit("rad", [1.0])
    ('mm', 'm', 'deg')
    """
    sizes = [np.abs(np.asarray(column, dtype=float)) for column in columns]
    known = [each[np.isfinite(each)] for each in sizes]
    largest = max((float(each.max()) for each in known if each.size), default=0.0)
    if unit in _SMALL_AS and ROUNDING < largest < _SMALL:
        return _SMALL_AS[unit]
    if unit in _LARGE_AS and largest >= _LARGE:
        return _LARGE_AS[unit]
    return _SHOWN_AS.get(unit, unit)
