"""What all analyses called from Python share: where they write, what they print, how they end."""

from __future__ import annotations

import shutil
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import Any, TypeAlias

from vehicledyn.base.argument_names import given
from vehicledyn.base.errors import (
    AccuracyWarning,
    InputError,
    Interrupted,
    NumericalError,
    UnfinishedWarning,
)
from vehicledyn.base.report import Report
from vehicledyn.base.version import FOLDER
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.hdf5.output import check_output
from vehicledyn.results.labelled.data import LabelledData

Progress: TypeAlias = bool | Callable[[str, float | None], object]
"""True for a line on standard error, or a function that gets what is done and the part done."""

WARNING = "warning: "
"""Begins the notes of results that warn."""


class ResultPlace:
    """Where an analysis writes: a file to keep, or one that lasts as long as its value.

    Attributes
    ----------
    path
        The file.
    kept
        What is kept beside it while it is computed.
    """

    def __init__(self, folder: Path | None, path: Path, kept: KeptWork) -> None:
        self._folder, self.path, self.kept = folder, path, kept

    def value(self, report: Report, *, goes_on: bool = False) -> LabelledData:
        """Return what was written, with the warnings it holds issued.

        ``goes_on`` says that the analysis may go on with what is kept, which stays.

        Raises
        ------
        Interrupted
            If the user stopped the analysis.
        NumericalError
            If its numbers are beyond what a result holds; nothing is kept then.
        """
        try:
            data = LabelledData(self.path, owned_folder=self._folder, report=report)
        except InputError as error:
            self.kept.finish()  # to go on would end there again
            self.path.unlink(missing_ok=True)
            why = str(error).partition("is damaged (")[2].partition(");")[0]
            if not why:
                raise
            raise NumericalError(f"the result cannot be kept: {why}; nothing is written") from error
        self._folder = None
        if data.status == "interrupted":
            raise Interrupted(data)
        if not goes_on:
            self.kept.finish()
        _warn(data)
        return data

    def remove(self) -> None:
        """Remove a temporary file that became no value."""
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)


@contextmanager
def result_place(
    save_to: str | Path | None, *, may_exist: bool = False, resume: bool = False
) -> Iterator[ResultPlace]:
    """Give the place of a result, which nobody else may write meanwhile.

    ``resume`` says that the analysis goes on with what a killed one left there.

    Raises
    ------
    InputError
        If the file to keep exists, or cannot be written, or there is none to go on with.
    """
    if save_to is None:
        kept = KeptWork(resume=resume)
        folder = Path(tempfile.mkdtemp(prefix="vehicledyn-"))
        place = ResultPlace(folder, folder / "result.h5", kept)
    else:
        path = Path(save_to)
        if path.exists() and not (may_exist or resume):
            raise InputError(f"{given('save_to', str(path))}: exists; choose another path")
        check_output(path)
        kept = KeptWork(path, resume=resume)
        place = ResultPlace(None, path, kept)
    try:
        with kept:
            yield place
    except NumericalError:
        kept.finish()  # to go on would end there again
        raise
    finally:
        place.remove()


def reporter(progress: Progress) -> Callable[..., Any]:
    """Return what analyses report their progress to."""
    if callable(progress):
        wanted = progress
        return lambda text, fraction=None: wanted(text, fraction)
    return _print_line if progress else _silent


def _silent(text: str, fraction: float | None = None) -> None:
    """Print nothing."""


def _print_line(text: str, fraction: float | None = None) -> None:
    done = "" if fraction is None else f" {fraction:4.0%}"
    sys.stderr.write(f"\r\x1b[2K{text}{done}" if sys.stderr.isatty() else f"{text}{done}\n")
    sys.stderr.flush()


def warn_of(notes: Iterable[str]) -> None:
    """Issue the warnings among some notes, each once."""
    for note in dict.fromkeys(notes):
        if note.startswith(WARNING):
            _issue(note.removeprefix(WARNING), AccuracyWarning)


def _warn(data: LabelledData) -> None:
    """Issue what the notes warn of, and that an analysis is not whole."""
    remarks = (getattr(data.report, name, ()) for name in ("notes", "messages"))
    warn_of([*data.notes, *chain(*remarks)])
    if not data.is_whole:
        text = f"{data.status}: {data.status_message}" if data.status_message else data.status
        _issue(f"the {data.kind} is not whole: {text}", UnfinishedWarning)


def _issue(text: str, category: type[Warning]) -> None:
    """Warn at the line of the user's call."""
    frame, level = sys._getframe(), 1
    while frame.f_back is not None and frame.f_code.co_filename.startswith(str(FOLDER)):
        frame, level = frame.f_back, level + 1
    warnings.warn(text, category, stacklevel=level)
