"""Reading the file of a study, a few cases or one column at a time."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import h5py
import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.results.hdf5.damage import reading
from vehicledyn.results.hdf5.opening import OpenFile, open_file
from vehicledyn.results.hdf5.output import is_being_written
from vehicledyn.results.hdf5.text_checksums import check_texts
from vehicledyn.results.store.case_checksums import check_cases
from vehicledyn.results.store.consistency import Sizes, require_stored
from vehicledyn.results.store.decimation import promises_too_much
from vehicledyn.results.store.study_layout import (
    DONE,
    ENDED,
    FAILED,
    FORMAT,
    FORMAT_VERSION,
    LOST,
    OK,
    PENDING,
    RUNNING,
    StudyAxis,
    StudyChannel,
)

Floats = NDArray[np.float64]

_ADVICE = "compute it again"


@dataclass(frozen=True)
class FigureColumn:
    """Name, unit and meaning of a key figure, and its column in the file."""

    name: str
    unit: str
    description: str
    column: int


def is_study_file(path: Path) -> bool:
    """Return whether a file is one of a study; what cannot be read is none."""
    try:
        with open_file(path) as file:
            return str(file.attrs.get("format", "")) == FORMAT
    except (InputError, OSError, RuntimeError, KeyError):
        return False


def open_study(path: str | Path) -> StudyFile:
    """Open the file of a study, whole or not; use it in a ``with`` statement.

    Raises
    ------
    InputError
        If there is no such file, or it is damaged or no study.
    """
    place = Path(path)
    with reading(place):
        file = open_file(place)
    try:
        return StudyFile(place, file)
    except InputError:
        file.close()
        raise


class StudyFile:
    """An open file of a study.

    Attributes
    ----------
    title, created, program_version, status, message
        As the layout says; ``status`` of a killed study stays at running.
    digests
        Fingerprints of study, scenario and program.
    n_cases
        Number of cases.
    times
        Times of the samples, shape (n_samples,) [s].
    channels, axes, figures
        What the file holds of each case, figures by name.
    """

    def __init__(self, path: Path, file: OpenFile) -> None:
        self.path, self._file = path, file
        with reading(path, file, _ADVICE):
            if str(file.attrs.get("format", "")) != FORMAT:
                raise InputError(f"{path}: is no file of 'vehicledyn sweep'")
            if int(file.attrs["format_version"]) > FORMAT_VERSION:
                raise InputError(f"{path}: was written by a newer vehicledyn; update this one")
            _check_layout(file)
            self.title = str(file.attrs["title"])
            self.created = str(file.attrs["created"])
            self.program_version = str(file.attrs["vehicledyn_version"])
            self.n_cases = int(file.attrs["cases"])
            self.digests: dict[str, str] = json.loads(file.attrs["digests"])
            self.configuration: dict[str, Any] = json.loads(file.attrs["configuration"])
            self.status, self.message = (bytes(t).decode() for t in file["state"][()])
            self.times = Sizes().fit("time", file["time"][()], "samples").astype(float)
            rows = zip(*(_texts(file["channels"][k]) for k in _NAMES), strict=True)
            self.channels = tuple(StudyChannel(*row) for row in rows)
            self.axes = tuple(_axes(file["axes"]))
            found = [_texts(file["figures"][k]) for k in _NAMES]
            columns = [
                FigureColumn(name, unit, meaning, number)
                for number, (name, unit, meaning) in enumerate(zip(*found, strict=True))
            ]
            self.figures = {c.name: c for c in sorted(columns, key=lambda c: c.name)}
            if file.guard is not None and not file.guard.is_sealed:
                check_cases(file)
                check_texts(file, is_finished=file.is_finished)

    @property
    def is_whole(self) -> bool:
        """Whether every case was computed, failed ones included."""
        return self.status == OK

    @property
    def state(self) -> str:
        """How far the study is, for people."""
        if self.status == RUNNING and not is_being_written(self.path.resolve()):
            return f"partial: its process ended unexpectedly; continue with {argument('resume')}"
        return f"partial: {self.message or self.status}" if not self.is_whole else "whole"

    def case_status(self) -> NDArray[np.int8]:
        """Return the status of every case, shape (n_cases,)."""
        with reading(self.path, self._file, _ADVICE):
            return np.asarray(self._file["cases/status"][()])

    def end_times(self) -> Floats:
        """Return when each case ended, shape (n_cases,) [s]."""
        with reading(self.path, self._file, _ADVICE):
            return np.asarray(self._file["cases/end_time"][()])

    def counts(self) -> dict[str, int]:
        """Return how many cases are pending, done, failed, ended by an event, and lost."""
        status = self.case_status()
        return {
            name: int((status == code).sum())
            for name, code in (
                ("done", DONE),
                ("failed", FAILED),
                ("ended", ENDED),
                ("driver_lost", LOST),
                ("pending", PENDING),
            )
        }

    def values(self, first: int = 0, stop: int | None = None) -> Floats:
        """Return values of the axes of some cases, shape (n, n_axes): SI, or numbers of choices."""
        with reading(self.path, self._file, _ADVICE):
            return np.asarray(self._file["cases/values"][first:stop])

    def axis(self, column: int) -> Floats:
        """Return what an axis is in every case, shape (n_cases,)."""
        with reading(self.path, self._file, _ADVICE):
            return np.asarray(self._file["cases/values"][:, column])

    def figure(self, name: str) -> Floats:
        """Return a key figure of every case, shape (n_cases,); what has none is not a number."""
        column = self._figure(name).column
        with reading(self.path, self._file, _ADVICE):
            return np.asarray(self._file["figures/value"][:, column])

    def figure_texts(self, name: str) -> list[str]:
        """Return a key figure of every case as texts, empty where it is a number or missing."""
        column = self._figure(name).column
        with reading(self.path, self._file, _ADVICE):
            return _texts(self._file["figures/text"][:, column])

    def samples(self, case: int, every: int = 1, most: int | None = None) -> NDArray[Any]:
        """Return the samples of a case, shape (n_samples, n_channels).

        If asked for, only one of ``every`` so many samples, and the first ``most`` channels.
        """
        with reading(self.path, self._file, _ADVICE):
            if "samples" not in self._file:
                return np.empty((len(self.times[::every]), 0))
            return np.asarray(self._file["samples"][case, ::every, :most])

    def channel(self, name: str, cases: Any = slice(None)) -> NDArray[Any]:
        """Return a channel of some cases (a slice or rising numbers), shape (n, n_samples)."""
        names = [channel.name for channel in self.channels]
        if name not in names:
            raise InputError(f"{self.path}: {unknown_name('channel', name, names)}")
        with reading(self.path, self._file, _ADVICE):
            return np.asarray(self._file["samples"][cases, :, names.index(name)])

    def reasons(self, most: int | None = None) -> Iterator[tuple[int, float, str]]:
        """Yield number, time [s] and reason of the cases that failed, at most so many."""
        failed = np.flatnonzero(self.case_status() == FAILED)[:most]
        with reading(self.path, self._file, _ADVICE):
            times, reasons = self._file["cases/end_time"], self._file["cases/reason"]
            for case in failed.tolist():
                yield case, float(times[case]), bytes(reasons[case]).decode()

    def text(self, name: str) -> str:
        """Return the text of the "study" or the "scenario"."""
        with reading(self.path, self._file, _ADVICE):
            return str(self._file[f"{name}/text"].asstr()[()])

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _figure(self, name: str) -> FigureColumn:
        if name not in self.figures:
            raise InputError(f"{self.path}: {unknown_name('figure', name, self.figures)}")
        return self.figures[name]


_NAMES = ("name", "units", "long_name")


def _check_layout(file: OpenFile) -> None:
    """Raise ValueError unless all parts are there and have the sizes that belong together."""
    for place in ("state", "time", "channels", "axes", "figures/name"):
        item = file[place]
        if isinstance(item, h5py.Group):
            require_stored(item)
        elif promises_too_much(item):
            raise ValueError(f"{place} is not in the file")
    cases, samples = int(file.attrs["cases"]), len(file["time"])
    channels, axes, figures = (len(file[f"{p}/name"]) for p in ("channels", "axes", "figures"))
    shapes = {
        "state": (2,),
        "time": (samples,),
        "cases/values": (cases, axes),
        **{f"cases/{name}": (cases,) for name in ("status", "end_time", "reason")},
        **({"samples": (cases, samples, channels)} if channels else {}),
    }
    if file.is_finished:  # else figures may be being added, or were when the program was killed
        shapes |= {f"figures/{name}": (cases, figures) for name in ("value", "text")}
        shapes |= {f"figures/{name}": (figures,) for name in _NAMES}
    for place, shape in shapes.items():
        if file[place].shape != shape:
            raise ValueError(f"{place} has the shape {file[place].shape}, not {shape}")


def _texts(values: Any) -> list[str]:
    return [bytes(value).decode() for value in values[()]]


def _axes(group: h5py.Group) -> Iterator[StudyAxis]:
    choices = [tuple(json.loads(text)) for text in group.attrs["choices"]]
    for name, unit, texts in zip(
        _texts(group["name"]), _texts(group["units"]), choices, strict=True
    ):
        yield StudyAxis(name, unit, texts)
