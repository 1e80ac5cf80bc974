"""Labelled arrays of the files of linear, hunting, contact, equilibrium and cam analyses."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.results.hdf5.seal import DamagedError
from vehicledyn.results.labelled.array import LabelledArray
from vehicledyn.results.labelled.source import Head, Source
from vehicledyn.results.labelled.table_figures import key_figures
from vehicledyn.results.store.dimensions import is_bare
from vehicledyn.results.store.layout import EventRecord, SummaryEntry
from vehicledyn.results.store.linear_file import old_file, read_texts
from vehicledyn.results.tables import equilibrium_table, mode_table
from vehicledyn.results.tables.kinds import TABLES

_HEAD = ("title", "model", "status", "message", "format", "format_version")
_CASE = re.compile(r"case_(\d+)\.")
_REAL, _IMAGINARY = "_real", "_imag"
_SCALES = "DIMENSION_LIST"
_ABOUT_NAMES = ("_units", "_long_name")


@dataclass(frozen=True)
class TableSource:
    """Arrays that were read at once, since such files are small."""

    head: Head
    arrays: Mapping[str, LabelledArray]
    remarks: tuple[str, ...] = ()
    figures: Mapping[str, SummaryEntry] = field(default_factory=dict)

    @property
    def names(self) -> Sequence[str]:
        """Names of the arrays."""
        return list(self.arrays)

    def read(self, names: Sequence[str]) -> list[LabelledArray]:
        """Return arrays."""
        return [self.arrays[name] for name in names]

    def summary(self) -> Mapping[str, SummaryEntry]:
        """Return what a study found, such as critical values or parameters."""
        return self.figures

    def events(self) -> tuple[EventRecord, ...]:
        """Return nothing: these analyses have no events."""
        return ()

    def notes(self) -> tuple[str, ...]:
        """Return remarks and warnings."""
        return self.remarks


def table_source(path: Path, kind: str) -> Source:
    """Return the arrays of a file.

    Raises
    ------
    InputError
        If the file is damaged or of no known format.
    """
    if kind not in TABLES:
        raise InputError(f"{path}: its format '{kind}' is no result of this program")
    with old_file(path, kind) as file:
        found = dict(_arrays(file))
        plain = {key: _plain(value) for key, value in file.attrs.items()}
        notes = tuple(read_texts(file, "notes")) if "notes" in file else ()
    head = Head(
        TABLES[kind].name,
        str(plain.get("title", "")),
        str(plain.get("model", "")),
        str(plain.get("status", "ok")),
        str(plain.get("message", "")),
        {key: value for key, value in plain.items() if key not in _HEAD},
    )
    arrays = found
    if kind == mode_table.FORMAT:
        arrays = _stacked(found, path)
    elif kind == equilibrium_table.FORMAT:
        arrays = found | _by_name(path)
    figures = key_figures(path, kind)
    kept = {name: array for name, array in arrays.items() if name != "notes"}
    return TableSource(head, kept, notes, figures)


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


def _arrays(file: h5py.File) -> Iterator[tuple[str, LabelledArray]]:
    """Yield every data set with the scales of its dimensions as labels; pairs as complex."""
    places: list[str] = []
    file.visititems(lambda place, item: places.append(place) if _is_data(item) else None)
    for place in places:
        if place.endswith(_IMAGINARY) or place.endswith(_ABOUT_NAMES):
            continue
        name = place.replace("/", ".")
        dataset = file[place]
        values = _values(dataset)
        if place.endswith(_REAL):
            name = name.removesuffix(_REAL)
            values = _complex(values, file[place.removesuffix(_REAL) + _IMAGINARY][()])
        dims, coords = _labels(name, dataset)
        unit, words = (str(dataset.attrs.get(key, "")) for key in ("units", "long_name"))
        yield name, LabelledArray(name, values, dims, unit, words, coords)


def _complex(real: Any, imaginary: Any) -> Any:
    """Return complex numbers of both parts.

    Raises
    ------
    ValueError
        If their shapes differ.
    """
    if np.shape(real) != np.shape(imaginary):
        raise ValueError(f"parts of shapes {np.shape(real)} and {np.shape(imaginary)}")
    found = np.asarray(real).astype(complex)
    found.imag = imaginary  # 1j * infinity would be no number
    return found


def _is_data(item: Any) -> bool:
    return isinstance(item, h5py.Dataset) and not is_bare(item)


def _values(dataset: h5py.Dataset) -> Any:
    if h5py.check_string_dtype(dataset.dtype) is not None:
        return np.array(dataset.asstr()[()], dtype=object)
    return dataset[()]


def _labels(name: str, dataset: h5py.Dataset) -> tuple[tuple[str, ...], dict[str, LabelledArray]]:
    """Return the names of the dimensions and what labels them."""
    if dataset.is_scale:
        return (name,), {}
    dims, coords = [], {}
    for axis, scale in enumerate(_scales(dataset)):
        if scale is None:
            dims.append(name if dataset.ndim == 1 else f"{name}_axis_{axis}")
            continue
        label = scale.name.strip("/").replace("/", ".")
        dims.append(label)
        words = {key: str(scale.attrs.get(key, "")) for key in ("units", "long_name")}
        values = _values(scale)
        if is_bare(scale):
            continue
        coords[label] = LabelledArray(label, values, (label,), words["units"], words["long_name"])
    return tuple(dims), coords


def _scales(dataset: h5py.Dataset) -> list[h5py.Dataset | None]:
    """Return the first scale of each dimension, None for those without one.

    The list is read as any attribute: HDF5's own functions for scales crash on damaged ones.
    """
    if _SCALES not in dataset.attrs:
        return [None] * dataset.ndim
    lists = dataset.attrs[_SCALES]
    if len(lists) != dataset.ndim:
        raise DamagedError(f"{dataset.name} names the scales of {len(lists)} dimensions")
    scales = [dataset.file[found[0]] if len(found) else None for found in lists]
    if any(not isinstance(scale, h5py.Dataset | None) for scale in scales):
        raise DamagedError(f"a scale of {dataset.name} is no data set")
    return scales


def _by_name(path: Path) -> dict[str, LabelledArray]:
    """Return the values of an equilibrium one by one, by the names of channels."""
    table = equilibrium_table.read_equilibrium(path)
    pairs = [
        *zip(table.coordinates, table.coordinate_values[1], strict=True),
        *zip(table.forces, table.force_values[1], strict=True),
        *zip(table.channels, table.channel_values[1], strict=True),
    ]
    return {
        item.name: LabelledArray(item.name, np.asarray(value), (), item.unit, item.description)
        for item, value in pairs
    }


def _stacked(found: Mapping[str, LabelledArray], path: Path) -> dict[str, LabelledArray]:
    """Return the modes of all cases in one array a quantity, missing modes as not a number."""
    table = mode_table.read_modes(path)
    labels = np.array([case.label for case in table.cases], dtype=object)
    case = LabelledArray("case", labels, ("case",), "", "Case")
    counts = [len(item.kind) for item in table.cases]
    most = max(counts)
    mode = LabelledArray("mode", np.arange(1, most + 1), ("mode",), "", "Number of the mode")
    arrays = {name: array for name, array in found.items() if not _CASE.match(name)}
    speeds = np.array([item.speed for item in table.cases])
    coords = {"case": case, "mode": mode}
    arrays |= {"case": case, "mode": mode}
    arrays["speed"] = LabelledArray("speed", speeds, ("case",), "m/s", "Speed", {"case": case})
    for name in dict.fromkeys(_CASE.sub("", name) for name in found if _CASE.match(name)):
        parts = [found.get(f"case_{k}.{name}") for k in range(1, len(table.cases) + 1)]
        known = next(part for part in parts if part is not None)
        if name == "mode":
            continue
        values = [None if part is None else part.values for part in parts]
        _refuse_others(path, name, values, counts)
        padded = _padded(values, most)
        dims = ("case", "mode", *known.dims[1:])
        labels_of = {dim: coords.get(dim, known.coords.get(dim)) for dim in dims}
        kept = {dim: label for dim, label in labels_of.items() if label is not None}
        arrays[name] = LabelledArray(name, padded, dims, known.unit, known.description, kept)
    return arrays


def _refuse_others(path: Path, name: str, parts: Sequence[Any], counts: Sequence[int]) -> None:
    """Raise an InputError unless each part has a row a mode and all are of one kind.

    What is made from other numbers of the file is read by nobody who would see it.
    """
    known = next(part for part in parts if part is not None)
    for part, count in zip(parts, counts, strict=True):
        if part is None or (
            part.shape == (count, *known.shape[1:])
            and part.dtype.kind == known.dtype.kind
            and part.dtype.kind in "fcO"
        ):
            continue
        raise InputError(
            f"{path}: is damaged ({name} of shape {part.shape} and type {part.dtype} for "
            f"{count} modes); compute it again"
        )


def _padded(parts: Sequence[Any], most: int) -> Any:
    known = next(part for part in parts if part is not None)
    empty: Any = "" if known.dtype == object else np.nan
    whole = np.full((len(parts), most, *known.shape[1:]), empty, dtype=known.dtype)
    for number, part in enumerate(parts):
        if part is not None:
            whole[number, : len(part)] = part
    return whole
