"""Who computes the blocks of a study: this process, or processes that Dask looks after."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeAlias

import numpy as np

from vehicledyn.base.errors import InputError, MissingPartError, NumericalError, VehicledynError
from vehicledyn.results.study_layout import StudyBlock
from vehicledyn.studies.block import Work, Worker, compute_remotely, set_up
from vehicledyn.studies.processes import Processes, own_processes, silence

Spans: TypeAlias = Iterator[tuple[int, int]]
Take: TypeAlias = Callable[[StudyBlock], None]

_POLL = 0.5
_PATIENCE = 60.0
_CONNECT_SECONDS = 10
_LIVES = 3
"""How many workers may die over a block before its cases are tried one by one."""


class Pool(Protocol):
    """Computes spans of cases and hands each block over as it comes."""

    @property
    def description(self) -> str:
        """Who computes, for people."""

    def compute(self, spans: Spans, take: Take) -> None:
        """Compute spans of cases in any order; ``take`` gets every block once."""


@dataclass(frozen=True)
class Alone:
    """The process itself."""

    worker: Worker
    description: str = "one process"

    def compute(self, spans: Spans, take: Take) -> None:
        """Compute one span after the other."""
        for first, stop in spans:
            take(self.worker.compute(first, stop))


@dataclass
class Cluster:
    """Workers of a Dask scheduler; ``own`` are those that this process started."""

    client: Any
    work: Work
    description: str
    own: Processes | None = None
    deaths: dict[tuple[int, int], int] = field(default_factory=dict)
    _running: dict[Any, tuple[int, int]] = field(default_factory=dict)
    _warming: list[Any] = field(default_factory=list)

    def warm_up(self) -> None:
        """Let every worker set up the study's model while this process does other things."""
        with contextlib.suppress(Exception):
            for address in self.client.run_on_scheduler(_list_workers):
                self._warming.append(
                    self.client.submit(set_up, self.work, workers=[address], pure=False)
                )

    def compute(self, spans: Spans, take: Take) -> None:
        """Keep twice as many spans under way as there are workers.

        Raises
        ------
        NumericalError
            If the scheduler or all workers have gone away.
        InputError
            If a worker runs another version of the program.
        """
        from distributed import CancelledError, wait

        waiting: list[tuple[int, int]] = []
        seen = time.monotonic()
        try:
            while True:
                workers = self.workers()
                seen = time.monotonic() if workers else seen
                if time.monotonic() - seen > _PATIENCE:
                    raise NumericalError(f"there are no workers at {self._address()}")
                while len(self._running) < 2 * max(1, workers):
                    span = waiting.pop() if waiting else next(spans, None)
                    if span is None:
                        break
                    self._submit(span)
                if not self._running and not waiting:
                    return
                with contextlib.suppress(TimeoutError, CancelledError):
                    wait(list(self._running), timeout=_POLL, return_when="FIRST_COMPLETED")
                for future in [f for f in self._running if f.done()]:
                    waiting += self._collect(future, take)
        finally:
            self._cancel()

    def _submit(self, span: tuple[int, int]) -> None:
        try:
            future = self.client.submit(compute_remotely, self.work, *span, pure=False, retries=0)
        except Exception as error:
            raise self._gone() from error
        self._running[future] = span

    def _collect(self, future: Any, take: Take) -> list[tuple[int, int]]:
        """Take the block of a finished future; return spans to compute again."""
        from distributed import CancelledError, KilledWorker

        span = self._running.pop(future)
        try:
            block = future.result(timeout=_PATIENCE)
        except KilledWorker:
            return self._died(span, take)
        except VehicledynError:
            raise
        except (CancelledError, OSError, TimeoutError) as error:
            self.workers()  # raises if the scheduler does not answer
            if self.client.status != "running":
                raise self._gone() from error
            self.deaths[span] = self.deaths.get(span, 0) + 1
            return self._died(span, take) if self.deaths[span] >= _LIVES else [span]
        take(block)
        return []

    def _died(self, span: tuple[int, int], take: Take) -> list[tuple[int, int]]:
        """Return the cases one by one after a block has killed its workers; fail a single one."""
        first, stop = span
        if stop - first > 1:
            return [(number, number + 1) for number in range(first, stop)]
        block = StudyBlock(first, self.work.design.cases(first, stop))
        block.fail(0, float(np.nan), f"the worker process died {_LIVES} times computing this case")
        take(block)
        return []

    def workers(self) -> int:
        """Return the number of workers.

        Raises
        ------
        NumericalError
            If the scheduler does not answer.
        """
        if self.own is not None:
            self.own.keep_up()
        if self.client.status not in ("running", "newly-created"):
            raise self._gone()
        try:
            return len(self.client.run_on_scheduler(_list_workers))
        except Exception as error:
            raise self._gone() from error

    def _gone(self) -> NumericalError:
        return NumericalError(f"the scheduler at {self._address()} has gone away")

    def _address(self) -> str:
        return "this machine" if self.own else str(self.client.scheduler.address)

    def _cancel(self) -> None:
        with contextlib.suppress(Exception):
            if self._running:
                self.client.cancel(list(self._running))
        self._running.clear()


def _list_workers(dask_scheduler: Any) -> list[str]:
    return list(dask_scheduler.workers)


def dask_is_there() -> bool:
    """Return whether Dask's distributed scheduler is installed."""
    from importlib.util import find_spec

    return find_spec("distributed") is not None


@contextlib.contextmanager
def open_cluster(work: Work, *, workers: int, scheduler: str | None) -> Iterator[Cluster]:
    """Give a cluster of processes of our own, or the one at an address.

    Raises
    ------
    MissingPartError
        If Dask is not installed.
    InputError
        If there is no scheduler at the address.
    """
    if not dask_is_there():
        raise MissingPartError(
            "several processes need Dask: pip install 'vehicledyn[sweep]', or take --workers 1"
        )
    from distributed import Client

    silence()
    if scheduler is not None:
        try:
            client = Client(scheduler, timeout=_CONNECT_SECONDS)
        except (OSError, ValueError, TimeoutError) as error:
            raise InputError(
                f"--scheduler {scheduler}: no scheduler answers there ({type(error).__name__}); "
                "write an address such as tcp://127.0.0.1:8786"
            ) from None
        try:
            yield Cluster(client, work, f"the cluster at {scheduler}")
        finally:
            _close(client)
        return
    with own_processes(workers) as (cluster, processes):
        client = Client(cluster, timeout=_PATIENCE)
        try:
            yield Cluster(client, work, f"{workers} processes", processes)
        finally:
            _close(client)


def _close(client: Any) -> None:
    with contextlib.suppress(Exception):
        client.close(timeout=5)
