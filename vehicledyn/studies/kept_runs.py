"""Runs of a study that are kept in a file as they come, so that a stopped study can go on."""

from __future__ import annotations

import hashlib
import json
import threading
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.limits import check_regular, read_regular

_LARGEST = 2_000_000_000
_KEY, _FOUND, _SUM = "run", "found", "checksum"


class KeptRuns:
    """Runs by what tells them apart; each is computed once and kept beside the result.

    Parameters
    ----------
    path
        File of one run a line, behind a line that names the study; None to keep none.
    texts
        What the study rests on: its file, its scenarios, its data.
    resume
        Whether to use what is there already; else the file begins anew.

    Raises
    ------
    InputError
        If the file is that of another study, or cannot be written.
    """

    def __init__(self, path: Path | None, texts: Iterable[str], *, resume: bool) -> None:
        self._path, self._lock = path, threading.Lock()
        self._known: dict[str, dict[str, Any]] = {}
        self._head, self._begun = json.dumps({"study": _digest(texts)}), False
        if path is not None and path.exists():
            check_regular(path)
            if resume:
                self._begun = self._read(path, self._head)
        self.n_known = len(self._known)

    def entry(self, run: Any, compute: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        """Return what a run gave, computed if it is not known; threads may ask at once."""
        key = json.dumps(run)
        if key not in self._known:
            found = compute()
            with self._lock:
                self._known[key] = found
                if self._path is not None:
                    self._keep(self._path, key, found)
        return self._known[key]

    def forget(self) -> None:
        """Remove the file, as the study has come to its end."""
        if self._path is not None:
            self._path.unlink(missing_ok=True)

    def _keep(self, path: Path, key: str, found: dict[str, Any]) -> None:
        """Add a run to the file, which begins with the first one."""
        line = json.dumps({_KEY: key, _SUM: _digest([key, json.dumps(found)]), _FOUND: found})
        if not self._begun:
            self._write(path, f"{self._head}\n", "w")
            self._begun = True
        self._write(path, f"{line}\n", "a")

    def _write(self, path: Path, text: str, mode: str) -> None:
        try:
            with path.open(mode, encoding="utf-8") as file:
                file.write(text)
        except OSError as error:
            raise InputError(f"{path}: cannot be written: {error.strerror}") from None

    def _read(self, path: Path, head: str) -> bool:
        """Read what is known; a line that is damaged or was cut short is computed again.

        Return whether there is more than what a kill leaves of the first line.
        """
        text = read_regular(path, _LARGEST).decode(errors="replace")
        if head.startswith(text):
            return False
        lines = text.splitlines()
        if lines[:1] != [head]:
            raise InputError(f"{path}: holds runs of another study; start anew without resuming")
        for line in lines[1:]:
            try:
                entry = json.loads(line)
                key, found = entry[_KEY], entry[_FOUND]
                if entry[_SUM] == _digest([key, json.dumps(found)]):
                    self._known[key] = found
            except (ValueError, KeyError, TypeError, RecursionError):
                continue
        if not text.endswith("\n"):
            self._write(path, "\n", "a")
        return True


def _digest(texts: Iterable[str]) -> str:
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()
