"""An array that knows its name, dimensions, unit and meaning."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import NDArray

from vehicledyn.base.checked_arguments import checked
from vehicledyn.base.errors import InputError
from vehicledyn.base.units import parse_unit

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class LabelledArray(NDArrayOperatorsMixin):
    """Values in SI with their labels; NumPy computes with it and returns plain arrays.

    Attributes
    ----------
    name
        Dotted name from whole to part.
    values
        The numbers, or texts.
    dims
        Name of each dimension of the values.
    unit
        Unit of the values, empty for texts.
    description
        Meaning in a phrase.
    coords
        For dimensions that have them, the labels along them.
    frame
        Frame that the values are expressed in, empty for what has none.
    """

    name: str
    values: NDArray[Any]
    dims: tuple[str, ...] = ()
    unit: str = ""
    description: str = ""
    coords: Mapping[str, LabelledArray] = field(default_factory=dict)
    frame: str = ""

    @property
    def time(self) -> NDArray[Any]:
        """Times of the values, shape (n_times,) [s].

        Raises
        ------
        InputError
            If the values do not change with time.
        """
        if "time" not in self.coords:
            raise InputError(
                f"{self.name}: has the dimensions {self.dims or 'of a scalar'}, no time"
            )
        return self.coords["time"].values

    @property
    def shape(self) -> tuple[int, ...]:
        """Lengths of the dimensions."""
        return self.values.shape

    @checked
    def to(self, unit: str) -> NDArray[Any]:
        """Return the values in another unit, such as "deg/s".

        Raises
        ------
        InputError
            If the unit is unknown or of another dimension.
        """
        given, wanted = parse_unit(self.unit or "1"), parse_unit(unit)
        if given.dimension != wanted.dimension:
            raise InputError(f"{self.name}: is in {self.unit or '1'}, which is no {unit}")
        converted: NDArray[Any] = self.values * (given.factor / wanted.factor)
        return converted

    def to_xarray(self) -> xarray.DataArray:
        """Return an ``xarray.DataArray``; xarray must be installed."""
        from vehicledyn.results.labelled.conversion import data_array

        return data_array(self)

    def to_series(self) -> pandas.Series:
        """Return a pandas series over the array's dimensions."""
        from vehicledyn.results.labelled.conversion import series

        return series(self)

    def plot(self) -> Figure:
        """Return a figure of the values over their first dimension."""
        from vehicledyn.results.labelled.figure import draw_array

        return draw_array(self)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """Return the values for NumPy."""
        return np.array(self.values, dtype=dtype, copy=copy)

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **kwargs: Any) -> Any:
        """Compute with the values."""
        plain = [item.values if isinstance(item, LabelledArray) else item for item in inputs]
        return getattr(ufunc, method)(*plain, **kwargs)

    def __float__(self) -> float:
        """Return the only value as a number."""
        return float(self.values)

    def __getitem__(self, key: Any) -> Any:
        """Return some of the values."""
        return self.values[key]

    def __iter__(self) -> Iterator[Any]:
        """Go through the values along the first dimension."""
        return iter(self.values)

    def __len__(self) -> int:
        """Return the length of the first dimension."""
        return len(self.values)

    def __repr__(self) -> str:
        """Return name, dimensions, unit, meaning and range in a line or two."""
        facts = f"{self.name} ({self.size_in_words}) {self.unit_in_words}  {self.description}"
        return f"{facts}\n{self.range_in_words}"

    def _repr_html_(self) -> str:
        """Return the same for a notebook."""
        facts = f"{self.size_in_words} {self.unit_in_words}"
        return (
            f"<b>{escape(self.name)}</b> {escape(facts)}<br>{escape(self.description)}"
            f"<br><code>{escape(self.range_in_words)}</code>"
        )

    @property
    def size_in_words(self) -> str:
        """Dimensions with their lengths, such as "time: 501"."""
        pairs = zip(self.dims, self.values.shape, strict=True)
        return ", ".join(f"{name}: {length}" for name, length in pairs) or "scalar"

    @property
    def unit_in_words(self) -> str:
        """The unit in brackets, empty for texts."""
        return f"[{self.unit}]" if self.unit else ""

    @property
    def range_in_words(self) -> str:
        """Least and greatest value, or the texts that occur."""
        values = self.values
        if values.size == 0:
            return "empty"
        if values.dtype.kind not in "fiub":
            texts = list(dict.fromkeys(str(item) for item in values.flat))
            more = ", ..." if len(texts) > _MOST_TEXTS else ""
            return ", ".join(texts[:_MOST_TEXTS]) + more
        known = values[np.isfinite(values)]
        if not known.size:
            return "no numbers"
        low, high = f"{known.min():.6g}", f"{known.max():.6g}"
        return low if low == high else f"{low} to {high}"


_MOST_TEXTS = 4
