"""What the user sees: results on standard output, progress and messages on standard error."""

from __future__ import annotations

import json
import logging
import math
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError, StoppedError
from vehicledyn.base.files.whole_file import write_whole
from vehicledyn.base.report import Report
from vehicledyn.cli.progress_bar import Progress

_PIPE_CLOSED = 141
_CONTROLS = {n: f"\\u{n:04x}" for n in (*range(32), *range(127, 160)) if n not in (9, 10)}
"""Signs that would steer a terminal, such as those of colours and titles, as escapes."""
_quiet: ContextVar[bool] = ContextVar("quiet", default=False)


def emit(text: str) -> None:
    """Write a result to standard output; leave quietly if nobody reads it any more.

    Raises
    ------
    InputError
        If standard output cannot be written for another reason, such as a full disk.
    """
    try:
        shown = text.translate(_CONTROLS)
        sys.stdout.write(shown if shown.endswith("\n") else f"{shown}\n")
        sys.stdout.flush()
    except BrokenPipeError:
        _give_up_stdout()
        sys.exit(_PIPE_CLOSED)
    except OSError as error:
        _give_up_stdout()
        raise InputError(f"standard output cannot be written: {error.strerror}") from None


def emit_report(
    report: Report,
    *,
    as_json: bool,
    file: Path | None = None,
    messages: Sequence[str] | None = None,
) -> None:
    """Write a report to standard output, and as JSON to a file if one is given.

    ``messages`` take the place of those in the report's data, if it has any.
    """
    if file is None and not as_json:
        emit(report.as_text())
        return
    data = report.as_dict()
    if messages is not None and "messages" in data:
        data["messages"] = messages
    text = to_json(data)
    if file is not None:
        write_text(file, text)
    emit(text if as_json else report.as_text())


def set_quiet(wanted: bool) -> bool:
    """Set whether the verb that runs shows errors only; return the same."""
    _quiet.set(wanted)
    return wanted


def is_quiet() -> bool:
    """Return whether the verb that runs shows errors only."""
    return _quiet.get()


def tell(text: str) -> None:
    """Write a message to standard error."""
    sys.stderr.write(f"{text.translate(_CONTROLS)}\n")
    sys.stderr.flush()


def to_json(value: Any) -> str:
    """Return plain data as JSON text; numbers that are not finite become null."""
    return json.dumps(_plain(value), indent=2, ensure_ascii=False, allow_nan=False)


def write_text(path: Path, text: str) -> None:
    """Write a text file.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    try:
        write_whole(path, f"{text}\n")
    except OSError as error:
        raise InputError(
            f"{path}: cannot be written: {error.strerror}; choose another file"
        ) from None


@contextmanager
def show_progress(*, quiet: bool = False, verbose: bool = False) -> Iterator[Progress]:
    """Show the progress of the block, and where it was when the user interrupts it."""
    progress = Progress(quiet=quiet, verbose=verbose)
    try:
        yield progress
    except KeyboardInterrupt:
        place = f" at: {progress.stage}" if progress.stage else ""
        raise StoppedError(f"interrupted{place}") from None
    finally:
        progress.clear()


def listen(*, quiet: bool, verbose: bool) -> None:
    """Send the program's log to standard error: warnings, more if verbose, errors only if quiet."""
    level = logging.ERROR if quiet else logging.INFO if verbose else logging.WARNING
    logging.basicConfig(level=level, format="%(message)s", stream=sys.stderr)


def _give_up_stdout() -> None:
    # The interpreter flushes standard output once more at its end; give it somewhere to go.
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, complex):
        return {"real": _plain(value.real), "imaginary": _plain(value.imag)}
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return str(value) if isinstance(value, Path) else value
