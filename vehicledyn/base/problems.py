"""Problems of a file: each with its line and column, all of them reported at once."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from vehicledyn.base.errors import InputError

Place = tuple[str | int, ...]


class Mark(NamedTuple):
    """Line and column of a value in its file, both counted from 1."""

    line: int
    column: int


START = Mark(1, 1)
_COUNT = re.compile(r"\d+ problems?( or more)? in .*")
MOST_SHOWN = 20
"""Problems that an error lists one by one."""

MOST_FOUND = 200
"""Problems after which the checks of a file may stop looking for more."""

LONGEST = 4000
"""Letters of a message; of longer ones, which quote a long value, begin and end are shown."""


class Problem(NamedTuple):
    """One thing that is wrong in a file, or in an option that changes what the file says.

    ``source`` is the file's name or the option that changed it, ``mark`` is None for an option
    and ``field`` is the dotted name of the value, empty where the message is enough.
    """

    source: str
    mark: Mark | None
    field: str
    message: str

    def __str__(self) -> str:
        """Return ``file:line:column: field: message``."""
        at = f"{self.source}:{self.mark.line}:{self.mark.column}" if self.mark else self.source
        message = self.message
        if len(message) > LONGEST:
            message = f"{message[: LONGEST // 2]} … {message[-LONGEST // 2 :]}"
        return ": ".join(text for text in (at, self.field, message) if text)


def dotted(place: Iterable[str | int]) -> str:
    """Return the name of a place in a file, such as "driver.gains[2]".

    >>> dotted(("driver", "gains", 2))
    'driver.gains[2]'
    """
    text = ""
    for step in place:
        text += f"[{step}]" if isinstance(step, int) else f".{step}" if text else step
    return text


def counted(count: int, file: str) -> str:
    """Return the line that ends the list of a file's problems."""
    if count >= MOST_FOUND:
        return f"{count} problems or more in {file}"
    return f"1 problem in {file}" if count == 1 else f"{count} problems in {file}"


def is_count(line: str) -> bool:
    """Return whether a line ends the list of a file's problems."""
    return _COUNT.fullmatch(line) is not None


def refusal(problems: Sequence[Problem], file: str) -> InputError:
    """Return the error that lists the problems of a file, sorted by position, options last.

    Of many it lists the first and says how many more there are.
    """
    ordered = sorted(problems, key=lambda p: (p.mark is None, p.source != file, p.mark or START))
    hidden = len(ordered) - MOST_SHOWN
    more = [f"... and {hidden} more"] if hidden > 0 else []
    return InputError(
        "\n".join([*map(str, ordered[:MOST_SHOWN]), *more, counted(len(ordered), file)])
    )
