"""Reads MATLAB and MDF files in a process of its own: damaged ones end programs that read them.

As a program of its own it takes what to read as a line of JSON, and replies with encoded columns.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from vehicledyn.base.errors import InputError, MissingPartError
from vehicledyn.base.own_programs import end_program, start_module
from vehicledyn.base.step_memory import decode, encode
from vehicledyn.studies.identification.data_columns import DataColumn
from vehicledyn.studies.identification.matlab_data import read_matlab
from vehicledyn.studies.identification.mdf_data import read_mdf

_READERS: dict[str, Callable[[Path, Sequence[str]], list[DataColumn]]] = {
    "MATLAB": read_matlab,
    "MDF": read_mdf,
}
_MOST_SECONDS = 300.0
_COLUMNS, _WRONG, _MISSING = "columns", "wrong", "missing"


def read_apart(kind: str, path: Path, names: Sequence[str]) -> list[DataColumn]:
    """Return columns of a "MATLAB" or "MDF" file.

    Raises
    ------
    InputError
        If the file is damaged, or a column is missing or holds no numbers.
    MissingPartError
        If what reads the file is not installed.
    """
    process = start_module(__name__, subprocess.DEVNULL)
    asked = json.dumps([kind, str(path), list(names)]).encode()
    reply = b""
    try:
        with suppress(subprocess.TimeoutExpired):
            reply, _ = process.communicate(asked, timeout=_MOST_SECONDS)
    finally:
        code = end_program(process)
    if code or not reply:
        raise InputError(f"{path}: is damaged, reading it as a {kind} file {_ended(code)}")
    how, found, about = decode(reply, {DataColumn.__name__: DataColumn})
    if how == _MISSING:
        raise MissingPartError(found)
    if how == _WRONG:
        raise InputError(found, about=about)
    return list(found)


def _ended(code: int) -> str:
    """Return how a reader ended that gave no columns."""
    if code == -signal.SIGKILL:
        return f"takes more than {_MOST_SECONDS:g} s or all memory"
    return f"ends the program that does it (exit code {code})"


def main() -> None:
    """Read what standard input asks for; what readers print does not get into the reply."""
    with os.fdopen(os.dup(1), "wb") as out:
        os.dup2(2, 1)
        kind, path, names = json.load(sys.stdin)
        try:
            out.write(encode((_COLUMNS, _READERS[kind](Path(path), names), ())))
        except MissingPartError as error:
            out.write(encode((_MISSING, str(error), ())))
        except InputError as error:
            out.write(encode((_WRONG, str(error), error.about)))


if __name__ == "__main__":
    main()
