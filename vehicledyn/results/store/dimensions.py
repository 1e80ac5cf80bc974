"""Named dimensions of arrays, so that every result opens as labelled data in NetCDF's tools.

A dimension without values is a dimension scale of which nothing is stored, marked as NetCDF-4 does.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import h5py

_MARK = "This is a netCDF dimension but not a netCDF variable."
_CHUNK = 65536
_PART = re.compile("_(real|imag)$")


def bare_dimension(file: h5py.File, name: str, length: int, *, grows: bool = False) -> h5py.Dataset:
    """Return a new dimension of a name and length that has no values."""
    dataset = file.create_dataset(
        name,
        (length,),
        "i1",
        maxshape=(None,) if grows or not length else (length,),
        chunks=(max(1, min(length, _CHUNK)),),
    )
    dataset.make_scale(f"{_MARK}{length:10d}")
    return dataset


def resize_dimension(dataset: h5py.Dataset, length: int) -> None:
    """Give a dimension without values another length."""
    dataset.resize(length, axis=0)
    dataset.attrs["NAME"] = f"{_MARK}{length:10d}"


def is_bare(item: Any) -> bool:
    """Return whether something in a file is a dimension without values."""
    if not isinstance(item, h5py.Dataset) or not item.is_scale:
        return False
    name = item.attrs.get("NAME", b"")
    text = name.decode("ascii", "replace") if isinstance(name, bytes) else str(name)
    return text.startswith(_MARK)


def attach(dataset: h5py.Dataset, dimensions: Sequence[h5py.Dataset]) -> None:
    """Name the dimensions of a dataset, the first ones if it has more."""
    for axis, dimension in enumerate(dimensions):
        dataset.dims[axis].attach_scale(dimension)


def name_dimensions(file: h5py.File) -> None:
    """Give every dimension of a dataset that has none yet a name of its own."""
    found: list[h5py.Dataset] = []
    file.visititems(lambda _, item: found.append(item) if isinstance(item, h5py.Dataset) else None)
    for dataset in found:
        if dataset.is_scale:
            continue
        for axis in range(dataset.ndim):
            if not len(dataset.dims[axis]):
                stem = _PART.sub("", dataset.name.strip("/").replace("/", "_"))
                name, length = f"{stem}_axis_{axis}", dataset.shape[axis]
                known = file[name] if name in file else bare_dimension(file, name, length)
                dataset.dims[axis].attach_scale(known)
