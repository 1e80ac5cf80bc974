"""Modules of this package started as programs of their own, whatever this process runs from."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from contextlib import suppress
from typing import IO

from vehicledyn.base.version import FOLDER


def start_module(module: str, errors: IO[bytes] | int) -> subprocess.Popen[bytes]:
    """Start a module that reads requests from a pipe and writes replies to another.

    It hears no Ctrl-C: who starts it ends it.

    Parameters
    ----------
    module
        Full name of the module.
    errors
        Where its standard error goes.

    Raises
    ------
    OSError
        If no process can be started.
    """
    paths = [str(FOLDER.parent), *filter(None, [os.environ.get("PYTHONPATH")])]
    return subprocess.Popen(
        [sys.executable, "-P", "-m", module],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths), "OMP_NUM_THREADS": "1"},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=errors,
        start_new_session=True,
    )


def end_program(process: subprocess.Popen[bytes]) -> int:
    """End a program with all it started, close its pipes and return its exit code."""
    if process.poll() is None:
        with suppress(ProcessLookupError):
            if hasattr(os, "killpg"):
                os.killpg(process.pid, signal.SIGKILL)
            process.kill()
    code = process.wait()
    for stream in (process.stdin, process.stdout):
        with suppress(OSError):
            stream.close()  # type: ignore[union-attr]
    return code
