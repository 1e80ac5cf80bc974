"""The last iterate of a search, kept in a file so that a killed search can go on."""

from __future__ import annotations

import dataclasses
import hashlib
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from vehicledyn.analyse.optimal_control.trajectory import Trajectory
from vehicledyn.base.errors import InputError

_PAUSE = 1.0
"""Shortest time between two writes [s]."""


class KeptIterate:
    """A file of the last iterate.

    Parameters
    ----------
    path
        The file; None to keep nothing.
    texts
        What the study rests on.
    """

    def __init__(self, path: Path | None, texts: Iterable[str]) -> None:
        self._path, self._written = path, -np.inf
        self._study = hashlib.sha256("\n".join(texts).encode()).hexdigest()

    def keep(self, iterate: Callable[[], Trajectory]) -> None:
        """Write an iterate, if the last one was written a while ago.

        Raises
        ------
        InputError
            If it cannot be written.
        """
        now = time.monotonic()
        if self._path is None or now < self._written + _PAUSE:
            return
        self._written = now
        parts = {f.name: getattr(iterate(), f.name) for f in dataclasses.fields(Trajectory)}
        scratch = self._path.with_name(f".{self._path.name}.new")
        try:
            with scratch.open("wb") as file:
                np.savez(file, study=np.array(self._study), **parts)
            scratch.replace(self._path)
        except OSError as error:
            raise InputError(f"{self._path}: cannot be written: {error.strerror}") from None

    def recall(self) -> Trajectory | None:
        """Return the iterate that is there, None if there is none.

        Raises
        ------
        InputError
            If it is damaged or that of another study.
        """
        if self._path is None or not self._path.is_file():
            return None
        try:
            with np.load(self._path, allow_pickle=False) as file:
                if str(file["study"]) != self._study:
                    words = "is of another study; start anew without resuming"
                    raise InputError(f"{self._path}: {words}")
                parts = {f.name: file[f.name] for f in dataclasses.fields(Trajectory)}
        except (OSError, ValueError, KeyError, BadZipFile):
            raise InputError(f"{self._path}: is damaged; start anew without resuming") from None
        for name in ("duration", "first_distance"):
            parts[name] = float(parts[name])
        return Trajectory(**parts)

    def forget(self) -> None:
        """Remove the file, as the search has come to its end."""
        if self._path is not None:
            self._path.unlink(missing_ok=True)
