"""Worker processes on this machine, reached through pipes that nobody else can open.

The workers are started as programs, not by multiprocessing, so that nothing depends on how this
process began; they hear no Ctrl-C, and end when their pipe does.
"""

from __future__ import annotations

import contextlib
import itertools
import queue
import signal
import subprocess
import tempfile
import threading
from collections import Counter, deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import IO, Any

from vehicledyn.base.errors import NumericalError
from vehicledyn.base.own_programs import end_program, start_module
from vehicledyn.studies.block import Work
from vehicledyn.studies.pool import LIVES, Span, Spans, Take, divided
from vehicledyn.studies.worker_messages import receive, send
from vehicledyn.studies.worker_process import BLOCK, BUG, ERROR, READY

_MODULE = "vehicledyn.studies.worker_process"
_POLL = 0.5
_FAILED_STARTS = 3
"""Workers that end before they are ready, one after the other, before the sweep gives up."""

_CLOSED = ("closed", None)


@dataclass(eq=False)
class WorkerProcess:
    """One worker: its process, what it writes to standard error, and the span it computes."""

    process: subprocess.Popen[bytes]
    errors: IO[bytes]
    reader: threading.Thread | None = None
    span: Span | None = None
    is_ready: bool = False

    def order(self, span: Span) -> None:
        """Ask for the block of a span; a worker that is gone is noticed by its reader."""
        self.span = span
        with contextlib.suppress(OSError):
            send(self.process.stdin, span)  # type: ignore[arg-type]

    def end(self) -> str:
        """End the process with all it started; return how it ended, and why if it said so."""
        code = end_program(self.process)
        if self.reader is not None:
            self.reader.join()
        with self.errors:
            self.errors.seek(0)
            lines = self.errors.read().decode("utf-8", "replace").splitlines()
        words = [line.strip() for line in lines if line.strip()][-1:] if code > 0 else []
        return ": ".join([_ending(code), *words])


@dataclass
class Processes:
    """Keeps so many workers busy; one that dies is replaced and its span computed again."""

    work: Work
    count: int
    _workers: list[WorkerProcess] = field(default_factory=list)
    _replies: queue.SimpleQueue[tuple[WorkerProcess, Any]] = field(
        default_factory=queue.SimpleQueue
    )
    _waiting: deque[Span] = field(default_factory=deque)
    _deaths: Counter[Span] = field(default_factory=Counter)
    _endings: Counter[str] = field(default_factory=Counter)
    _failed_starts: int = 0

    @property
    def description(self) -> str:
        """Who computes, for people."""
        return f"{self.count} processes"

    def workers(self) -> int:
        """Return the number of workers."""
        return self.count

    def remarks(self) -> list[str]:
        """Return what the user should know: workers that died."""
        found = []
        for how, number in self._endings.items():
            who, whose = ("process", "its") if number == 1 else ("processes", "their")
            found.append(
                f"{number} worker {who} ended unexpectedly ({how}); "
                f"{whose} cases were computed again"
            )
        return found

    def keep_up(self) -> None:
        """Start workers until there are as many as wanted."""
        while len(self._workers) < self.count:
            self._workers.append(self._start())

    def compute(self, spans: Spans, take: Take) -> None:
        """Keep every worker busy until all spans are computed.

        Raises
        ------
        NumericalError
            If workers end before they can compute anything.
        VehicledynError
            What a worker raised that concerns all cases.
        """
        while self._is_waiting(spans) or any(worker.span for worker in self._workers):
            self.keep_up()
            for worker in self._workers:
                if worker.is_ready and worker.span is None and self._is_waiting(spans):
                    worker.order(self._waiting.popleft())
            worker, (kind, content) = self._next_reply()
            if kind == READY:
                worker.is_ready, self._failed_starts = True, 0
            elif kind == BLOCK:
                worker.span = None
                take(content)
            elif kind == BUG:
                raise RuntimeError(content)
            elif kind == ERROR:
                raise content
            else:
                self._replace(worker, take)

    def stop(self) -> None:
        """End all workers; one in the middle of a block, which nobody waits for, at once."""
        for worker in self._workers:
            worker.end()
        self._workers = []

    def _is_waiting(self, spans: Spans) -> bool:
        if not self._waiting:
            self._waiting.extend(itertools.islice(spans, 1))
        return bool(self._waiting)

    def _next_reply(self) -> tuple[WorkerProcess, tuple[str, Any]]:
        while True:
            with contextlib.suppress(queue.Empty):
                return self._replies.get(timeout=_POLL)

    def _replace(self, worker: WorkerProcess, take: Take) -> None:
        """Forget a worker that died; its span is tried again, then case by case, then given up."""
        self._workers.remove(worker)
        how = worker.end()
        if not worker.is_ready:
            self._failed_starts += 1
            if self._failed_starts >= _FAILED_STARTS:
                raise NumericalError(f"the worker processes end before they are ready ({how})")
            return
        self._endings[how] += 1
        if worker.span is None:
            return
        self._deaths[worker.span] += 1
        if self._deaths[worker.span] < LIVES:
            self._waiting.append(worker.span)
        else:
            self._waiting.extend(divided(worker.span, self.work, take))

    def _start(self) -> WorkerProcess:
        errors = tempfile.TemporaryFile()  # noqa: SIM115
        process = start_module(_MODULE, errors)
        worker = WorkerProcess(process, errors)
        worker.reader = threading.Thread(target=self._read, args=(worker,), daemon=True)
        worker.reader.start()
        return worker

    def _read(self, worker: WorkerProcess) -> None:
        """Hand the work to a worker and pass on what it replies, until it ends."""
        stdin, stdout = worker.process.stdin, worker.process.stdout
        with contextlib.suppress(OSError, EOFError, ValueError):
            send(stdin, self.work)  # type: ignore[arg-type]
            while True:
                self._replies.put((worker, receive(stdout)))  # type: ignore[arg-type]
        self._replies.put((worker, _CLOSED))


@contextlib.contextmanager
def own_processes(work: Work, count: int) -> Iterator[Processes]:
    """Give so many worker processes on this machine, which set up the study's model at once."""
    processes = Processes(work, count)
    try:
        processes.keep_up()
        yield processes
    finally:
        processes.stop()


def _ending(code: int) -> str:
    if code >= 0:
        return f"exit code {code}"
    with contextlib.suppress(ValueError):
        return f"signal {-code}, {signal.Signals(-code).name}"
    return f"signal {-code}"
