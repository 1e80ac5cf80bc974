"""Writes a hunting study to its file while it goes."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.tables.hunt_table import RUNNING, HuntTable, read_hunt, write_hunt

_INTERVAL, _PART = 1.0, 0.05
"""Seconds between two times that the file is written, and part of the time that writing takes."""


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
    """Writes a study at most once a second.

    Parameters
    ----------
    output
        The result file.
    identity
        Of the study.
    kept
        What is kept beside the file.
    """

    def __init__(self, output: Path, identity: str, kept: KeptWork) -> None:
        self._output, self._identity, self._kept, self._next = output, identity, kept, 0.0

    def maybe(self, table: Callable[[], HuntTable]) -> None:
        """Write the study as it is by now, if the last time is long enough ago.

        One that goes on with another waits until it holds all that the other did.
        """
        begun = time.monotonic()
        if begun < self._next or self._kept.is_recalling:
            return
        self.write(replace(table(), status=RUNNING))
        ended = time.monotonic()
        self._next = ended + max(_INTERVAL, (ended - begun) / _PART)

    def write(self, table: HuntTable) -> None:
        """Write the study."""
        write_hunt(self._output, replace(table, identity=self._identity))
