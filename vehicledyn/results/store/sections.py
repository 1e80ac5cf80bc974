"""The sections of a result file, each written by one function."""

from __future__ import annotations

import json
import platform
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from importlib import metadata
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.version import VERSION
from vehicledyn.results.store.layout import (
    FORMAT,
    FORMAT_VERSION,
    Described,
    EventRecord,
    ResultHeader,
    SceneItem,
    SummaryEntry,
    attribute,
    clean_text,
    dataset_path,
)

PACKAGES = ("casadi", "h5py", "numpy")
STATE_ROWS = 256  # most samples in a chunk of the states, rarely read column by column


def write_header(file: h5py.File, header: ResultHeader) -> None:
    """Write all that is known before the run starts, with status running."""
    write_attributes(
        file,
        {
            "format": FORMAT,
            "format_version": FORMAT_VERSION,
            "title": header.title,
            "status": "running",
            "status_message": "",
            "created": datetime.now(UTC).isoformat(timespec="seconds"),
            "vehicledyn_version": VERSION,
            "model": header.model,
            "model_hash": header.model_hash,
        },
    )
    write_attributes(file.create_group("versions"), {**_versions(), **header.versions})
    _write_text(file, "scenario/text", header.scenario_text)
    configuration = json.dumps(header.configuration, default=str, ensure_ascii=False)
    _write_text(file, "scenario/configuration", configuration)
    parameters = {"equations": header.equations_hash, "values": dict(header.parameters)}
    _write_text(file, "scenario/parameters", json.dumps(parameters, ensure_ascii=False))
    sources = [dict(source) for source in header.sources]
    _write_text(file, "scenario/sources", json.dumps(sources, ensure_ascii=False))
    plots = [dict(plot) for plot in header.plots]
    _write_text(file, "plots/descriptions", json.dumps(plots, ensure_ascii=False))
    scene = file.create_group("scene", track_order=True)
    for name, item in header.scene.items():
        _write_scene_item(scene, name, item)


def create_column(
    file: h5py.File, quantity: Described, chunk: int, scale: h5py.Dataset | None
) -> h5py.Dataset:
    """Create the growing dataset of a channel; without a scale it is the time itself."""
    dataset = file.create_dataset(
        dataset_path(quantity.name),
        (0,),
        "f8",
        maxshape=(None,),
        chunks=(chunk,),
        fillvalue=np.nan,
    )
    write_attributes(dataset, {"units": quantity.unit, "long_name": quantity.description})
    if scale is None:
        dataset.make_scale(quantity.name)
    else:
        dataset.dims[0].attach_scale(scale)
    return dataset


def create_states(
    group: h5py.Group, states: Sequence[Described], chunk: int, time: h5py.Dataset
) -> h5py.Dataset | None:
    """Create the growing table of states and the texts that name its columns."""
    if not states:
        return None
    names = _write_texts(group, "name", (state.name for state in states))
    names.make_scale("name")
    units = _write_texts(group, "units", (state.unit for state in states))
    meanings = _write_texts(group, "long_name", (state.description for state in states))
    units.dims[0].attach_scale(names)
    meanings.dims[0].attach_scale(names)
    value = group.create_dataset(
        "value",
        (0, len(states)),
        "f8",
        maxshape=(None, len(states)),
        chunks=(min(chunk, STATE_ROWS), len(states)),
        fillvalue=np.nan,
    )
    value.dims[0].attach_scale(time)
    value.dims[1].attach_scale(names)
    return value


def extend(dataset: h5py.Dataset, start: int, values: NDArray[np.float64]) -> None:
    """Append rows to a growing dataset that has ``start`` rows.

    Speaks to HDF5 directly: a call a channel and chunk is what writing costs.
    """
    shape = values.shape
    dataset.id.set_extent((start + shape[0], *shape[1:]))
    place = dataset.id.get_space()
    place.select_hyperslab((start, *(0 for _ in shape[1:])), shape)
    dataset.id.write(h5py.h5s.create_simple(shape), place, values)


def write_summary(group: h5py.Group, summary: Sequence[SummaryEntry]) -> None:
    """Write the summary's entries as scalar datasets; an attribute keeps their order."""
    write_names(group, "entries", [entry.name for entry in summary])
    for entry in summary:
        place = dataset_path(entry.name)[1:]
        if isinstance(entry.value, str):
            dataset = _write_text(group, place, entry.value)
        elif isinstance(entry.value, bool | np.bool_):
            dataset = group.create_dataset(place, data=np.int8(entry.value))
            dataset.attrs["dtype"] = "bool"  # as xarray marks truth values
        else:
            dataset = group.create_dataset(place, data=entry.value)
        write_attributes(dataset, {"units": entry.unit, "long_name": entry.description})


def write_events(group: h5py.Group, events: Sequence[EventRecord]) -> None:
    """Write instants and names of the events that happened."""
    if not events:
        return
    instants = group.create_dataset("at", data=np.array([event.time for event in events], float))
    write_attributes(instants, {"units": "s", "long_name": "Instant of the event"})
    instants.make_scale("at")
    names = _write_texts(group, "name", (event.name for event in events))
    names.dims[0].attach_scale(instants)


def write_notes(group: h5py.Group, notes: Sequence[str]) -> None:
    """Write the messages of the run to its user."""
    if notes:
        _write_texts(group, "notes", notes)


def write_names(place: h5py.Group, attribute_name: str, names: Sequence[str]) -> None:
    """Write names as an attribute, in their order."""
    place.attrs[attribute_name] = np.array(names, dtype=h5py.string_dtype())


def write_attributes(place: h5py.Group | h5py.Dataset, values: Mapping[str, Any]) -> None:
    """Write attributes; values that are None are left out."""
    for name, value in values.items():
        if value is not None:
            place.attrs[name] = attribute(value)


def _write_scene_item(scene: h5py.Group, name: str, item: SceneItem) -> None:
    values = np.asarray(item.values, dtype=float)
    dataset = scene.create_dataset(name, data=values)
    write_attributes(
        dataset, {"units": item.unit, "long_name": item.description, **item.attributes}
    )
    for axis, length in enumerate(values.shape):
        scale = scene.create_dataset(f"{name}_axis_{axis}", data=np.arange(length))
        scale.make_scale(f"{name}_axis_{axis}")
        dataset.dims[axis].attach_scale(scale)


def _write_text(place: h5py.Group, name: str, text: str) -> h5py.Dataset:
    return place.create_dataset(name, data=clean_text(text), dtype=h5py.string_dtype())


def _write_texts(place: h5py.Group, name: str, texts: Iterable[str]) -> h5py.Dataset:
    cleaned = [clean_text(text) for text in texts]
    return place.create_dataset(name, data=cleaned, dtype=h5py.string_dtype())


def _versions() -> dict[str, str]:
    versions = {"python": platform.python_version()}
    for package in PACKAGES:
        try:
            versions[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            versions[package] = "unknown"
    return versions
