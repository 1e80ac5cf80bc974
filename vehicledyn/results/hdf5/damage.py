"""Messages for damaged files: what of them is damaged, in words of their reader."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py

from vehicledyn.base.errors import InputError
from vehicledyn.results.hdf5.opening import noticing_damage
from vehicledyn.results.hdf5.seal import DamagedError

BROKEN = (OSError, LookupError, RuntimeError, ValueError, TypeError, AttributeError)
"""What h5py and numpy raise on files that do not hold what they should."""


@contextlib.contextmanager
def reading(
    path: Path, file: h5py.File | None = None, advice: str = "run it again"
) -> Iterator[None]:
    """Turn what is found on broken files into one clear message.

    Parameters
    ----------
    path
        The file.
    file
        The open file, whose damage is noticed also where HDF5 sees none.
    advice
        What to do about a damaged file.

    Raises
    ------
    InputError
        If the file is damaged or being written.
    """
    try:
        with noticing_damage(file):
            yield
    except BlockingIOError as error:
        raise InputError(f"{path}: another program is writing this file; try later") from error
    except DamagedError as error:
        what = describe(error, file)
        raise InputError(f"{path}: is damaged ({what}); {advice}") from error
    except BROKEN as error:
        detail = str(error).strip("\"'")
        raise InputError(f"{path}: is damaged ({detail}); {advice}") from error


def describe(error: DamagedError, file: h5py.File | None) -> str:
    """Return what is damaged: the message, and the dataset and its rows if they are known."""
    if file is None or error.last <= error.first:
        return str(error)
    found: list[str] = []

    def look(name: str, item: Any) -> bool | None:
        if isinstance(item, h5py.Dataset):
            rows = _rows(item, error.first, error.last)
            if rows is not None:
                found.append(name.replace("/", ".") + _span(file, *rows))
        return len(found) > _MOST or None

    with contextlib.suppress(*BROKEN):
        file.visititems(look)
    # Looking around may have met further damage; the first is reported.
    with contextlib.suppress(DamagedError):
        file.check()
    if not found:
        return f"{error}, in the structure of the file"
    more = " and others" if len(found) > _MOST else ""
    return f"{error}: {'; '.join(found[:_MOST])}{more}"


def rows_in_words(file: h5py.File, name: str, first: int, stop: int) -> str:
    """Return a column and some of its rows as words, with their times if these can be read."""
    return name + _span(file, first, stop)


_MOST = 3


def _rows(dataset: h5py.Dataset, first: int, last: int) -> tuple[int, int] | None:
    """Return the rows of a dataset that have bytes in a part of the file, (0, 0) for no rows."""
    if dataset.chunks is None:
        start, size = dataset.id.get_offset(), dataset.id.get_storage_size()
        return (0, 0) if start is not None and start < last and start + size > first else None
    rows = []
    for number in range(dataset.id.get_num_chunks()):
        chunk = dataset.id.get_chunk_info(number)
        if chunk.byte_offset < last and chunk.byte_offset + chunk.size > first:
            rows.append(chunk.chunk_offset[0])
    if not rows:
        return None
    return min(rows), min(max(rows) + dataset.chunks[0], dataset.shape[0])


def _span(file: h5py.File, first: int, stop: int) -> str:
    if stop <= first:
        return ""
    text = f", rows {first + 1} to {stop}"
    with contextlib.suppress(*BROKEN):
        time = file["time"]
        if time.attrs.get("units") == "s" and stop <= len(time):
            text += f" (t = {time[first]:.6g} to {time[stop - 1]:.6g} s)"
    return text
