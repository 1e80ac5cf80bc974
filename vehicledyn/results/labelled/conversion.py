"""Labelled arrays as what xarray and pandas hold."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, MissingPartError
from vehicledyn.results.labelled.labels import Labelled, LabelledSet

if TYPE_CHECKING:
    import pandas
    import xarray

MAIN_DIMENSIONS: dict[str, tuple[str, ...]] = {
    "run": ("time",),
    "study": ("case",),
    "modes": ("case", "mode"),
    "response": ("frequency", "input", "output"),
    "hunt": ("cycle",),
    "contacts": ("shift",),
    "equilibrium": ("coordinate",),
    "identification": ("parameter",),
    "uncertainty": ("figure",),
    "optimum": ("variable",),
}
"""Dimensions of the arrays that make the usual table, by the kind of the result."""


def data_array(array: Labelled) -> xarray.DataArray:
    """Return an array for xarray, with unit and meaning as attributes."""
    coords = {
        name: (label.dims, label.values, _facts(label))
        for name, label in array.coords.items()
        if name in array.dims
    }
    if array.dims == (array.name,):
        coords[array.name] = (array.dims, array.values, _facts(array))
    return _xarray().DataArray(
        array.values, dims=array.dims, coords=coords, name=array.name, attrs=_facts(array)
    )


def data_set(data: LabelledSet, patterns: Sequence[str]) -> xarray.Dataset:
    """Return the arrays that match patterns for xarray, with title and status as attributes."""
    package = _xarray()
    found = {}
    for labelled in data.arrays(*patterns):
        array = data_array(labelled)
        found[labelled.name] = array if array.name in array.dims else array.rename(labelled.name)
    head = {"title": data.title, "model": data.model, "status": data.status, "kind": data.kind}
    return package.Dataset(found, attrs={**head, **data.attributes})


def series(array: Labelled) -> pandas.Series:
    """Return a pandas series over the dimensions of an array."""
    import pandas

    return pandas.Series(np.ravel(array.values), index=_index(array), name=array.name)


def data_frame(data: LabelledSet, patterns: Sequence[str]) -> pandas.DataFrame:
    """Return arrays over the same dimensions as columns of a table.

    Raises
    ------
    InputError
        If arrays were asked for that do not share their dimensions.
    """
    import pandas

    arrays = table_arrays(data, patterns)
    columns = {array.name: np.ravel(array.values) for array in arrays}
    return pandas.DataFrame(columns, index=_index(arrays[0]))


def table_arrays(data: LabelledSet, patterns: Sequence[str]) -> list[Labelled]:
    """Return the arrays that make a table; labels of its rows are not among them.

    Without patterns those over the main dimensions of the result are taken.

    Raises
    ------
    InputError
        If arrays were asked for that do not share their dimensions, or there are none.
    """
    arrays = list(data.arrays(*patterns))
    if not patterns:
        main = MAIN_DIMENSIONS.get(data.kind, ())
        arrays = [array for array in arrays if array.dims == main] or arrays
    arrays = [array for array in arrays if array.dims != (array.name,)] or arrays
    if len({array.dims for array in arrays}) != 1:
        listed = ", ".join(f"{array.name} ({array.size_in_words})" for array in arrays[:5])
        raise InputError(
            f"a table needs arrays over the same dimensions, these are over: {listed}; "
            "choose some by name, or take to_xarray()"
        )
    return arrays


def labels_along(array: Labelled) -> list[tuple[str, NDArray[Any]]]:
    """Return the dimensions of an array with their labels, repeated for each of its values."""
    labels = [np.asarray(_label(array, dim)) for dim in array.dims]
    grid = np.meshgrid(*(np.arange(len(label)) for label in labels), indexing="ij")
    return [
        (dim, label[np.ravel(places)])
        for dim, label, places in zip(array.dims, labels, grid, strict=True)
    ]


def _index(array: Labelled) -> Any:
    import pandas

    labels = [_label(array, dim) for dim in array.dims]
    if len(labels) > 1:
        return pandas.MultiIndex.from_product(labels, names=array.dims)
    return pandas.Index(labels[0], name=array.dims[0]) if labels else None


def _label(array: Labelled, dim: str) -> Any:
    if dim in array.coords:
        return array.coords[dim].values
    return np.arange(array.values.shape[array.dims.index(dim)])


def _facts(array: Labelled) -> dict[str, str]:
    facts = {"units": array.unit, "long_name": array.description, "frame": array.frame}
    return {name: text for name, text in facts.items() if text}


def _xarray() -> Any:
    try:
        import xarray
    except ImportError:
        raise MissingPartError(
            "xarray is not installed; install it with: pip install 'vehicledyn[xarray]'"
        ) from None
    return xarray
