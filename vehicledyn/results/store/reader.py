"""Reading a result file: finished, still being written, or left behind by a killed run."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.results.hdf5.damage import reading
from vehicledyn.results.hdf5.opening import OpenFile, open_file
from vehicledyn.results.hdf5.output import is_being_written
from vehicledyn.results.hdf5.seal import DamagedError
from vehicledyn.results.hdf5.text_checksums import check_texts
from vehicledyn.results.store.animation_section import (
    GROUP,
    Animation,
    Span,
    picture_times,
    read_animation,
    read_rows,
)
from vehicledyn.results.store.checked_columns import CheckedColumns
from vehicledyn.results.store.column import StoredColumn
from vehicledyn.results.store.consistency import require_groups, require_stored
from vehicledyn.results.store.decimation import ColumnRange, column_range, portions, thinned
from vehicledyn.results.store.history import (
    History,
    read_ended_events,
    read_events,
    read_history,
    read_kept,
)
from vehicledyn.results.store.layout import (
    ENDED,
    STATUSES,
    EventRecord,
    SceneItem,
    SummaryEntry,
    dataset_path,
)
from vehicledyn.results.store.soundness import (
    check_format,
    check_lengths,
    check_times,
    refuse_promises,
)
from vehicledyn.results.store.values import Series, StateTable, entry, fact, scene_item, texts

if TYPE_CHECKING:
    import pandas

Floats = NDArray[np.float64]

ENDS = 2
"""``most`` where no times are asked for but the first and the last: all else is read in blocks."""

_BESIDE = {"states", "events", "restart", "summary", "solver", "scenario", "plots", "scene"}
"""Groups beside the channels whose arrays are read whole."""


def open_result(path: str | Path, most: int | None = None) -> Result:
    """Open a result file for reading; use the result in a ``with`` statement.

    A file that is still being written shows the samples it had when it was opened. Of a file
    with more than ``most`` samples the times and channels are thinned to their envelope, which
    keeps memory bounded; see :class:`vehicledyn.results.store.decimation.Thinning`.

    Raises
    ------
    InputError
        If there is no such file, or it is not HDF5, damaged, of another or a newer format.
    """
    place = Path(path)
    with reading(place):
        file = open_file(place)
    try:
        return Result(place, file, most=most)
    except InputError:
        file.close()
        raise


class Result(contextlib.AbstractContextManager["Result"]):
    """An open result file. Metadata are read at once, values when asked for.

    Attributes
    ----------
    path
        The file.
    status
        running, failed, interrupted, or one of ``ENDED``; a killed run stays at running.
    status_message
        Why the run ended, if not as planned.
    channels
        Names of the channels in the order of the model.
    samples, block
        Number of samples in the file, and of how many of them two are shown (1: all are).
    time
        Times of the samples, shape (n_times,) [s]; their numbers where ``is_timed`` is false.
    is_timed
        Whether the samples were taken in time.
    """

    def __init__(self, path: Path, file: OpenFile, *, most: int | None = None) -> None:
        self.path = path
        self._file = file
        closed = file.is_finished
        with self._reading():
            check_format(self.path, self._file)
            if file.guard is not None and not file.guard.is_sealed:
                check_texts(file, is_finished=file.is_finished)
            self.title = str(file.attrs["title"])
            self.model = str(file.attrs["model"])
            self.model_hash = str(file.attrs["model_hash"])
            self.created = str(file.attrs["created"])
            self.program_version = str(file.attrs["vehicledyn_version"])
            self.status = str(file.attrs["status"])
            self.status_message = str(file.attrs["status_message"])
            self.channels = tuple(str(name) for name in file.attrs["channels"])
            self.samples = int(file["time"].shape[0])
            lengths = refuse_promises(path, file, self.channels)
            require_groups(file, (*_BESIDE, GROUP))
            for group in _BESIDE & set(file):
                require_stored(file[group])
            self._columns = CheckedColumns(file, self.channels, self.samples)
            self._thinning = thinned(self.samples, most)
            self.block = self._thinning.block
            self.time = self._thinning.times(self._columns["time"])
            self.is_timed = str(file["time"].attrs.get("units", "s")) == "s"
            check_lengths(path, lengths, closed=closed)
            check_times(path, portions(file["time"], self.samples), closed=closed)
        if self.status not in STATUSES:
            raise InputError(f"{path}: status '{self.status}' is unknown; the file is damaged")

    @property
    def is_whole(self) -> bool:
        """Whether the run reached its planned end."""
        return self.status == "ok"

    @property
    def has_ended(self) -> bool:
        """Whether the run ended by itself: planned, or as a wheel left its rail."""
        return self.status in ENDED

    @property
    def state_of_run(self) -> str:
        """How the run ended, in words: "complete", "derailed ..." or "partial: ..."."""
        if self.is_whole:
            return "complete"
        if self.has_ended:
            return self.status_message
        verb = self.status
        if self.status == "running":
            verb = "still running" if is_being_written(self.path.resolve()) else "broken off"
        end = f" at {self.place(self.time[-1])}" if len(self.time) else " before the first sample"
        reason = f": {self.status_message}" if self.status_message else ""
        return f"partial: {verb}{end}{reason}"

    def place(self, time: float) -> str:
        """Return where a sample lies, in words: its time, or its number if it has no time."""
        return f"t = {time:.6g} s" if self.is_timed else f"sample {time:.0f}"

    def channel(self, name: str, rows: NDArray[np.intp] | None = None) -> Series:
        """Return a channel, of the samples shown or of some rising ``rows`` of the file.

        Raises
        ------
        InputError
            If the file has no such channel; the nearest name is suggested.
        """
        self.require(name)
        with self._reading():
            dataset = self._columns[name]
            values = self._thinning.values(dataset) if rows is None else read_rows(dataset, rows)
        return Series(name, values, *self.facts(name))

    def column(self, name: str) -> StoredColumn:
        """Return a channel, or "time", with all samples of the file, read in slices."""
        if name != "time":
            self.require(name)
        with self._reading():
            return StoredColumn(self._columns[name], self.samples, self._reading)

    def facts(self, name: str) -> tuple[str, str, str]:
        """Return unit, meaning and frame of a channel."""
        self.require(name)
        with self._reading():
            known = self._file[dataset_path(name)].attrs
            return str(known["units"]), str(known["long_name"]), str(known.get("frame", ""))

    def range(self, name: str) -> ColumnRange:
        """Return the range of a channel over all samples, thinned or not."""
        self.require(name)
        with self._reading():
            return column_range(self._columns[name], self.samples)

    def require(self, name: str) -> None:
        """Raise an InputError unless the file has this channel."""
        if name not in self.channels:
            raise InputError(f"{self.path}: {unknown_name('channel', str(name), self.channels)}")

    @property
    def units(self) -> dict[str, str]:
        """SI units of the channels, by name."""
        with self._reading():
            file = self._file
            return {n: str(file[dataset_path(n)].attrs["units"]) for n in self.channels}

    @property
    def states(self) -> StateTable:
        """States and algebraic unknowns at the times of the samples, for a restart."""
        with self._reading():
            group = self._file["states"]
            if "value" not in group:
                return StateTable((), (), np.empty((self.samples, 0)))
            return StateTable(
                names=texts(group["name"]),
                units=texts(group["units"]),
                values=np.asarray(self._columns["states/value"][: self.samples], dtype=float),
            )

    def history(self, latest: float) -> History | None:
        """Return what the method goes on with in a continued run, from up to a time [s]."""
        with self._reading():
            return read_history(self._file, latest)

    @property
    def kept_numbers(self) -> Floats:
        """The numbers that histories build on."""
        with self._reading():
            return read_kept(self._file)

    @property
    def events_so_far(self) -> tuple[EventRecord, ...]:
        """Events, also of a run that was killed."""
        with self._reading():
            return self.events or tuple(read_events(self._file))

    def rows(self, start: int, stop: int) -> tuple[Floats, Floats, Floats]:
        """Return times, channels and states of some samples, (n,) and (n, ...)."""
        with self._reading():
            self._check_states()
            part = slice(start, stop)
            times = np.asarray(self._columns["time"][part], dtype=float)
            columns = [self._columns[name][part] for name in self.channels]
            states = self._columns["states/value"][part] if self.state_names else None
            table = np.array(columns, dtype=float).reshape(len(columns), len(times)).T
            return times, table, np.empty((len(times), 0)) if states is None else states

    @property
    def state_names(self) -> tuple[str, ...]:
        """Names of states and algebraic unknowns."""
        with self._reading():
            return texts(self._file["states/name"]) if "states/name" in self._file else ()

    @property
    def events(self) -> tuple[EventRecord, ...]:
        """Events in the order in which they happened."""
        with self._reading():
            return tuple(read_ended_events(self._file))

    @property
    def summary(self) -> dict[str, SummaryEntry]:
        """Entries of the summary by name; empty for a run that was killed."""
        with self._reading():
            group = self._file["summary"]
            names = [str(name) for name in group.attrs.get("entries", ())]
            return {name: entry(name, group[dataset_path(name)[1:]]) for name in names}

    @property
    def solver(self) -> dict[str, Any]:
        """Statistics of the solver by name."""
        return self._attributes("solver")

    @property
    def versions(self) -> dict[str, Any]:
        """Versions of the packages that made the file."""
        return self._attributes("versions")

    @property
    def scenario_text(self) -> str:
        """Text of the scenario file, as it was run."""
        return self._text("scenario/text")

    @property
    def sources(self) -> list[dict[str, str]]:
        """Parts that were used, what they do and where they come from; empty in older files."""
        with self._reading():
            known = "scenario/sources" in self._file
        return self._records("scenario/sources") if known else []

    @property
    def notes(self) -> tuple[str, ...]:
        """Messages of the run to its user, such as warnings."""
        with self._reading():
            group = self._file["scenario"]
            return texts(group["notes"]) if "notes" in group else ()

    @property
    def configuration(self) -> dict[str, Any]:
        """The resolved scenario."""
        with self._reading():
            found = self._json("scenario/configuration")
            if not isinstance(found, dict):
                raise ValueError("its configuration is none")
            return found

    @property
    def equations(self) -> tuple[str, dict[str, tuple[float, str]]]:
        """Digest of the equations alone, and parameters in SI with units; empty if unknown."""
        with reading(self.path):
            if "parameters" not in self._file["scenario"]:
                return "", {}
            found = self._json("scenario/parameters")
            values = {str(n): (float(v), str(unit)) for n, (v, unit) in found["values"].items()}
            return str(found["equations"]), values

    @property
    def plots(self) -> list[dict[str, Any]]:
        """Descriptions of the plots this file asks for."""
        return self._records("plots/descriptions")

    @property
    def scene(self) -> dict[str, SceneItem]:
        """Static data by name, such as the cones of a course."""
        with self._reading():
            return {
                name: scene_item(item)
                for name, item in self._file["scene"].items()
                if item.attrs.get("CLASS") != b"DIMENSION_SCALE"
            }

    @property
    def pictures(self) -> int:
        """Number of pictures for an animation."""
        with self._reading():
            return int(picture_times(self._file[GROUP]).shape[0]) if GROUP in self._file else 0

    def animation(self, span: Span) -> Animation | None:
        """Return shapes and some poses of the bodies, None where there are none."""
        with self._reading():
            return read_animation(self._file[GROUP], span) if GROUP in self._file else None

    def as_frame(self) -> pandas.DataFrame:
        """Return all channels as a table with one column a channel and the time as index."""
        import pandas

        columns = {name: self.channel(name).values for name in self.channels}
        return pandas.DataFrame(columns, index=pandas.Index(self.time, name="time"))

    def close(self) -> None:
        """Close the file; closing twice does nothing."""
        self._file.close()

    def __exit__(self, *_: object) -> None:
        self.close()

    def _reading(self) -> contextlib.AbstractContextManager[None]:
        return reading(self.path, self._file)

    def _check_states(self) -> None:
        """Refuse states that are no table of their names; checksums cover rows alone."""
        names = self.state_names
        if names and self._file["states/value"].shape[1:] != (len(names),):
            raise DamagedError(f"states/value has the shape {self._file['states/value'].shape}")

    def _attributes(self, place: str) -> dict[str, Any]:
        with self._reading():
            return {name: fact(name, value) for name, value in self._file[place].attrs.items()}

    def _text(self, place: str) -> str:
        with self._reading():
            return str(self._file[place].asstr()[()])

    def _records(self, place: str) -> list[dict[str, Any]]:
        with self._reading():
            found = self._json(place)
            if not isinstance(found, list) or not all(isinstance(item, dict) for item in found):
                raise ValueError(f"{place} is no list of records")
            return found

    def _json(self, place: str) -> Any:
        text = self._text(place)
        with self._reading():
            return json.loads(text)
