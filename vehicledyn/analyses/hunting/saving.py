"""Keeps a hunting study on the disk while it goes, and goes on with one that was killed."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from types import TracebackType
from typing import Self

from vehicledyn.analyses.hunting.start import HuntSettings
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError
from vehicledyn.base.version import VERSION
from vehicledyn.codegen.toolchain.fingerprint import fingerprint
from vehicledyn.results.hdf5.checkpoint import Checkpoint
from vehicledyn.results.hdf5.output import OutputLock
from vehicledyn.results.tables.hunt_table import RUNNING, HuntTable, read_hunt, write_hunt

_INTERVAL, _PART = 1.0, 0.05
"""Seconds between two times that the file is written, and part of the time that writing takes."""


def identity_of(prepared: Prepared, settings: HuntSettings) -> str:
    """Return a text that is equal for studies that find the same."""
    e = prepared.equations
    facts = [
        VERSION,
        fingerprint(e),
        [table.digest for table in e.tables],
        [float(value) for value in prepared.kernel.parameters],
        [float(s.start) for s in (*e.states, *e.unknowns)],
        asdict(settings),
    ]
    return hashlib.sha256(json.dumps(facts, default=str).encode()).hexdigest()


def finished(output: Path, identity: str) -> HuntTable | None:
    """Return the study of a file that needs no going on with, None where it does.

    Raises
    ------
    InputError
        If the file holds another study, or cannot be read.
    """
    if not output.exists():
        return None
    table = read_hunt(output)
    if table.identity != identity:
        raise InputError(
            f"{output}: holds another study: the model, the options or the version of the program "
            f"differ; start again without {argument('resume')}, choose another output, or "
            "undo the change"
        )
    return table if table.is_finished else None


class Saving:
    """Writes a study at most once a second; use it in a ``with`` statement.

    Parameters
    ----------
    output
        The result file.
    identity
        Of the study.
    resume
        Whether to go on with what a killed study left.
    """

    def __init__(self, output: Path, identity: str, *, resume: bool) -> None:
        self._output, self._identity = output, identity
        self._lock = OutputLock(output.resolve())
        try:
            self.checkpoint = Checkpoint(output.resolve(), identity, resume=resume)
        except BaseException:
            self._lock.release()
            raise
        self._next = 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.checkpoint.close()
        self._lock.release()

    def maybe(self, table: Callable[[], HuntTable]) -> None:
        """Write the study as it is by now, if the last time is long enough ago.

        One that goes on with another waits until it holds all that the other did.
        """
        begun = time.monotonic()
        if begun < self._next or self.checkpoint.is_recalling:
            return
        self._write(replace(table(), status=RUNNING))
        ended = time.monotonic()
        self._next = ended + max(_INTERVAL, (ended - begun) / _PART)

    def finish(self, table: HuntTable) -> None:
        """Write the study; what is only needed to go on with it is removed if it is finished."""
        self._write(table)
        if table.is_finished:
            self.checkpoint.remove()

    def _write(self, table: HuntTable) -> None:
        write_hunt(self._output, replace(table, identity=self._identity), is_locked=True)
