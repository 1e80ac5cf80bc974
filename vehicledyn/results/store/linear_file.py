"""What result files of linear analyses share: header, texts, complex numbers, safe writing.

They are HDF5 with dimension scales, as the results of runs are, but of another format: no time.
NetCDF knows no complex numbers, so these are pairs of datasets ``<name>_real, <name>_imag``.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.base.version import VERSION
from vehicledyn.results.hdf5.damage import reading
from vehicledyn.results.hdf5.disk import Container
from vehicledyn.results.hdf5.opening import open_file
from vehicledyn.results.hdf5.output import check_output, write_failed
from vehicledyn.results.hdf5.seal import seal
from vehicledyn.results.store.consistency import require_stored
from vehicledyn.results.store.dimensions import name_dimensions
from vehicledyn.results.store.layout import clean_text
from vehicledyn.results.store.sections import write_attributes

FORMAT_VERSION = 1


@dataclass(frozen=True)
class Quantity:
    """Name, unit and meaning of a state, channel or input."""

    name: str
    unit: str
    description: str


@contextlib.contextmanager
def new_file(path: Path, kind: str, attributes: dict[str, Any]) -> Iterator[h5py.File]:
    """Give a new file of a format to write into; it takes its name when it is complete.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    target = check_output(path)
    scratch = target.with_name(f".{target.name}.new")
    try:
        container = Container(scratch, new=True)
        with contextlib.closing(container):
            file = container.file
            head = {
                "format": kind,
                "format_version": FORMAT_VERSION,
                "created": datetime.now(UTC).isoformat(timespec="seconds"),
                "vehicledyn_version": VERSION,
            }
            write_attributes(file, head | attributes)
            yield file
            name_dimensions(file)
        seal(scratch)
        scratch.replace(target)
    except (OSError, RuntimeError) as error:
        raise write_failed(target, error) from error
    finally:
        scratch.unlink(missing_ok=True)


@contextlib.contextmanager
def old_file(path: Path, kind: str) -> Iterator[h5py.File]:
    """Give a file of a format to read from.

    Raises
    ------
    InputError
        If there is no such file, or it is damaged, of another format or a newer version.
    """
    with reading(path, advice="compute it again"):
        file = open_file(Path(path))
    with file, reading(path, file, "compute it again"):
        found = str(file.attrs.get("format", ""))
        if found != kind:
            file.check()
            raise InputError(f"{path}: holds no {kind} data (its format is '{found or 'unknown'}')")
        if int(file.attrs["format_version"]) > FORMAT_VERSION:
            raise InputError(f"{path}: is of a newer version; update vehicledyn")
        require_stored(file)
        yield file


def format_of(path: Path) -> str:
    """Return the format that an HDF5 file names, empty if it names none or is none."""
    try:
        with open_file(Path(path)) as file:
            return str(file.attrs.get("format", ""))
    except (InputError, OSError, RuntimeError, KeyError, ValueError):
        return ""


def write_quantities(file: h5py.File, place: str, quantities: Sequence[Quantity]) -> h5py.Dataset:
    """Write names as a dimension scale ``place``, units and meanings beside; return the scale."""
    scale = write_texts(file, place, [quantity.name for quantity in quantities])
    scale.make_scale(place.rpartition("/")[2])
    for suffix, texts in (
        ("units", [quantity.unit for quantity in quantities]),
        ("long_name", [quantity.description for quantity in quantities]),
    ):
        write_texts(file, f"{place}_{suffix}", texts).dims[0].attach_scale(scale)
    return scale


def read_quantities(file: h5py.File, place: str) -> tuple[Quantity, ...]:
    """Return what :func:`write_quantities` wrote."""
    columns = [read_texts(file, f"{place}{suffix}") for suffix in ("", "_units", "_long_name")]
    return tuple(Quantity(*texts) for texts in zip(*columns, strict=True))


def write_texts(group: h5py.Group, name: str, texts: Sequence[str]) -> h5py.Dataset:
    """Write a list of texts."""
    cleaned = [clean_text(text) for text in texts]
    return group.create_dataset(name, (len(cleaned),), h5py.string_dtype(), data=cleaned or None)


def read_texts(group: h5py.Group, name: str) -> list[str]:
    """Return a list of texts."""
    return [str(text) for text in group[name].asstr()[()]]


def write_axis(group: h5py.Group, name: str, values: Any, words: tuple[str, str]) -> h5py.Dataset:
    """Write values as a dimension scale with unit and meaning; return the scale."""
    scale = group.create_dataset(name, data=np.asarray(values))
    write_attributes(scale, {"units": words[0], "long_name": words[1]})
    scale.make_scale(name)
    return scale


def write_numbers(
    group: h5py.Group,
    name: str,
    values: Any,
    scales: Sequence[h5py.Dataset],
    words: tuple[str, str],
) -> None:
    """Write an array with its dimension scales, unit and meaning; complex ones as two."""
    array = np.asarray(values)
    if np.iscomplexobj(array):
        for suffix, part in (("real", array.real), ("imag", array.imag)):
            write_numbers(group, f"{name}_{suffix}", part, scales, words)
        return
    dataset = group.create_dataset(name, data=np.asarray(array, dtype=float))
    write_attributes(dataset, {"units": words[0], "long_name": words[1]})
    for axis, scale in enumerate(scales):
        dataset.dims[axis].attach_scale(scale)


def read_complex(group: h5py.Group, name: str) -> Any:
    """Return an array of complex numbers.

    Raises
    ------
    ValueError
        If one of its two parts holds no real numbers.
    """
    real, imaginary = (group[f"{name}_{part}"][()] for part in ("real", "imag"))
    if {real.dtype.kind, imaginary.dtype.kind} - set("fiu"):
        raise ValueError(f"{name} holds no real numbers")
    values = np.array(real, dtype=complex)
    values.imag = imaginary
    return values
