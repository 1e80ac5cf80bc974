"""Writing the file of a study block by block, so that a killed study can go on.

A block's cases are marked done after their values are in the file; what is not marked is
computed again. The file is open for readers all the time and keeps its place on the disk.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Self

import h5py
import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError
from vehicledyn.base.interrupts import undisturbed
from vehicledyn.base.version import VERSION
from vehicledyn.results.hdf5 import superblock
from vehicledyn.results.hdf5.disk import Container
from vehicledyn.results.hdf5.finishing import Reserve, finish
from vehicledyn.results.hdf5.journal import reopen
from vehicledyn.results.hdf5.output import OutputLock, check_output, write_failed
from vehicledyn.results.hdf5.text_checksums import write_text_sum
from vehicledyn.results.store import case_checksums as case_sums
from vehicledyn.results.store.dimensions import attach, bare_dimension, resize_dimension
from vehicledyn.results.store.layout import clean_text
from vehicledyn.results.store.sections import write_attributes
from vehicledyn.results.store.study_layout import (
    FORMAT,
    FORMAT_VERSION,
    MESSAGE_BYTES,
    NAME_BYTES,
    PENDING,
    REASON_BYTES,
    RUNNING,
    TEXT_BYTES,
    StudyBlock,
    StudyFigure,
    StudyHeader,
    fitted,
)

_COLUMN_ROWS = 4096
_REASON_ROWS = 64
_CHANGED = {
    "study": "the study has changed",
    "scenario": "its scenario or model has changed",
    "program": "it was begun by another version of vehicledyn",
}

FIGURE = "figure"
_COLUMNS = {"channel": "channels", "axis": "axes"}
"""Groups of the columns along these dimensions."""


class StudyWriter:
    """Writes the file of a study; use it in a ``with`` statement.

    Parameters
    ----------
    path
        Output file.
    header
        What is known before the first case.
    resume
        Whether to go on with a file that exists.
    overwrite
        Whether to replace a file that exists, if it is not continued.

    Raises
    ------
    InputError
        If the file exists although it should not, belongs to another study, or cannot be
        written.
    """

    def __init__(
        self, path: Path, header: StudyHeader, *, resume: bool, overwrite: bool = False
    ) -> None:
        self.path, self.header = check_output(path), header
        going_on = resume and self.path.exists()
        if self.path.exists() and not (resume or overwrite):
            raise InputError(
                f"{path}: exists; go on with it by {argument('resume')}, or choose another output"
            )
        self._lock = OutputLock(self.path)
        self._container: Container | None = None
        self._reserve: Reserve | None = None
        self._figures: dict[str, int] = {}
        try:
            with undisturbed():
                self._reserve = Reserve(self.path.parent)
                self._open(path) if going_on else self._create()
        except (OSError, RuntimeError) as error:
            raise self._failed(error) from error
        except BaseException:
            self._release()
            raise

    @property
    def status(self) -> NDArray[np.int8]:
        """Status of every case, shape (n_cases,)."""
        return np.asarray(self._file["cases/status"][()])

    @undisturbed()
    def write(self, block: StudyBlock) -> None:
        """Add the cases of a block and mark them done.

        Raises
        ------
        InputError
            If the file cannot be written; what was written before can be continued.
        """
        file, rows = self._file, slice(block.first, block.first + len(block))
        try:
            cases = file["cases"]
            cases["values"][rows] = block.values
            cases["end_time"][rows] = block.end_time
            if block.samples is not None and block.samples.size:
                _write_samples(file["samples"], rows, block.samples)
            for number, reason in block.reasons.items():
                cases["reason"][block.first + number] = fitted(reason, REASON_BYTES)
            self._write_figures(block)
            file[case_sums.DATASET][rows] = case_sums.sums_in(file, rows.start, rows.stop)
            self._container_flush()
            cases["status"][rows] = block.status
            self._container_flush()
        except (OSError, RuntimeError) as error:
            raise self._failed(error) from error

    @undisturbed()
    def close(self, status: str, message: str = "") -> None:
        """Say how the work on the file ended and close it; closing twice does nothing."""
        if self._container is None:
            return
        try:
            self._say(status, message)
            self._container.flush()
            self._container.abandon()
            if self._reserve is not None:
                self._reserve.release()
            finish(self.path, _change_nothing)
        except (OSError, RuntimeError) as error:
            raise self._failed(error) from error
        self._release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._release()

    @property
    def _file(self) -> h5py.File:
        if self._container is None:
            raise ValueError(f"{self.path} is closed")
        return self._container.file

    def _container_flush(self) -> None:
        if self._container is not None:
            self._container.flush()

    def _create(self) -> None:
        scratch = self.path.with_name(f".{self.path.name}.new")
        try:
            self._container = Container(scratch, new=True)
            _write_header(self._file, self.header)
            write_text_sum(self._file)
            self._file.swmr_mode = True
            self._say(RUNNING, "")
            self._container.flush()
            scratch.replace(self.path)
        finally:
            scratch.unlink(missing_ok=True)

    def _open(self, named: Path) -> None:
        self._compare(named)
        reopen(self.path)
        with self.path.open("r+b") as file:
            start = superblock.as_closed(file.read(superblock.SIZE), self.path.stat().st_size)
            file.seek(0)
            file.write(start)
            file.truncate(superblock.end_of(start))
        self._container = Container(self.path, new=False)
        names = self._file["figures/name"][()]
        self._figures = {bytes(name).decode(): k for k, name in enumerate(names)}
        self._file.swmr_mode = True
        self._say(RUNNING, "")
        self._container.flush()

    def _compare(self, named: Path) -> None:
        from vehicledyn.results.store.study_reader import open_study

        with open_study(self.path) as before:
            known, now = before.digests, self.header.digests
            wrong = [words for key, words in _CHANGED.items() if known.get(key) != now.get(key)]
        if wrong:
            raise InputError(
                f"{named}: cannot be continued: {'; '.join(wrong)}; start again with another "
                "output, or undo the change"
            )

    def _say(self, status: str, message: str) -> None:
        self._file["state"][:] = [fitted(status, MESSAGE_BYTES), fitted(message, MESSAGE_BYTES)]

    def _write_figures(self, block: StudyBlock) -> None:
        group = self._file["figures"]
        new = {f.name: f for entries in block.figures.values() for f in entries}
        self._add_figures(group, [f for name, f in new.items() if name not in self._figures])
        if not new:
            return
        rows, shape = slice(block.first, block.first + len(block)), (len(block), len(self._figures))
        numbers, texts = np.full(shape, np.nan), np.zeros(shape, f"S{TEXT_BYTES}")
        for row, entries in block.figures.items():
            for entry in entries:
                place = row, self._figures[entry.name]
                if isinstance(entry.value, str):
                    texts[place] = fitted(entry.value, TEXT_BYTES)
                else:
                    numbers[place] = float(entry.value)
        group["value"][rows] = numbers
        if texts.astype(bool).any():
            group["text"][rows] = texts

    def _add_figures(self, group: h5py.Group, new: Sequence[StudyFigure]) -> None:
        if not new:
            return
        first, count = len(self._figures), len(self._figures) + len(new)
        for name in ("value", "text"):
            group[name].resize(count, axis=1)
        for key, texts in (
            ("units", [f.unit for f in new]),
            ("long_name", [f.description for f in new]),
            ("name", [f.name for f in new]),
        ):
            group[key].resize(count, axis=0)
            group[key][first:] = [fitted(text, NAME_BYTES) for text in texts]
        if FIGURE in self._file:
            resize_dimension(self._file[FIGURE], count)
        self._figures |= {figure.name: first + k for k, figure in enumerate(new)}

    def _failed(self, error: Exception) -> InputError:
        cause = self._container.failure if self._container is not None else None
        self._release()
        found = write_failed(self.path, cause or error)
        return InputError(f"{found}; what is complete is kept, continue with {argument('resume')}")

    def _release(self) -> None:
        if self._container is not None:
            self._container.abandon()
        self._container = None
        if self._reserve is not None:
            self._reserve.release()
        self._lock.release()


def pending(status: NDArray[np.int8], chunk: int, most: int) -> Iterator[tuple[int, int]]:
    """Yield spans of cases that are still to be computed, none across the ends of chunks.

    Parameters
    ----------
    status
        Status of every case.
    chunk
        Number of cases that are written together.
    most
        Largest number of cases of a span.
    """
    size = max(1, most // chunk) * chunk
    for begin in range(0, len(status), size):
        waits = np.concatenate([[False], status[begin : begin + size] == PENDING, [False]])
        edges = np.flatnonzero(waits[1:] != waits[:-1])
        for first, stop in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
            yield begin + first, begin + stop


def _change_nothing(file: h5py.File) -> None:
    """Leave a file as it is: closing and sealing it is enough."""


def _write_header(file: h5py.File, header: StudyHeader) -> None:
    write_attributes(
        file,
        {
            "format": FORMAT,
            "format_version": FORMAT_VERSION,
            "title": header.title,
            "created": datetime.now(UTC).isoformat(timespec="seconds"),
            "vehicledyn_version": VERSION,
            "cases": header.n_cases,
            "digests": json.dumps(dict(header.digests)),
            "configuration": json.dumps(dict(header.configuration), default=str),
        },
    )
    file.create_dataset("state", (2,), f"S{MESSAGE_BYTES}")
    time = file.create_dataset("time", data=header.times)
    write_attributes(time, {"units": "s", "long_name": "Time"})
    time.make_scale("time")
    for name, length in (
        ("state_part", 2),
        ("case", header.n_cases),
        ("channel", len(header.channels)),
        ("axis", max(1, len(header.axes))),
    ):
        bare_dimension(file, name, length)
    bare_dimension(file, FIGURE, 0, grows=True)
    for name, text in (("study/text", header.study_text), ("scenario/text", header.scenario_text)):
        file[name] = clean_text(text)
    _write_texts(file, "channels", [tuple(c) for c in header.channels])
    rows = [(a.name, a.unit, json.dumps(a.choices)) for a in header.axes]
    group = _write_texts(file, "axes", [row[:2] for row in rows])
    group.attrs["choices"] = [row[2] for row in rows]
    _create_cases(file, header)
    _create_figures(file.create_group("figures"), header.n_cases)
    if header.channels:
        shape = (header.n_cases, len(header.times), len(header.channels))
        rows_of_chunk = _most_rows(header)
        file.create_dataset(
            "samples",
            shape,
            "f4" if header.single else "f8",
            chunks=(header.chunk, rows_of_chunk, shape[2]),
            fillvalue=np.nan,
        )
        attach(file["samples"], [file["case"], time, file["channel"]])
    _label(file)


def _label(file: h5py.File) -> None:
    """Name the dimensions of all columns."""
    attach(file["state"], [file["state_part"]])
    for name in ("channel", "axis"):
        for column in file[_COLUMNS[name]].values():
            attach(column, [file[name]])
    for name, column in file["cases"].items():
        attach(column, [file["case"], *([file["axis"]] if name == "values" else [])])
    for name, column in file["figures"].items():
        attach(column, [*([file["case"]] if name in ("value", "text") else []), file[FIGURE]])


def _write_samples(dataset: h5py.Dataset, rows: slice, samples: NDArray[Any]) -> None:
    """Write samples in parts of some megabytes; what is too large for 32 bits becomes infinite."""
    step = max(1, case_sums.AT_ONCE // max(1, samples[:, 0].nbytes))
    for first in range(0, samples.shape[1], step):
        part = slice(first, first + step)
        with np.errstate(over="ignore"):
            dataset[rows, part] = samples[:, part].astype(dataset.dtype)


def _most_rows(header: StudyHeader) -> int:
    """Return the samples of a chunk, so that none is larger than some megabytes."""
    largest = 4_000_000
    whole = header.chunk * header.case_bytes
    parts = -(-whole // largest)
    return -(-len(header.times) // parts)


def _create_cases(file: h5py.File, header: StudyHeader) -> None:
    group, n = file.create_group("cases"), header.n_cases
    rows = min(n, _COLUMN_ROWS)
    width = max(1, len(header.axes))
    group.create_dataset("values", (n, width), "f8", chunks=(min(n, 512), width), fillvalue=np.nan)
    group.create_dataset("status", (n,), "i1", chunks=(rows,))
    group.create_dataset("end_time", (n,), "f8", chunks=(rows,), fillvalue=np.nan)
    group.create_dataset("crc", (n,), "u4", chunks=(rows,))
    group.create_dataset("reason", (n,), f"S{REASON_BYTES}", chunks=(min(n, _REASON_ROWS),))


def _create_figures(group: h5py.Group, n_cases: int) -> None:
    rows = min(n_cases, _COLUMN_ROWS)
    for name, kind, fill in (("value", "f8", np.nan), ("text", f"S{TEXT_BYTES}", None)):
        group.create_dataset(
            name, (n_cases, 0), kind, maxshape=(n_cases, None), chunks=(rows, 1), fillvalue=fill
        )
    for name in ("name", "units", "long_name"):
        group.create_dataset(name, (0,), f"S{NAME_BYTES}", maxshape=(None,), chunks=(32,))


def _write_texts(file: h5py.File, name: str, rows: Sequence[Sequence[Any]]) -> h5py.Group:
    group = file.create_group(name)
    for number, key in enumerate(("name", "units", "long_name")):
        if not rows or number < len(rows[0]):
            texts = [fitted(str(row[number]), NAME_BYTES) for row in rows]
            group.create_dataset(key, data=np.array(texts, dtype=f"S{NAME_BYTES}"))
    return group
