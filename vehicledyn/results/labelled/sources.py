"""Where labelled arrays come from: one reader for each kind of result file."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.results.labelled.array import LabelledArray
from vehicledyn.results.labelled.source import Head, Source
from vehicledyn.results.store import reader, study_layout
from vehicledyn.results.store.layout import FORMAT as RUN
from vehicledyn.results.store.layout import EventRecord, SummaryEntry
from vehicledyn.results.store.linear_file import format_of
from vehicledyn.results.store.study_reader import open_study
from vehicledyn.results.store.values import Series


def source_of(path: Path) -> Source:
    """Return the reader for a file.

    Raises
    ------
    InputError
        If there is no such file, or it is damaged or of no known format.
    """
    kind = format_of(path)
    if kind == study_layout.FORMAT:
        return StudySource(path)
    if kind not in ("", RUN):
        from vehicledyn.results.labelled.tables import table_source

        return table_source(path, kind)
    return RunSource(path)  # says what is wrong with what is no result


class RunSource:
    """The file of a run, or of another analysis that samples channels."""

    def __init__(self, path: Path) -> None:
        self._path = path
        with reader.open_result(path, reader.ENDS) as result:
            self.head = Head(
                "run",
                result.title,
                result.model,
                result.status,
                result.status_message,
                {
                    "created": result.created,
                    "vehicledyn_version": result.program_version,
                    "model_hash": result.model_hash,
                },
            )
            self._axis = "time" if result.is_timed else "sample"
            self._time: LabelledArray | None = None
            self.names: Sequence[str] = dict.fromkeys((self._axis, *result.channels))  # type: ignore[assignment]
            self._notes: tuple[str, ...] | None = None
            if result.status != "running":
                with contextlib.suppress(InputError):  # damaged ones are reported when asked for
                    self._notes = result.notes

    def read(self, names: Sequence[str]) -> list[LabelledArray]:
        """Return the time or channels."""
        channels = [name for name in names if name != self._axis]
        with reader.open_result(self._path) as result:
            if self._time is None:
                self._time = _axis(self._axis, result.time)
            time = self._time
            found = {name: self._of(result.channel(name), time) for name in channels}
        return [time if name == self._axis else found[name] for name in names]

    def _of(self, channel: Series, time: LabelledArray) -> LabelledArray:
        """Return a channel over the samples."""
        return LabelledArray(
            channel.name,
            channel.values,
            (self._axis,),
            channel.unit,
            channel.description,
            {self._axis: time},
            channel.frame,
        )

    def summary(self) -> Mapping[str, SummaryEntry]:
        """Return the key figures of the run."""
        with reader.open_result(self._path, reader.ENDS) as result:
            return result.summary

    def events(self) -> tuple[EventRecord, ...]:
        """Return what happened during the run."""
        with reader.open_result(self._path, reader.ENDS) as result:
            return result.events_so_far

    def notes(self) -> tuple[str, ...]:
        """Return what the run noted."""
        if self._notes is not None:
            return self._notes
        with reader.open_result(self._path, reader.ENDS) as result:
            return result.notes


class StudySource:
    """The file of a study: what varied, key figures and channels, case by case."""

    def __init__(self, path: Path) -> None:
        self._path = path
        with open_study(path) as file:
            self.head = Head(
                "study",
                file.title,
                "",
                file.status,
                file.message,
                {
                    "created": file.created,
                    "vehicledyn_version": file.program_version,
                    "cases": file.n_cases,
                },
            )
            self._time = _axis("time", file.times)
            self._case = LabelledArray(
                "case", np.arange(file.n_cases), ("case",), "", "Number of the case"
            )
            self._axes = {axis.name: k for k, axis in enumerate(file.axes)}
            self._channels = {channel.name for channel in file.channels}
            names = ["case", "case.status", "case.end_time", "time", *self._axes]
            names += [self._figure_name(figure) for figure in file.figures]
            self._figures = {self._figure_name(name): name for name in file.figures}
            names += [channel.name for channel in file.channels]
            self.names: Sequence[str] = list(dict.fromkeys(names))

    def _figure_name(self, name: str) -> str:
        taken = name in self._axes or name in self._channels
        return f"figure.{name}" if taken else name

    def read(self, names: Sequence[str]) -> list[LabelledArray]:
        """Return arrays over the cases, or over cases and time."""
        with open_study(self._path) as file:
            return [self._read(file, name) for name in names]

    def _read(self, file: Any, name: str) -> LabelledArray:
        if name in ("case", "time"):
            return self._case if name == "case" else self._time
        coords = {"case": self._case}
        if name == "case.status":
            words = np.array(study_layout.STATUS_NAMES)[file.case_status()]
            return LabelledArray(name, words, ("case",), "", "How the case ended", coords)
        if name == "case.end_time":
            values = file.end_times()
            return LabelledArray(name, values, ("case",), "s", "When it ended", coords)
        if name in self._axes:
            return self._axis_array(file, name, coords)
        if name in self._figures:
            return _figure(file, name, self._figures[name], coords)
        channel = next(c for c in file.channels if c.name == name)
        values = file.channel(name)
        both = {**coords, "time": self._time}
        dims = ("case", "time")
        return LabelledArray(name, values, dims, channel.unit, channel.description, both)

    def _axis_array(
        self, file: Any, name: str, coords: Mapping[str, LabelledArray]
    ) -> LabelledArray:
        axis, values = file.axes[self._axes[name]], file.axis(self._axes[name])
        if axis.choices:
            values = np.array([_choice(axis.choices, number) for number in values], dtype=object)
        return LabelledArray(name, values, ("case",), axis.unit, "Varied", coords)

    def summary(self) -> Mapping[str, SummaryEntry]:
        """Return how many cases ended how."""
        with open_study(self._path) as file:
            counts = file.counts()
        return {
            key: SummaryEntry(key, number, "1", f"Cases: {key}") for key, number in counts.items()
        }

    def events(self) -> tuple[EventRecord, ...]:
        """Return nothing: events are those of single cases."""
        return ()

    def notes(self) -> tuple[str, ...]:
        """Return why cases failed."""
        with open_study(self._path) as file:
            return tuple(f"case {number}: {why}" for number, _, why in _reasons(file))


def _reasons(file: Any) -> Iterator[tuple[int, float, str]]:
    yield from file.reasons()


def _figure(file: Any, name: str, key: str, coords: Mapping[str, LabelledArray]) -> LabelledArray:
    figure = file.figures[key]
    values = np.asarray(file.figure(key))
    texts = file.figure_texts(key)
    kept = np.array(texts, dtype=object) if any(texts) else values
    return LabelledArray(name, kept, ("case",), figure.unit, figure.description, coords)


def _choice(choices: Sequence[str], number: float) -> str:
    return choices[int(number)] if np.isfinite(number) else ""


def _axis(name: str, values: Any) -> LabelledArray:
    unit, words = ("s", "Time") if name == "time" else ("1", "Number of the sample")
    return LabelledArray(name, np.asarray(values, dtype=float), (name,), unit, words)
