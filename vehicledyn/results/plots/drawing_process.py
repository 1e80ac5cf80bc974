"""A process that loads the plotting library while a run computes, and draws the figures then."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from vehicledyn.base.own_programs import end_program, start_module
from vehicledyn.base.processors import cores

_MODULE = "vehicledyn.results.plots.drawing_worker"
_PATIENCE = 2.0
"""Time an interrupted process has to remove a picture that is not whole [s]."""

Draw = Callable[[Path, Path], int]


@contextmanager
def drawing_process(*, wanted: bool) -> Iterator[Draw]:
    """Give a function that draws the plots a result file describes and returns how many pictures.

    It takes result file and folder, and raises what ``draw_described`` raises. The process starts
    with the block; where there is none, or it fails, the figures are drawn in this process.

    Parameters
    ----------
    wanted
        Whether there will be something to draw; nothing is started if not.
    """
    worker = None
    if wanted and _is_faster():
        with suppress(OSError):
            worker = _Worker(start_module(_MODULE, subprocess.DEVNULL))
    try:
        yield draw_here if worker is None else worker.draw
    finally:
        if worker is not None:
            worker.end()


def _is_faster() -> bool:
    """Return whether there is a second core, and a library to load."""
    return cores() > 1 and "matplotlib" not in sys.modules


@dataclass
class _Worker:
    process: subprocess.Popen[bytes]
    is_drawing: bool = False

    def draw(self, path: Path, folder: Path) -> int:
        """Have the pictures drawn, or draw them here."""
        self.is_drawing = True
        request = json.dumps([str(path.absolute()), str(folder.absolute())])
        with suppress(OSError):  # a process that is gone does not reply
            self.process.stdin.write(f"{request}\n".encode())  # type: ignore[union-attr]
            self.process.stdin.flush()  # type: ignore[union-attr]
        reply = self.process.stdout.readline()  # type: ignore[union-attr]
        self.is_drawing = False
        return int(reply) if reply else draw_here(path, folder)

    def end(self) -> None:
        """End the process, after what it draws is removed."""
        if self.is_drawing and hasattr(os, "killpg"):
            with suppress(ProcessLookupError, subprocess.TimeoutExpired):
                os.killpg(self.process.pid, signal.SIGINT)
                self.process.wait(_PATIENCE)
        end_program(self.process)


def draw_here(path: Path, folder: Path) -> int:
    """Draw the plots that a result file describes in this process; return how many pictures."""
    from vehicledyn.results.plots.run_plots import draw_described

    return len(draw_described(path, folder))
