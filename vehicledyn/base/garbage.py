"""Work that makes many objects and no circles of them, without searches for circles."""

from __future__ import annotations

import contextlib
import gc
from collections.abc import Iterator


@contextlib.contextmanager
def without_collection() -> Iterator[None]:
    """Put the search for circles of objects off until the block is done.

    Printing a kernel makes hundreds of thousands of small objects that live until its end; to
    look through them again and again costs a tenth to a fifth of the time.
    """
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
