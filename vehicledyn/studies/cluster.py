"""Workers of a Dask cluster, which is used only when asked for, and only through TLS.

Dask's messages carry code: whoever may speak with its scheduler runs programs as every worker and
every client. Certificates on both sides decide who may.
"""

from __future__ import annotations

import contextlib
import logging
import os
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from vehicledyn.base.argument_names import given
from vehicledyn.base.errors import InputError, MissingPartError, NumericalError, VehicledynError
from vehicledyn.base.files.ownership import writable_by_others
from vehicledyn.studies.block import Work, compute_remotely, set_up
from vehicledyn.studies.pool import LIVES, Span, Spans, Take, divided

_POLL = 0.5
_PATIENCE = 60.0
_CONNECT_SECONDS = 10


@dataclass(frozen=True)
class ClusterAddress:
    """Where the scheduler is, and the folder of this user's certificate, key and trust.

    Raises
    ------
    InputError
        If connections to the address would not be encrypted.
    """

    scheduler: str
    certificates: Path

    def __post_init__(self) -> None:
        """Refuse connections that anyone on the network could join."""
        if not self.scheduler.startswith("tls://"):
            raise InputError(
                f"{given('scheduler', self.scheduler)}: write tls://HOST:PORT; without TLS "
                "anybody who "
                "reaches the scheduler can run programs as you (see docs/sweeps.md)"
            )

    def security(self) -> Any:
        """Return what Dask needs for connections that are encrypted and checked at both ends.

        Raises
        ------
        InputError
            If a file is missing, or others can read the key or write any of the files.
        """
        from distributed.security import Security

        names = ("ca.pem", "cert.pem", "key.pem")
        authority, certificate, key = (self._checked(name) for name in names)
        return Security(
            require_encryption=True,
            tls_ca_file=str(authority),
            tls_client_cert=str(certificate),
            tls_client_key=str(key),
        )

    def _checked(self, name: str) -> Path:
        path = self.certificates / name
        if not path.is_file():
            raise InputError(f"{given('tls', str(self.certificates))}: there is no file {name}")
        reason = writable_by_others(path)
        if reason:
            raise InputError(f"{given('tls', str(self.certificates))}: {reason}")
        if name == "key.pem" and hasattr(os, "geteuid") and path.stat().st_mode & 0o077:
            raise InputError(f"{path}: others can read this key; run chmod 600 on it")
        return path


@dataclass
class Cluster:
    """Workers of a Dask scheduler that somebody else looks after."""

    client: Any
    work: Work
    description: str
    deaths: Counter[Span] = field(default_factory=Counter)
    _running: dict[Any, Span] = field(default_factory=dict)
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

        waiting: list[Span] = []
        seen = time.monotonic()
        try:
            while True:
                workers = self.workers()
                seen = time.monotonic() if workers else seen
                if time.monotonic() - seen > _PATIENCE:
                    raise NumericalError(f"there are no workers at {self.client.scheduler.address}")
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

    def _submit(self, span: Span) -> None:
        try:
            future = self.client.submit(compute_remotely, self.work, *span, pure=False, retries=0)
        except Exception as error:
            raise self._gone() from error
        self._running[future] = span

    def _collect(self, future: Any, take: Take) -> list[Span]:
        """Take the block of a finished future; return spans to compute again."""
        from distributed import CancelledError, KilledWorker

        span = self._running.pop(future)
        try:
            block = future.result(timeout=_PATIENCE)
        except KilledWorker:
            return divided(span, self.work, take)
        except VehicledynError:
            raise
        except (CancelledError, OSError, TimeoutError) as error:
            self.workers()  # raises if the scheduler does not answer
            if self.client.status != "running":
                raise self._gone() from error
            self.deaths[span] += 1
            return divided(span, self.work, take) if self.deaths[span] >= LIVES else [span]
        take(block)
        return []

    def remarks(self) -> list[str]:
        """Return the number of times that cases were computed again."""
        again = self.deaths.total()
        return [f"cases lost with their workers were computed again {again} times"] if again else []

    def workers(self) -> int:
        """Return the number of workers.

        Raises
        ------
        NumericalError
            If the scheduler does not answer.
        """
        if self.client.status not in ("running", "newly-created"):
            raise self._gone()
        try:
            return len(self.client.run_on_scheduler(_list_workers))
        except Exception as error:
            raise self._gone() from error

    def _gone(self) -> NumericalError:
        return NumericalError(f"the scheduler at {self.client.scheduler.address} has gone away")

    def _cancel(self) -> None:
        with contextlib.suppress(Exception):
            if self._running:
                self.client.cancel(list(self._running))
        self._running.clear()


def _list_workers(dask_scheduler: Any) -> list[str]:
    return list(dask_scheduler.workers)


@contextlib.contextmanager
def open_cluster(work: Work, address: ClusterAddress) -> Iterator[Cluster]:
    """Give the workers of a scheduler.

    Raises
    ------
    MissingPartError
        If Dask is not installed.
    InputError
        If no scheduler that trusts the certificates answers.
    """
    if find_spec("distributed") is None:
        raise MissingPartError("a cluster needs Dask: pip install 'vehicledyn[cluster]'")
    from distributed import Client

    silence()
    try:
        client = Client(address.scheduler, security=address.security(), timeout=_CONNECT_SECONDS)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f"{given('scheduler', address.scheduler)}: no scheduler answers there that trusts the "
            f"certificates in {address.certificates} ({type(error).__name__})"
        ) from None
    try:
        yield Cluster(client, work, f"the cluster at {address.scheduler}")
    finally:
        with contextlib.suppress(Exception):
            client.close(timeout=5)


def silence() -> None:
    """Keep Dask from writing to the terminal; what matters is reported by us."""
    for name in ("distributed", "tornado", "asyncio", *logging.root.manager.loggerDict):
        if name.partition(".")[0] in ("distributed", "tornado", "asyncio", "bokeh"):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
