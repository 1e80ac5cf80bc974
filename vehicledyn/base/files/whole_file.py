"""Files that are written whole or not at all, whatever happens meanwhile."""

from __future__ import annotations

import itertools
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from vehicledyn.base.interrupts import undisturbed

_numbers = itertools.count()


@contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """Give a place to write a file at, which takes its name when all is written.

    A file that has the name stays until then, and for good after an error. What is no regular
    file, such as a pipe, is written to directly.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    if _is_special(target):
        yield target
        return
    place = target.resolve()
    name = f".{os.getpid()}-{next(_numbers)}.new{place.suffix}"
    scratch = place.with_name(name)
    try:
        yield scratch
        with undisturbed():
            scratch.replace(place)
    finally:
        scratch.unlink(missing_ok=True)


@contextmanager
def folder_for_files(folder: Path) -> Iterator[None]:
    """Make a folder, with its parents, for files; those made that an error leaves empty go again.

    Raises
    ------
    OSError
        If the folder cannot be made.
    """
    made = [place for place in (folder, *folder.parents) if not place.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        yield
    except BaseException:
        with suppress(OSError):  # one that holds something
            for place in made:
                place.rmdir()
        raise


def copy_whole(source: Path, target: Path) -> None:
    """Copy a file, whole or not at all.

    Raises
    ------
    OSError
        If the file cannot be read or written.
    """
    with whole_file(target) as place:
        place.write_bytes(source.read_bytes())


def write_whole(target: Path, text: str, errors: str = "strict") -> None:
    """Write a text file in UTF-8, whole or not at all.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    with whole_file(target) as place:
        place.write_text(text, encoding="utf-8", errors=errors)


def _is_special(target: Path) -> bool:
    try:
        return not stat.S_ISREG(target.stat().st_mode)
    except OSError:
        return False
