"""What a run was at its last samples, kept in its file so that it can be continued.

Two rows of ``/restart/history`` take turns, so that a kill leaves one of them whole: time of a
sample [s], number of numbers, how many of those kept belong to it and their checksum, and the
numbers that the method goes on with. ``/restart/crc`` holds the checksums of the rows.
``/restart/event_at, event_name`` are the events so far, which stand in ``/events`` only when the
run has ended. ``/restart/kept`` are numbers that histories build on, such as where equations were
derived anew.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from typing import NamedTuple

import h5py
import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.store.layout import RESTART, EventRecord
from vehicledyn.results.store.values import texts

Floats = NDArray[np.float64]

_NAME_BYTES = 256
_EVENTS = 64  # in a chunk
_KEPT = 1024  # in a chunk
_HEAD = 4


class History(NamedTuple):
    """Time of a sample [s], what the method goes on with from there, and how much was kept then.

    ``kept`` is the length of what was kept, and its checksum.
    """

    time: float
    numbers: Floats
    kept: tuple[int, int] = (0, 0)


class HistoryDatasets:
    """The datasets of the section while a result is written, for up to ``most`` numbers."""

    def __init__(self, file: h5py.File, most: int) -> None:
        group = file.create_group(RESTART)
        slot = _scale(group, "slot", 2)
        number = _scale(group, "number", _HEAD + most)
        self._rows = group.create_dataset(
            "history", (2, _HEAD + most), "f8", chunks=(1, _HEAD + most), fillvalue=np.nan
        )
        self._rows.dims[0].attach_scale(slot)
        self._rows.dims[1].attach_scale(number)
        self._crc = group.create_dataset("crc", (2,), "u4")
        self._crc.dims[0].attach_scale(slot)
        self._at = group.create_dataset("event_at", (0,), "f8", maxshape=(None,), chunks=(_EVENTS,))
        self._at.make_scale("event_at")
        self._name = group.create_dataset(
            "event_name", (0,), f"S{_NAME_BYTES}", maxshape=(None,), chunks=(_EVENTS,)
        )
        self._name.dims[0].attach_scale(self._at)
        self._kept = group.create_dataset("kept", (0,), "f8", maxshape=(None,), chunks=(_KEPT,))
        self._kept.make_scale("kept")
        self._next = 0
        self._pending: list[Floats] = []
        self._noted: list[History] = []
        self.kept_so_far = (0, 0)

    def note(self, history: History) -> None:
        """Note a history, with what has been kept so far."""
        self._noted.append(history._replace(kept=self.kept_so_far))

    def latest(self, time: float) -> History | None:
        """Return the last of what was noted up to a time [s], and forget what is older."""
        found = [history for history in self._noted if history.time <= time]
        self._noted = self._noted[len(found) :]
        return found[-1] if found else None

    def write(self, history: History) -> None:
        """Write a history over the older one of two."""
        self._append(self._kept)
        self._put(self._rows, self._crc, history)

    def write_last(self, file: h5py.File, history: History) -> None:
        """Write a history when the file is finished."""
        self._append(file[RESTART]["kept"])
        self._put(file[RESTART]["history"], file[RESTART]["crc"], history)

    def _put(self, rows: h5py.Dataset, sums: h5py.Dataset, history: History) -> None:
        row = np.full(rows.shape[1], np.nan)
        row[:_HEAD] = history.time, len(history.numbers), *history.kept
        row[_HEAD : _HEAD + len(history.numbers)] = history.numbers
        rows[self._next] = row
        sums[self._next] = zlib.crc32(row.data)
        self._next = 1 - self._next

    def keep(self, numbers: Floats) -> None:
        """Keep numbers that later histories build on; they are written before those."""
        length, crc = self.kept_so_far
        self.kept_so_far = (length + len(numbers), zlib.crc32(numbers.tobytes(), crc))
        self._pending.append(numbers)

    def _append(self, kept: h5py.Dataset) -> None:
        if self._pending:
            numbers = np.concatenate(self._pending)
            start = len(kept)
            kept.resize(start + len(numbers), axis=0)
            kept[start:] = numbers
            self._pending.clear()

    def add_events(self, events: Sequence[EventRecord]) -> None:
        """Append events; the times come last."""
        start, stop = len(self._at), len(self._at) + len(events)
        self._name.resize(stop, axis=0)
        self._name[start:] = [event.name.encode()[:_NAME_BYTES] for event in events]
        self._at.resize(stop, axis=0)
        self._at[start:] = [event.time for event in events]


def read_history(file: h5py.File, latest: float) -> History | None:
    """Return the last whole history up to a time [s], None if there is none.

    Files from before numbers were kept hold histories of other parts, from which no run goes on.
    """
    if RESTART not in file or "kept" not in file[RESTART]:
        return None
    rows, sums = file[RESTART]["history"][()], file[RESTART]["crc"][()]
    kept = read_kept(file)
    found = [
        History(
            float(row[0]),
            row[_HEAD : _HEAD + int(row[1])].copy(),
            (int(row[2]), int(row[3])),
        )
        for row, crc in zip(rows, sums, strict=True)
        if len(row) >= _HEAD
        and np.isfinite(row[:_HEAD]).all()
        and zlib.crc32(row.data) == crc
        and row[0] <= latest
        and zlib.crc32(kept[: int(row[2])].tobytes()) == row[3]
    ]
    return max(found, key=lambda history: history.time, default=None)


def read_kept(file: h5py.File) -> Floats:
    """Return the numbers that histories build on."""
    if RESTART not in file or "kept" not in file[RESTART]:
        return np.zeros(0)
    return np.asarray(file[RESTART]["kept"][()], dtype=float)


def read_events(file: h5py.File) -> list[EventRecord]:
    """Return the events of a run that has not ended."""
    if RESTART not in file:
        return []
    group = file[RESTART]
    pairs = zip(group["event_at"][()].tolist(), group["event_name"][()], strict=False)
    return [EventRecord(at, bytes(name).decode("utf-8", "replace")) for at, name in pairs]


def read_ended_events(file: h5py.File) -> list[EventRecord]:
    """Return the events of a run that has ended."""
    group = file["events"]
    if "at" not in group:
        return []
    pairs = zip(group["at"][()].tolist(), texts(group["name"]), strict=True)
    return [EventRecord(at, name) for at, name in pairs]


def _scale(group: h5py.Group, name: str, length: int) -> h5py.Dataset:
    dataset = group.create_dataset(name, data=np.arange(length))
    dataset.make_scale(name)
    return dataset
