"""Commands of the program in processes of their own, which a test waits for or kills."""

import contextlib
import os
import signal
import sys
import time

from harness import call


class start:  # noqa: N801
    """A forked process that calls the program, changed first; it and its children end together."""

    def __init__(self, folder, command, change=None):
        sys.stdout.flush()
        sys.stderr.flush()
        self._begun, self.share, self.seconds = time.monotonic(), 1.0, 0.0
        self.number = os.fork()
        if self.number == 0:
            code = 99
            try:
                os.setpgid(0, 0)
                os.chdir(folder)
                nothing = os.open(os.devnull, os.O_RDWR)
                for stream in range(3):
                    os.dup2(nothing, stream)
                if change is not None:
                    change()
                code = call(command)
            finally:
                os._exit(code)
        with contextlib.suppress(OSError):
            os.setpgid(self.number, self.number)

    def wait(self):
        """Return the exit code."""
        _, status = os.waitpid(self.number, 0)
        return os.waitstatus_to_exitcode(status)

    def kill(self, with_children=True):
        """Kill the process, and its children; return whether it had not ended before.

        ``share`` is the part of the time that it had the processor for, ``seconds`` how long.
        """
        with contextlib.suppress(ProcessLookupError):
            (os.killpg if with_children else os.kill)(self.number, signal.SIGKILL)
        past = time.monotonic() - self._begun
        _, status, usage = os.wait4(self.number, 0)
        self.seconds = usage.ru_utime + usage.ru_stime
        self.share = min(1.0, self.seconds / past)
        return os.WIFSIGNALED(status)

    def kill_children(self):
        """Kill what it started and left."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.number, signal.SIGKILL)

    def has_children(self):
        """Return whether any process that it started is left."""
        try:
            os.killpg(self.number, 0)
        except ProcessLookupError:
            return False
        return True
