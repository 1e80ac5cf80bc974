"""Values of a result file as Python has them: columns, tables, entries of its sections."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.store.layout import SceneItem, SummaryEntry

Floats = NDArray[np.float64]

_PLACES = ("cones", "outline")
_FARTHEST = 1e12  # m


@dataclass(frozen=True)
class Series:
    """One channel: SI values of shape (n_times,), with unit, meaning and frame."""

    name: str
    values: Floats
    unit: str
    description: str
    frame: str


@dataclass(frozen=True)
class StateTable:
    """States and algebraic unknowns by column; ``values`` has shape (n_times, n_states)."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Floats


def texts(dataset: h5py.Dataset) -> tuple[str, ...]:
    """Return the texts of a dataset."""
    return tuple(str(text) for text in dataset.asstr()[()])


def entry(name: str, dataset: h5py.Dataset) -> SummaryEntry:
    """Return an entry of the summary."""
    unit, meaning = str(dataset.attrs["units"]), str(dataset.attrs["long_name"])
    return SummaryEntry(name, _scalar(dataset), unit, meaning)


def _scalar(dataset: h5py.Dataset) -> float | int | bool | str:
    is_text = h5py.check_string_dtype(dataset.dtype) is not None
    if dataset.shape != () or not (is_text or dataset.dtype.kind in "biuf"):
        raise ValueError(f"{dataset.name.lstrip('/')} is neither number nor text")
    if is_text:
        return str(dataset.asstr()[()])
    value: float | int = dataset[()].item()
    return bool(value) if dataset.attrs.get("dtype") == "bool" else value


def scene_item(dataset: h5py.Dataset) -> SceneItem:
    """Return an item of the scene; raise ValueError for what is no table of places."""
    own = {"units", "long_name", "DIMENSION_LIST"}
    values = np.asarray(dataset[()], dtype=float)
    name = dataset.name.rpartition("/")[2]
    if name in _PLACES and (values.ndim != 2 or values.shape[1] != 2):
        raise ValueError(f"scene/{name} has the shape {values.shape}, not (n, 2)")
    if not (np.abs(values) <= _FARTHEST).all():
        raise ValueError(f"scene/{name} holds what is no number or farther than {_FARTHEST:g} m")
    attributes = {k: plain(v) for k, v in dataset.attrs.items() if k not in own}
    if not isinstance(attributes.get("radius", 0.0), float | int):
        raise ValueError(f"scene/{name}: its radius is no number")
    return SceneItem(
        values=values,
        unit=str(dataset.attrs["units"]),
        description=str(dataset.attrs["long_name"]),
        attributes=attributes,
    )


def fact(name: str, value: Any) -> float | int | bool | str:
    """Return a number or text; raise ValueError for what is neither."""
    found = plain(value)
    if not isinstance(found, float | int | bool | str):
        raise ValueError(f"its fact '{name}' is neither number nor text")
    return found


def plain(value: Any) -> Any:
    """Return a value of an attribute as a plain one."""
    return value.item() if isinstance(value, np.generic) else value
