"""What a summary is made from: the channels a manoeuvre asked for, over all samples of a run."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

BLOCK = 1 << 15
"""Samples that are read at once."""


class ChannelRows(NamedTuple):
    """Samples next to each other: times, shape (n,) [s], and channels by name, shape (n,)."""

    time: NDArray[np.float64]
    channels: dict[str, NDArray[np.float64]]


class Recording:
    """Samples of a run.

    Parameters
    ----------
    time
        Times, shape (n,) [s].
    channels
        Channels by name, shape (n,), in SI.
    units
        Units of the channels, by name.
    """

    def __init__(
        self,
        time: NDArray[np.float64],
        channels: Mapping[str, NDArray[np.float64]],
        units: Mapping[str, str] | None = None,
    ) -> None:
        self._time = time
        self.channels = channels
        self.units = dict(units or {})

    @property
    def time(self) -> NDArray[np.float64]:
        """Times of all samples, shape (n,) [s]."""
        return self._time

    @property
    def count(self) -> int:
        """Number of samples."""
        return len(self.time)

    def rows(self, names: Iterable[str], start: int, stop: int) -> ChannelRows:
        """Return some channels from sample ``start`` up to ``stop``, in memory for these only."""
        values = {name: self.channels[name][start:stop] for name in names}
        return ChannelRows(self.time[start:stop], values)

    def column(self, name: str) -> RecordedColumn:
        """Return a channel, or "time", to be read in slices."""
        return RecordedColumn(self, name)

    def blocks(self, names: Iterable[str]) -> Iterator[ChannelRows]:
        """Yield some channels block by block, so that memory stays bounded in long runs."""
        wanted = list(names)
        for start in range(0, self.count, BLOCK):
            yield self.rows(wanted, start, min(start + BLOCK, self.count))


class RecordedColumn:
    """A channel of a recording, or "time", of which slices are read."""

    def __init__(self, recording: Recording, name: str) -> None:
        self._recording, self._name = recording, name

    def __len__(self) -> int:
        return self._recording.count

    def __getitem__(self, part: slice) -> NDArray[np.float64]:
        start, stop, _ = part.indices(len(self))
        if self._name == "time":
            return self._recording.rows((), start, stop).time
        return self._recording.rows((self._name,), start, stop).channels[self._name]
