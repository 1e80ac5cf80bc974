"""Errors a user can act on: what is wrong, where and what next."""

from __future__ import annotations

import bisect
import difflib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

_MOST_LISTED = 60
_MOST_TRIED = 1_000
_NEIGHBOURS = 200
"""Of more names than are tried, these on each side of a name's alphabetical place are."""

_LONGEST = 200
"""Letters of a name that are compared and shown."""


class VehicledynError(Exception):
    """Base of every error this package raises on purpose.

    Its text is shown to the user as it is, so it says what is wrong, where and what next.
    ``about`` names the parts and coordinates in question, so that their place in a file can be
    shown; ``argument`` the argument of a function of the front door, where that is known.
    """

    def __init__(self, text: str = "", *, about: Iterable[str] = (), argument: str = "") -> None:
        super().__init__(text)
        self.about, self.argument = tuple(about), argument


class InputError(VehicledynError):
    """A file, option or value the user gave cannot be used."""


class UnknownNameError(InputError, KeyError):
    """A name that a collection does not know; a KeyError too, as collections raise it."""

    __str__ = Exception.__str__


class NumericalError(VehicledynError):
    """A computation failed: a loop, an equilibrium or an integration did not converge."""


class MissingPartError(VehicledynError):
    """An optional part (compiler, extra package) that the request needs is absent."""


class StoppedError(VehicledynError):
    """The user stopped the program."""


class Interrupted(KeyboardInterrupt):
    """The user stopped an analysis; ``data`` is the result of what it had computed by then."""

    def __init__(self, data: Any) -> None:
        super().__init__("interrupted")
        self.data = data


class ResultWarning(UserWarning):
    """Something about a result that its reader should know."""


class AccuracyWarning(ResultWarning):
    """A result may be less accurate than asked for."""


class UnfinishedWarning(ResultWarning):
    """An analysis ended before its planned end; what it found until then is kept."""


@contextmanager
def errors_of(source: object) -> Iterator[None]:
    """Put the name of a file in front of errors about its content that do not name it yet."""
    try:
        yield
    except InputError as error:
        if str(error).startswith(f"{source}:"):
            raise
        raise InputError(f"{source}: {error}", about=error.about) from error


def nearest_name(name: str, known: Iterable[str]) -> str | None:
    """Return the known name that looks most like ``name``, or None if nothing is close.

    Of many names those around its alphabetical place are looked at.
    """
    likely = [other for other in known if abs(len(other) - len(name)) <= len(other)]
    if len(likely) > _MOST_TRIED:
        likely.sort()
        first = max(0, bisect.bisect(likely, name) - _NEIGHBOURS)
        likely = likely[first : first + 2 * _NEIGHBOURS]
    matches = difflib.get_close_matches(name[:_LONGEST], likely, n=1, cutoff=0.55)
    return matches[0] if matches else None


def unknown_name(what: str, name: str, known: Iterable[str]) -> str:
    """Return the message for a name that is not known, with the nearest one suggested.

    >>> unknown_name("tyre", "calspam", ["calspan", "linear"])
    "no tyre named 'calspam'; did you mean 'calspan'? Known: calspan, linear"
    """
    names = sorted(known)
    guess = nearest_name(name, names)
    hint = f"did you mean '{guess}'? " if guess else ""
    more = f" and {len(names) - _MOST_LISTED} more" if len(names) > _MOST_LISTED else ""
    listed = ", ".join(names[:_MOST_LISTED]) or "none"
    shown = name if len(name) <= _LONGEST else f"{name[:_LONGEST]}..."
    return f"no {what} named '{shown}'; {hint}Known: {listed}{more}"
