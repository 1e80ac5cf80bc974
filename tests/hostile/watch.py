"""Waits for a child and tells one that sleeps for ever from one that a busy machine starves."""

import contextlib
import os
import select
import signal
import time
from pathlib import Path

ASLEEP_SECONDS = 60
"""Longest time for which no thread of a child and its children wants the processor [s]."""
LOOK_SECONDS = 1.0
"""Time between two looks at whether they want it [s]."""
_WANTING = {"R"}
"""States of threads that run or wait for the processor."""


class Watch:
    """The time that a group of processes has slept; it ends the first of them after too much."""

    def __init__(self, number):
        with contextlib.suppress(OSError):
            os.setpgid(number, number)  # unless it has done so itself
        self._number, self._asleep = number, 0.0
        self._looked = time.monotonic()

    def look(self):
        """Count the time since the last look unless the group wants the processor now."""
        now = time.monotonic()
        past, self._looked = now - self._looked, now
        if is_awake(self._number):
            return
        self._asleep += min(past, 2.0 * LOOK_SECONDS)  # the watch may be starved itself
        if self._asleep > ASLEEP_SECONDS:
            os.kill(self._number, signal.SIGALRM)
            os.killpg(self._number, signal.SIGKILL)

    def wait(self):
        """Wait for the end of the first process; return its status and what it used."""
        end = os.pidfd_open(self._number)
        try:
            while not select.select([end], [], [], LOOK_SECONDS)[0]:
                self.look()
        finally:
            os.close(end)
        _, status, usage = os.wait4(self._number, 0)
        return status, usage

    def receive(self, pipe):
        """Return what the group sends; EOFError where its end of the pipe is closed."""
        while not pipe.poll(LOOK_SECONDS):
            self.look()
        return pipe.recv()


def is_awake(group):
    """Return whether a thread of a group of processes runs or waits for the processor."""
    return any(
        _state_and_group(thread)[0] in _WANTING
        for process in Path("/proc").glob("[0-9]*")
        if _state_and_group(process)[1] == str(group)
        for thread in process.glob("task/*")
    )


def _state_and_group(place):
    """Return the state and the process group of a process or a thread that may have ended."""
    try:
        fields = (place / "stat").read_text("utf-8", "replace").rpartition(")")[2].split()
    except (FileNotFoundError, ProcessLookupError):
        return "", ""
    return fields[0], fields[2]
