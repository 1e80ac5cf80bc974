"""The program of a worker process: spans of cases come in by a pipe, blocks go out by another.

It ends when its input does, so that no worker outlives the sweep that started it.
"""

from __future__ import annotations

import os
import queue
import sys
import threading
import warnings
from typing import Any, BinaryIO

from vehicledyn.base.errors import VehicledynError
from vehicledyn.studies.block import compute_remotely, set_up
from vehicledyn.studies.worker_messages import receive, send

READY, BLOCK, ERROR, BUG = "ready", "block", "error", "bug"
"""Kinds of replies: the last two carry an error of ours, or the description of any other."""


def main() -> None:
    """Set up the model of the work that comes first, then compute one span after the other."""
    warnings.simplefilter("ignore", RuntimeWarning)  # each case's numbers are judged themselves
    requests, replies = sys.stdin.buffer, _own_output()
    send(replies, (READY, None))
    waiting: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(requests, waiting), daemon=True).start()
    work = waiting.get()
    set_up(work)
    while True:
        first, stop = waiting.get()
        send(replies, _computed(work, first, stop))


def _own_output() -> BinaryIO:
    """Return standard output for replies alone; what else is printed goes to standard error."""
    replies = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    return replies


def _listen(requests: BinaryIO, waiting: queue.SimpleQueue[Any]) -> None:
    try:
        while True:
            waiting.put(receive(requests))
    except EOFError:
        os._exit(0)  # the sweep has ended; nobody waits for the block under way


def _computed(work: Any, first: int, stop: int) -> tuple[str, Any]:
    try:
        return BLOCK, compute_remotely(work, first, stop)
    except VehicledynError as error:
        return ERROR, error
    except MemoryError:
        raise
    except Exception as error:  # shown by the process that the user sees
        return BUG, " ".join(f"{type(error).__name__}: {error}".split())


if __name__ == "__main__":
    main()
