"""Messages between a sweep and its worker processes: pickled objects in anonymous pipes.

Unpickling runs what a message says. Only the two processes at the ends of a pipe can write to it:
it has neither an address nor a name that another user or machine could open.
"""

from __future__ import annotations

import pickle
import struct
from typing import Any, BinaryIO

_LENGTH = struct.Struct("<Q")


def send(stream: BinaryIO, message: Any) -> None:
    """Write one message.

    Raises
    ------
    OSError
        If nobody reads the other end any more.
    """
    content = pickle.dumps(message, pickle.HIGHEST_PROTOCOL)
    stream.write(_LENGTH.pack(len(content)))
    stream.write(content)
    stream.flush()


def receive(stream: BinaryIO) -> Any:
    """Return the next message.

    Raises
    ------
    EOFError
        If the other end is closed, also in the middle of a message.
    """
    (length,) = _LENGTH.unpack(_exactly(stream, _LENGTH.size))
    return pickle.loads(_exactly(stream, length))


def _exactly(stream: BinaryIO, size: int) -> bytes:
    content = stream.read(size)
    if len(content) < size:
        raise EOFError
    return content
