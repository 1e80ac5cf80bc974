"""The samples that a run's key figures are made from, kept on the disk and not in memory."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from typing import IO

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.store.writer import ResultWriter
from vehicledyn.road.manoeuvres.channel_recorder import Recording

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
        """Return what the writer's file holds so far, column by column as they are asked for."""
        columns = _Columns(self, writer)
        return Recording(writer.column("time"), columns, self._units)

    @property
    def names(self) -> list[str]:
        """Names of the channels."""
        return self._names

    def column(self, name: str, writer: ResultWriter) -> Matrix:
        """Return a channel over all samples that the writer has written, shape (n,)."""
        if name not in self._columns:
            return writer.column(name)
        if self._file is None:
            return np.empty(0)
        parts, begin, place = [], 0, self._columns[name]
        for rows in self._rows:
            self._file.seek(8 * (begin + place * rows))
            parts.append(np.frombuffer(self._file.read(8 * rows)))
            begin += rows * len(self._spooled)
        self._file.seek(8 * begin)
        return np.concatenate(parts)[: writer.samples] if parts else np.empty(0)


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
