"""Driven tests that are kept on the disk while a car is tested, for a study that is killed."""

from __future__ import annotations

import json
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError
from vehicledyn.results.hdf5.checkpoint import Checkpoint
from vehicledyn.results.hdf5.output import OutputLock

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Drive:
    """Times [s], channels of shape (n_times, n_channels), and what ended the test early."""

    times: Matrix
    outputs: Matrix
    ended_by: str


class KeptDrives:
    """Keeps each drive beside a result until that is written; use it in a ``with`` statement.

    Parameters
    ----------
    output
        The result file, which nobody else may write meanwhile; None to keep nothing.
    resume
        Whether to go on with what a killed study left.

    Raises
    ------
    InputError
        If there is nothing to go on with, or another command writes the result.
    """

    def __init__(self, output: Path | None, *, resume: bool) -> None:
        if resume and output is None:
            raise InputError(
                f"{argument('resume')}: name the result that was being written, by "
                f"{argument('save_to')}"
            )
        self._output, self._resume = output, resume
        self._checkpoint: Checkpoint | None = None
        self._open = ExitStack()
        if output is not None:
            self._open.callback(OutputLock(output.resolve()).release)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._open.close()

    def begin(self, identity: str) -> None:
        """Begin the tests of a car, named by all that they depend on.

        Raises
        ------
        InputError
            If what is there belongs to another car.
        """
        if self._output is None:
            return
        self._checkpoint = Checkpoint(self._output.resolve(), identity, resume=self._resume)
        self._open.callback(self._checkpoint.close)

    def recall(self, key: bytes) -> Drive | None:
        """Return what a drive gave, None where it is not kept.

        Raises
        ------
        InputError
            If what is kept is damaged.
        """
        data = None if self._checkpoint is None else self._checkpoint.get(key)
        if data is None or self._checkpoint is None:
            return None
        try:
            return _drive_of(data)
        except (ValueError, TypeError, RecursionError):
            raise InputError(
                f"{self._checkpoint.path}: is damaged; start again without {argument('resume')}"
            ) from None

    def keep(self, key: bytes, drive: Drive) -> None:
        """Keep what a drive gave."""
        if self._checkpoint is not None:
            self._checkpoint.put(key, _data_of(drive))

    def forget(self) -> None:
        """Remove what was kept, as the result is written."""
        if self._checkpoint is not None:
            self._checkpoint.remove()


def _data_of(drive: Drive) -> bytes:
    """Return a line with the shape and what ended the drive, and the numbers."""
    head = json.dumps([*drive.outputs.shape, drive.ended_by])
    return b"".join([head.encode(), b"\n", drive.times.tobytes(), drive.outputs.tobytes()])


def _drive_of(data: bytes) -> Drive:
    """Return a drive from its data; a ValueError or TypeError says that they are none."""
    head, _, body = data.partition(b"\n")
    rows, columns, ended_by = json.loads(head)
    numbers = np.frombuffer(body).copy()
    times, outputs = numbers[:rows], numbers[rows:].reshape(rows, columns)
    return Drive(times, outputs, str(ended_by))
