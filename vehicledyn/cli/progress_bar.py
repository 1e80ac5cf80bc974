"""Progress of a computation: its phase by name and, where known, a bar with the time left."""

from __future__ import annotations

import contextlib
import math
import sys
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

_REFRESH = 0.1  # s between two pictures
_CLEAR = "\r\x1b[2K"


class Progress:
    """Shows the phase on a terminal only; with ``verbose`` the phases' names also elsewhere."""

    def __init__(self, *, quiet: bool = False, verbose: bool = False) -> None:
        self.live = not quiet and sys.stderr.isatty()
        self.lines = verbose and not self.live
        self.stage = ""
        self._shown = -math.inf
        self._bar: Bar | None = None

    def __call__(self, text: str, fraction: float | None = None) -> None:
        """Show a phase and, if it is known, the fraction of it that is done.

        A text that changes while its fraction grows, such as "3 of 8 cases", is one phase.
        """
        phase_goes_on = self._bar is not None and fraction is not None
        new_text, self.stage = text != self.stage, text
        if self.lines and new_text:
            sys.stderr.write(f"{text}\n")
            sys.stderr.flush()
        if not self.live:
            return
        now = time.monotonic()
        if now - self._shown < _REFRESH and (phase_goes_on or not new_text):
            return
        self._shown = now
        if fraction is None or (fraction >= 1.0 and self._bar is None):
            self._take_bar_away()
            sys.stderr.write(f"{_CLEAR}{text} ...")
            sys.stderr.flush()
        else:
            self._draw(text, fraction)

    def clear(self) -> None:
        """Take away what is shown."""
        self._take_bar_away()
        if self.live and self.stage:
            sys.stderr.write(_CLEAR)
            sys.stderr.flush()

    def _draw(self, text: str, fraction: float) -> None:
        part = min(max(fraction, 0.0), 1.0)
        bar = self._bar
        if bar is not None and part < bar.tasks[0].completed:  # another phase begins
            self._take_bar_away()
            bar = None
        if bar is None:
            sys.stderr.write(_CLEAR)
            bar = self._bar = _new_bar()
            bar.update(bar.add_task(text, total=1.0), completed=part)
            bar.start()
            bar.console.show_cursor(True)  # it would stay hidden where the program is killed
        bar.update(bar.tasks[0].id, description=text, completed=part)
        bar.refresh()

    def _take_bar_away(self) -> None:
        if self._bar is not None:
            with contextlib.suppress(OSError):
                self._bar.stop()
            self._bar = None


def _new_bar() -> Bar:
    """Return a bar that is drawn on request, by no thread, and leaves nothing behind."""
    from rich.console import Console
    from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    return Bar(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(),
        console=Console(file=sys.stderr, highlight=False),
        get_time=time.monotonic,
        auto_refresh=False,
        redirect_stdout=False,
        redirect_stderr=False,
        transient=True,
    )
