"""What a computation has found, kept beside its output while it goes, so that a killed one goes on.

Commands that take long ask a :class:`Memory` for the result of each step, which is computed or,
after a kill, recalled. The end is that of a computation in one piece, and at most the step under
way is lost.
"""

from __future__ import annotations

import hashlib
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError
from vehicledyn.base.step_memory import Memory, Shelf, digest
from vehicledyn.base.version import VERSION
from vehicledyn.results.hdf5.checkpoint import Checkpoint
from vehicledyn.results.hdf5.output import OutputLock


class KeptWork:
    """The lock of an output and the checkpoint beside it; use it in a ``with`` statement.

    Parameters
    ----------
    output
        The result file, which nobody else may write meanwhile; None to keep nothing.
    resume
        Whether to go on with what a killed computation left.

    Raises
    ------
    InputError
        If there is no output to go on with, or another command writes it.
    """

    def __init__(self, output: Path | None = None, *, resume: bool = False) -> None:
        if resume and output is None:
            raise InputError(
                f"{argument('resume')}: name the result that was being written, by "
                f"{argument('save_to')}"
            )
        self.output = None if output is None else output.resolve()
        self.resume = resume
        self._checkpoint: Checkpoint | None = None
        self._open = ExitStack()
        if self.output is not None:
            self._open.callback(OutputLock(self.output, lends=True).release)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._open.close()

    @property
    def is_recalling(self) -> bool:
        """Whether all results so far were made by an earlier computation."""
        return self._checkpoint is not None and self._checkpoint.is_recalling

    def memory(
        self, *facts: Any, kinds: tuple[type, ...] = (), asked_again: bool = False
    ) -> Memory:
        """Return the memory of the steps of a computation.

        Parameters
        ----------
        facts
            What the computation is and depends on, for :func:`digest`; what was kept of another
            one, or by another version of the program, is refused.
        kinds
            Data classes and enumerations among the results of steps.
        asked_again
            Whether steps are asked for again, so that they are remembered without an output too.

        Raises
        ------
        InputError
            If what is there belongs to another computation, or cannot be read.
        """
        if self.output is None:
            return Memory(Shelf() if asked_again else None, kinds)
        self._checkpoint = Checkpoint(self.output, identity_of(*facts), resume=self.resume)
        self._open.callback(self._checkpoint.close)
        return Memory(self._checkpoint, kinds, self._checkpoint.n_known)

    def finish(self) -> None:
        """Remove what was kept, as the result is written."""
        if self._checkpoint is not None:
            self._checkpoint.remove()


def identity_of(*facts: Any) -> str:
    """Return a text that is equal for equal facts and the same version of the program."""
    return hashlib.sha256(VERSION.encode() + digest(facts)).hexdigest()
