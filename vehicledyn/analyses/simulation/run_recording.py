"""The samples that a run's key figures are made from, kept on the disk and not in memory."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import IO

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.store.writer import ResultWriter
from vehicledyn.road.manoeuvres.channel_recorder import ChannelRows, Recording

Matrix = NDArray[np.float64]


class RunRecording:
    """Collects some columns of the outputs of a run.

    Parameters
    ----------
    names, units
        Names of all channels, and their units.
    kept
        Channels that the result file holds, which are read from there.
    needed
        Channels that the key figures are made from; those not kept go to a temporary file.
    """

    def __init__(
        self, names: Sequence[str], units: Sequence[str], kept: Sequence[int], needed: Sequence[int]
    ) -> None:
        self._names = [names[k] for k in needed]
        self._units = {names[k]: units[k] for k in needed}
        in_file = set(kept)
        self._spooled = [k for k in needed if k not in in_file]
        self._columns = {names[k]: place for place, k in enumerate(self._spooled)}
        self._file: IO[bytes] | None = None
        self._rows: list[int] = []

    def add(self, outputs: Matrix) -> None:
        """Add samples, outputs of shape (n, n_channels)."""
        if self._spooled:
            self._file = self._file or tempfile.TemporaryFile()  # noqa: SIM115
            self._file.write(np.ascontiguousarray(outputs[:, self._spooled].T).tobytes())
            self._rows.append(len(outputs))

    def close(self) -> None:
        """Give the temporary file up."""
        if self._file is not None:
            self._file.close()

    def of(self, writer: ResultWriter) -> Recording:
        """Return what the writer's file holds so far, read as it is asked for."""
        return _RecordingOnDisk(self, writer, self._units)

    @property
    def names(self) -> list[str]:
        """Names of the channels."""
        return self._names

    def column(
        self, name: str, writer: ResultWriter, start: int = 0, stop: int | None = None
    ) -> Matrix:
        """Return a channel from one sample up to another of those that the writer has written."""
        end = writer.samples if stop is None else min(stop, writer.samples)
        if name not in self._columns:
            return writer.column(name, start, end)
        return np.concatenate([np.empty(0), *self._spooled_parts(self._columns[name], start, end)])

    def _spooled_parts(self, place: int, start: int, stop: int) -> Iterator[Matrix]:
        """Yield the parts of a column in the temporary file from one sample up to another."""
        if self._file is None:
            return
        self._file.flush()
        number, row, width = self._file.fileno(), 0, len(self._spooled)
        for rows in self._rows:
            first, last = max(start - row, 0), min(stop - row, rows)
            if first < last:
                at = 8 * (row * width + place * rows + first)
                yield np.frombuffer(os.pread(number, 8 * (last - first), at))
            row += rows


class _RecordingOnDisk(Recording):
    """Samples that are read when asked for."""

    def __init__(
        self, recording: RunRecording, writer: ResultWriter, units: dict[str, str]
    ) -> None:
        super().__init__(np.empty(0), _Columns(recording, writer), units)
        self._recording, self._writer = recording, writer

    @property
    def time(self) -> Matrix:
        """Times of all samples, read anew each time [s]."""
        return self._writer.column("time")

    @property
    def count(self) -> int:
        """Number of samples."""
        return self._writer.samples

    def rows(self, names: Iterable[str], start: int, stop: int) -> ChannelRows:
        """Return some channels from one sample up to another."""
        read = self._recording.column
        values = {name: read(name, self._writer, start, stop) for name in names}
        return ChannelRows(self._writer.column("time", start, stop), values)


class _Columns(Mapping[str, Matrix]):
    """Channels by name, read when asked for."""

    def __init__(self, recording: RunRecording, writer: ResultWriter) -> None:
        self._recording, self._writer = recording, writer

    def __getitem__(self, name: str) -> Matrix:
        if name not in self._recording.names:
            raise KeyError(name)
        return self._recording.column(name, self._writer)

    def __iter__(self) -> Iterator[str]:
        return iter(self._recording.names)

    def __len__(self) -> int:
        return len(self._recording.names)
