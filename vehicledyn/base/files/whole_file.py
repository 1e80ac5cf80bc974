"""Files that are written whole or not at all, whatever happens meanwhile."""

from __future__ import annotations

import hashlib
import itertools
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from vehicledyn.base.interrupts import undisturbed

try:
    import fcntl
except ImportError:  # systems without POSIX locks keep what killed processes leave
    fcntl = None  # type: ignore[assignment]

_numbers = itertools.count()


@contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """Give a place to write a file at, which takes its name when all is written.

    A file that has the name stays until then, and for good after an error. What is no regular
    file, such as a pipe, is written to directly. What killed processes have left of the file is
    removed.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    if _is_special(target):
        yield target
        return
    place = target.resolve()
    _remove_abandoned(place)
    scratch, lock = _locked_scratch(place)
    try:
        yield scratch
        with undisturbed():
            scratch.replace(place)
    finally:
        scratch.unlink(missing_ok=True)
        if lock is not None:
            os.close(lock)


def _locked_scratch(place: Path) -> tuple[Path, int | None]:
    """Return a new file beside a place, and what keeps it locked as long as the process lives."""
    begin, end = _scratch_names(place)
    while True:
        scratch = place.with_name(f"{begin}{os.getpid()}-{next(_numbers)}{end}")
        if fcntl is None:
            return scratch, None
        lock = os.open(scratch, os.O_CREAT | os.O_EXCL | os.O_RDWR, 0o666)
        with suppress(OSError):  # disks without locks
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if os.fstat(lock).st_nlink:
            return scratch, lock
        os.close(lock)  # another process took it for abandoned before it was locked


def _remove_abandoned(place: Path) -> None:
    """Remove what processes that live no more have left of a file."""
    if fcntl is None:
        return
    begin, end = _scratch_names(place)
    names: list[str] = []
    with suppress(OSError):  # a folder that may be written only, or is not there
        names = [n for n in os.listdir(place.parent) if n.startswith(begin) and n.endswith(end)]  # noqa: PTH208
    for name in names:
        with suppress(OSError):  # a living process holds it
            file = os.open(place.with_name(name), os.O_RDWR | os.O_NONBLOCK)
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                place.with_name(name).unlink()
            finally:
                os.close(file)


def _scratch_names(place: Path) -> tuple[str, str]:
    """Return begin and end of the names of files that are to become a file."""
    mark = hashlib.sha256(os.fsencode(place.name)).hexdigest()[:16]
    return f".{mark}.", f".new{place.suffix}"


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
