"""Problems of a file: each with its line and column, all of them told at once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from vehicledyn.base.errors import InputError

Place = tuple[str | int, ...]


class Mark(NamedTuple):
    """Line and column of a value in its file, both counted from 1."""

    line: int
    column: int


START = Mark(1, 1)
MOST_SHOWN = 20
"""Problems that an error lists one by one."""


class Problem(NamedTuple):
    """One thing that is wrong in a file, or in an option that changes what the file says.

    ``source`` is the file's name or the option (``--set key``), ``mark`` is None for an option
    and ``field`` is the dotted name of the value, empty where the message is enough.
    """

    source: str
    mark: Mark | None
    field: str
    message: str

    def __str__(self) -> str:
        """Return ``file:line:column: field: message``."""
        at = f"{self.source}:{self.mark.line}:{self.mark.column}" if self.mark else self.source
        return ": ".join(text for text in (at, self.field, self.message) if text)


def dotted(place: Iterable[str | int]) -> str:
    """Return the name of a place in a file, such as "driver.gains[2]".

    >>> dotted(("driver", "gains", 2))
    'driver.gains[2]'
    """
    text = ""
    for step in place:
        text += f"[{step}]" if isinstance(step, int) else f".{step}" if text else step
    return text


def refusal(problems: Sequence[Problem], file: str) -> InputError:
    """Return the error that lists the problems of a file, sorted by position, options last.

    Of many it lists the first and says how many more there are.
    """
    ordered = sorted(problems, key=lambda p: (p.mark is None, p.source != file, p.mark or START))
    count = "1 problem" if len(ordered) == 1 else f"{len(ordered)} problems"
    hidden = len(ordered) - MOST_SHOWN
    more = [f"... and {hidden} more"] if hidden > 0 else []
    return InputError("\n".join([*map(str, ordered[:MOST_SHOWN]), *more, f"{count} in {file}"]))
