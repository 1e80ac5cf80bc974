"""How messages name what a caller gave: arguments in Python, options on a command line.

Below the command line nobody knows its options. Messages name arguments by :func:`argument`,
:func:`given` and :func:`setting`, and whoever offers them under other names says so for a while.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, Protocol


class Naming(Protocol):
    """Words for arguments."""

    def argument(self, name: str) -> str:
        """Return the name under which the caller gives an argument."""

    def given(self, name: str, value: Any) -> str:
        """Return an argument with the value it was given."""

    def setting(self, key: str) -> str:
        """Return how the caller gives a value of a scenario by its dotted key."""


class PythonNaming:
    """Arguments as they are written in Python."""

    def argument(self, name: str) -> str:
        """Return the name of the argument."""
        return name

    def given(self, name: str, value: Any) -> str:
        """Return the argument as in a call."""
        return f"{name}={value!r}"

    def setting(self, key: str) -> str:
        """Return the key of the setting."""
        return key


_IN_PYTHON: Naming = PythonNaming()
_naming: ContextVar[Naming] = ContextVar("naming", default=_IN_PYTHON)


@contextmanager
def arguments_named(naming: Naming) -> Iterator[None]:
    """Name arguments in another way inside the block."""
    token = _naming.set(naming)
    try:
        yield
    finally:
        _naming.reset(token)


def argument(name: str) -> str:
    """Return the name of an argument, for a message.

    >>> argument("speed")
    'speed'
    """
    return _naming.get().argument(name)


def given(name: str, value: Any) -> str:
    """Return an argument with its value, for a message.

    >>> given("first", 0.5)
    'first=0.5'
    """
    return _naming.get().given(name, value)


def setting(key: str) -> str:
    """Return the name of a changed value of a scenario, for a message.

    >>> setting("solver.step")
    'solver.step'
    """
    return _naming.get().setting(key)
