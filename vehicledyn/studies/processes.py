"""Worker processes on this machine: a Dask scheduler in this process and workers of its own.

The workers are started as programs, not by multiprocessing, so that nothing depends on how this
process began; they hear no Ctrl-C, and end when the connection to their scheduler does.
"""

from __future__ import annotations

import contextlib
import logging
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import vehicledyn

_STOP_SECONDS = 5.0
_LAST_SECONDS = 1.0
"""Time for the scheduler to close, and for all workers together to end [s]."""
_COMMAND = ("-m", "distributed.cli.dask_worker")
_OPTIONS = (
    *("--no-nanny", "--nthreads", "1", "--no-dashboard", "--memory-limit", "0"),
    *("--death-timeout", "30"),
)


@dataclass
class Processes:
    """Worker processes; one that died is replaced as long as the others work."""

    address: str
    count: int
    running: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def keep_up(self) -> None:
        """Start workers until there are as many as wanted."""
        self.running = [process for process in self.running if process.poll() is None]
        while len(self.running) < self.count:
            self.running.append(self._start())

    def stop(self) -> None:
        """End all workers; one in the middle of a block, which nobody waits for, at once."""
        for process in self.running:
            process.terminate()
        end = time.monotonic() + _LAST_SECONDS
        for process in self.running:
            try:
                process.wait(max(0.0, end - time.monotonic()))
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self.running = []

    def _start(self) -> subprocess.Popen[bytes]:
        folder = str(Path(vehicledyn.__file__).parents[1])
        paths = [folder, *filter(None, [os.environ.get("PYTHONPATH")])]
        return subprocess.Popen(
            [
                sys.executable,
                *_COMMAND,
                self.address,
                *_OPTIONS,
            ],
            env=os.environ | {"PYTHONPATH": os.pathsep.join(paths), "OMP_NUM_THREADS": "1"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )


@contextlib.contextmanager
def own_processes(count: int) -> Iterator[tuple[Any, Processes]]:
    """Give a scheduler in this process and so many workers on this machine."""
    from distributed import LocalCluster

    silence()
    cluster = LocalCluster(
        n_workers=0,
        processes=False,
        dashboard_address=":0",
        protocol="tcp://",
        host="127.0.0.1",
        silence_logs=False,
    )
    processes = Processes(str(cluster.scheduler_address), count)
    try:
        processes.keep_up()
        yield cluster, processes
    finally:
        with contextlib.suppress(Exception):
            cluster.close(timeout=_STOP_SECONDS)
        processes.stop()


def silence() -> None:
    """Keep Dask from writing to the terminal; what matters is told by us."""
    for name in ("distributed", "tornado", "asyncio", *logging.root.manager.loggerDict):
        if name.partition(".")[0] in ("distributed", "tornado", "asyncio", "bokeh"):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
