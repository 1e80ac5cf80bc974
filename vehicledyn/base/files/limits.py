"""Opening files that a user names: regular files of a sensible size, and nothing else.

A FIFO would be waited for without end, a device such as /dev/zero has none, and opening some
devices does things. They are refused by what they are, before they are opened.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import BinaryIO

from vehicledyn.base.errors import InputError

_KINDS = (
    (stat.S_ISDIR, "this is a folder, not a file"),
    (stat.S_ISFIFO, "this is a FIFO (named pipe), not a file; write its content to a file"),
    (stat.S_ISSOCK, "this is a socket, not a file"),
    (stat.S_ISCHR, "this is a device, not a file"),
    (stat.S_ISBLK, "this is a device, not a file"),
)


class UnreadableFileError(InputError):
    """A file that cannot be read; ``words`` say why without its name."""

    def __init__(self, path: Path, words: str) -> None:
        super().__init__(f"{path}: {words}")
        self.words = words


class TooLargeError(UnreadableFileError):
    """A regular file of more bytes than are read of its kind."""


def check_regular(path: Path, most: int | None = None) -> None:
    """Refuse what is no regular file, or is larger than some bytes.

    Raises
    ------
    UnreadableFileError
        If it is missing, something else, too large, or cannot be looked at.
    """
    try:
        facts = path.stat()
    except FileNotFoundError:
        raise UnreadableFileError(path, "there is no such file") from None
    except (OSError, ValueError) as error:
        raise _failed(path, error) from None
    _check(path, facts, most)


def open_regular(path: Path, most: int | None = None) -> BinaryIO:
    """Return a regular file, open for reading bytes.

    Parameters
    ----------
    path
        The file; links are followed.
    most
        Largest size that is accepted [bytes]; None for any.

    Raises
    ------
    UnreadableFileError
        If it is missing, no regular file, too large or cannot be opened.
    """
    check_regular(path, most)
    flags = os.O_RDONLY | getattr(os, "O_BINARY", 0) | getattr(os, "O_NONBLOCK", 0)
    try:
        number = os.open(path, flags)
    except OSError as error:
        raise _failed(path, error) from None
    try:
        _check(path, os.fstat(number), most)  # it may have been exchanged meanwhile
    except UnreadableFileError:
        os.close(number)
        raise
    return os.fdopen(number, "rb")


def read_regular(path: Path, most: int) -> bytes:
    """Return the content of a regular file of at most some bytes.

    Raises
    ------
    UnreadableFileError
        As :func:`open_regular`, or if reading fails.
    """
    with open_regular(path, most) as file:
        try:
            content = file.read(most + 1) or b""
        except OSError as error:
            raise _failed(path, error) from None
    if len(content) > most:
        raise _too_large(path, len(content), most)
    return content


def _check(path: Path, facts: os.stat_result, most: int | None) -> None:
    for is_kind, words in _KINDS:
        if is_kind(facts.st_mode):
            raise UnreadableFileError(path, words)
    if most is not None and facts.st_size > most:
        raise _too_large(path, facts.st_size, most)


def _too_large(path: Path, size: int, most: int) -> TooLargeError:
    found = f"{size / 1e6:.3g} MB" if size < 1e9 else f"{size / 1e9:.3g} GB"
    words = f"larger than {most / 1e6:g} MB, the most that is read of such a file ({found})"
    return TooLargeError(path, words)


def _failed(path: Path, error: OSError | ValueError) -> UnreadableFileError:
    reason = error.strerror if isinstance(error, OSError) else None
    return UnreadableFileError(path, f"cannot be read: {reason or error}")
