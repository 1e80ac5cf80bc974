"""Writing a result while it is computed, so that a killed run keeps what it had."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.base.interrupts import undisturbed
from vehicledyn.results.hdf5.disk import Container
from vehicledyn.results.hdf5.finishing import Reserve, finish
from vehicledyn.results.hdf5.output import OutputLock, check_output, free_space, write_failed
from vehicledyn.results.hdf5.text_checksums import write_text_sum
from vehicledyn.results.store import sections
from vehicledyn.results.store.animation_section import (
    GROUP,
    PictureDatasets,
    Pictures,
    Surroundings,
    write_surroundings,
)
from vehicledyn.results.store.animation_stage import Stage
from vehicledyn.results.store.history import History, HistoryDatasets
from vehicledyn.results.store.layout import (
    STATUSES,
    Described,
    EventRecord,
    Framed,
    ResultHeader,
    SummaryEntry,
    check_names,
    clean_text,
    dataset_path,
)
from vehicledyn.results.store.row_checksums import RowSums, cut_samples
from vehicledyn.results.store.sample_blocks import SampleBlock, checked_block

LARGEST_CHUNK = 1024  # samples
LARGEST_BUFFER = 4096  # samples
AMPLE = 1 << 26  # bytes
CACHE = 1 << 16  # bytes of a dataset
FLUSH_INTERVAL = 0.5  # s of wall time

Floats = NDArray[np.float64]


class ResultWriter(contextlib.AbstractContextManager["ResultWriter"]):
    """Writes one result file; use it in a ``with`` statement.

    The file appears under its name at once, with status ``running``, and replaces an older
    one. It is readable at any time, also after the process was killed. :meth:`close` gives
    it its final status in one atomic step and seals it with checksums. Leaving the ``with``
    block by an error closes it as failed, by Ctrl-C as interrupted.

    A little space on the disk is kept for the end: after the disk has filled up, the file can
    still be closed, with its summary.

    Parameters
    ----------
    path
        Output file.
    channels
        Channels in the order of the columns of :meth:`append`.
    header
        What is known of the run before it starts.
    states
        States and algebraic unknowns, in the order of the columns of :meth:`append`.
    expected_samples
        How many samples will come, if known; it keeps small files small.
    stage
        What an animation shows, if :meth:`append_pictures` is to be used.
    expected_pictures
        How many pictures will come, if known.
    history
        How many numbers :meth:`note` is given at most; none if 0.
    hidden
        Whether the file gets its name only by :meth:`appear`; an older one stays until then.

    Raises
    ------
    InputError
        If the output cannot be written or another run is writing it.
    """

    def __init__(
        self,
        path: str | Path,
        *,
        channels: Sequence[Framed],
        header: ResultHeader,
        states: Sequence[Described] = (),
        expected_samples: int = 1024,
        stage: Stage | None = None,
        expected_pictures: int = 1024,
        history: int = 0,
        hidden: bool = False,
    ) -> None:
        check_names(channel.name for channel in channels)
        self.path = check_output(path)
        self.samples = 0
        self._expected = max(expected_samples, 1)
        self._chunk = min(self._expected, LARGEST_CHUNK)
        self._most = min(self._expected, LARGEST_BUFFER)
        self._widths = (len(channels), len(states))
        self._buffer: list[SampleBlock] = []
        self._stage = stage
        self._expected_pictures = expected_pictures
        self._waiting: list[Pictures] = []
        self._numbers = history
        self._events: list[EventRecord] = []
        self._last_time = -np.inf
        self._scratch = self.path.with_name(f".{self.path.name}.new")
        self._lock = OutputLock(self.path)
        self._container: Container | None = None
        self._reserve: Reserve | None = None
        self._full: InputError | None = None
        try:
            with undisturbed():
                self._reserve = Reserve(self.path.parent)
                self._container = Container(self._scratch, new=True, cache=CACHE)
                self._create(self._container.file, channels, states, header)
                self._container.flush()
                if not hidden:
                    self.appear()
        except (OSError, RuntimeError) as error:
            failed = self._failed(error)
            self._release()
            raise failed from error
        self._flushed_at = time.monotonic()

    def appear(self) -> None:
        """Give the file its name."""
        if self._scratch.exists():
            self._scratch.replace(self.path)

    def append(self, times: Floats, channels: Floats, states: Floats | None = None) -> None:
        """Add samples; they reach the file with the next append after half a second, or at the end.

        Parameters
        ----------
        times
            Times, not falling, shape (n,) [s].
        channels
            Values, shape (n, n_channels), SI.
        states
            Values, shape (n, n_states), SI.

        Raises
        ------
        InputError
            If the file cannot be written any further; what was written stays readable, and
            the file can be closed.
        """
        if self._full is not None:
            raise self._full
        if self._container is None:
            raise ValueError(f"{self.path} is closed")
        block = checked_block(times, channels, states, self._widths, self._last_time)
        self._last_time = block.times[-1] if len(block.times) else self._last_time
        self._buffer.append(block)
        overdue = time.monotonic() - self._flushed_at >= FLUSH_INTERVAL
        if overdue or sum(len(block.times) for block in self._buffer) > self._most:
            self._flush(self._container)

    def append_pictures(self, pictures: Pictures) -> None:
        """Add poses of the bodies of the stage; they reach the file with the samples."""
        self._waiting.append(pictures)

    def note(self, history: History) -> None:
        """Keep what the method goes on with from a sample that was appended."""
        if self._numbers:
            self._kept.note(history)

    def keep(self, numbers: Floats) -> None:
        """Keep numbers that later notes build on."""
        if self._numbers:
            self._kept.keep(numbers)

    def happened(self, event: EventRecord) -> None:
        """Keep an event, for the case that the run does not come to its end."""
        self._events.append(event)

    def column(self, name: str, start: int = 0, stop: int | None = None) -> Floats:
        """Return a channel, or "time", as written so far, from one sample up to another."""
        if self._container is None:
            raise ValueError(f"{self.path} is closed")
        end = self.samples if stop is None else min(stop, self.samples)
        return np.asarray(self._container.file[dataset_path(name)][start:end], dtype=float)

    def flush(self) -> None:
        """Write what is waiting; a failure is kept for :meth:`close`."""
        if self._container is not None:
            with contextlib.suppress(InputError):
                self._flush(self._container)

    @undisturbed()
    def close(
        self,
        status: str = "ok",
        message: str = "",
        *,
        summary: Sequence[SummaryEntry] = (),
        solver: Mapping[str, Any] | None = None,
        events: Sequence[EventRecord] = (),
        surroundings: Surroundings | None = None,
        notes: Sequence[str] = (),
    ) -> None:
        """Write what is left and give the file its final status; closing twice does nothing.

        Parameters
        ----------
        status
            ok, failed or interrupted.
        message
            Why the run ended, if not as planned.
        summary
            The run's summary.
        solver
            Statistics of the solver, by name.
        events
            Events in the order in which they happened.
        surroundings
            What lies beneath the way, for the animation.
        notes
            Messages to the user, such as warnings.

        Raises
        ------
        InputError
            If not all samples could be written; the file is closed all the same, as failed,
            unless there is no space even for that.
        """
        if status not in STATUSES[1:]:
            raise ValueError(f"'{status}' is no final status; use one of {STATUSES[1:]}")
        if self._container is None:
            return
        self.flush()
        if self._full is not None:
            status, message, surroundings = "failed", str(self._full), None

        def change(file: h5py.File) -> None:
            cut_samples(file, self.samples)
            file.attrs["status"] = status
            file.attrs["status_message"] = clean_text(message)
            sections.write_attributes(file["solver"], solver or {})
            sections.write_summary(file["summary"], summary)
            sections.write_events(file["events"], events)
            history = self._kept.latest(self._last_time) if self._numbers else None
            if history is not None and self._full is None:
                self._kept.write_last(file, history)
            if surroundings is not None and GROUP in file:
                write_surroundings(file[GROUP], surroundings)
            sections.write_notes(file["scenario"], notes)

        self._finish(change)
        if self._full is not None:
            raise self._full

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is None:
            self.close()
        elif isinstance(error, KeyboardInterrupt):
            self.close("interrupted", "stopped by the user")
        else:
            self.close("failed", str(error))

    def _create(
        self,
        file: h5py.File,
        channels: Sequence[Framed],
        states: Sequence[Described],
        header: ResultHeader,
    ) -> None:
        sections.write_header(file, header)
        self._time = sections.create_column(file, header.axis, self._chunk, None)
        self._channels = []
        for channel in channels:
            dataset = sections.create_column(file, channel, self._chunk, self._time)
            sections.write_attributes(dataset, {"frame": channel.frame})
            self._channels.append(dataset)
            if "." in channel.name:  # the root offers all channels at once, under whole names
                file[channel.name] = dataset
        sections.write_names(file, "channels", [channel.name for channel in channels])
        group = file.create_group("states")
        self._states = sections.create_states(group, states, self._chunk, self._time)
        for group in ("events", "summary", "solver"):
            file.create_group(group, track_order=True)
        if self._stage is not None:
            self._pictures = PictureDatasets(file, self._stage, self._expected_pictures)
        blocks = -(-self._expected // self._chunk)
        columns = 1 + len(channels) + (self._states is not None)
        if self._numbers:
            self._kept = HistoryDatasets(file, self._numbers)
        self._sums = RowSums(file, columns, blocks)
        write_text_sum(file)
        file.swmr_mode = True

    @undisturbed()
    def _flush(self, container: Container) -> None:
        """Write the buffer, and of it what fits if the disk is full.

        Where little space is left no part reaches over the end of a chunk, as the next needs more.
        """
        if not self._buffer or self._full is not None:
            return
        block = SampleBlock(*(np.concatenate(part) for part in zip(*self._buffer, strict=True)))
        self._buffer.clear()
        try:
            start, ample = 0, self._has_space(len(block.times))
            while start < len(block.times):
                inside = self._chunk - self.samples % self._chunk
                stop = len(block.times) if ample else start + inside
                self._write(container, SampleBlock(*(part[start:stop] for part in block)))
                start = stop
            if self._waiting:
                self._write_pictures(container)
        except (OSError, RuntimeError) as error:
            self._full = self._failed(error)
            raise self._full from error
        self._flushed_at = time.monotonic()

    def _has_space(self, rows: int) -> bool:
        """Return whether the disk surely takes so many samples."""
        wanted = 8 * (rows + self._chunk) * (1 + sum(self._widths))
        return free_space(self.path.parent) > 2 * wanted + AMPLE

    def _write(self, container: Container, block: SampleBlock) -> None:
        """Write samples; the times come last, so that they never promise missing values."""
        columns = np.ascontiguousarray(block.channels.T)
        for dataset, values in zip(self._channels, columns, strict=True):
            sections.extend(dataset, self.samples, values)
        tables = [] if self._states is None else [np.ascontiguousarray(block.states)]
        for table in tables:
            sections.extend(self._states, self.samples, table)
        stop = self.samples + len(block.times)
        self._sums.extend(stop, [block.times, *columns, *tables])
        container.flush()
        sections.extend(self._time, self.samples, block.times)
        self._write_history(float(block.times[-1]))
        container.flush()
        self.samples = stop

    def _write_history(self, time: float) -> None:
        """Write what is known for a continued run up to the time of the last sample [s]."""
        if not self._numbers:
            return
        if self._events:
            self._kept.add_events(self._events)
            self._events.clear()
        history = self._kept.latest(time)
        if history is not None:
            self._kept.write(history)

    def _write_pictures(self, container: Container) -> None:
        for pictures in self._waiting:
            self._pictures.extend(pictures)
        container.flush()
        self._waiting.clear()

    def _finish(self, change: Callable[[h5py.File], None]) -> None:
        try:
            if self._container is not None:
                self._container.abandon()
            if self._reserve is not None:
                self._reserve.release()
            finish(self.path, change)
        except (OSError, RuntimeError) as error:
            raise (self._full or self._failed(error)) from error
        finally:
            self._release()

    def _failed(self, error: Exception) -> InputError:
        cause = self._container.failure if self._container is not None else None
        reached = f" at t = {self._last_time:.6g} s" if np.isfinite(self._last_time) else ""
        return write_failed(self.path, cause or error, reached)

    def _release(self) -> None:
        """Let go of files and lock, whatever state they are in."""
        if self._container is not None:
            self._container.abandon()
        self._container = None
        if self._reserve is not None:
            self._reserve.release()
        self._scratch.unlink(missing_ok=True)
        self._lock.release()
