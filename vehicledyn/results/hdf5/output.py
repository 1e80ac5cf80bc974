"""Where a result may be written: checks before a run, a lock while it lasts, clear errors."""

from __future__ import annotations

import errno
import os
import re
import shutil
import threading
from pathlib import Path
from typing import IO

from vehicledyn.base.errors import InputError

try:
    import fcntl
except ImportError:  # systems without POSIX locks: two runs on one output are not noticed
    fcntl = None  # type: ignore[assignment]

_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def check_output(path: str | Path) -> Path:
    """Return the resolved path of an output after testing that it can be written.

    Call it before anything is computed. An existing result at that name is left alone.

    Raises
    ------
    InputError
        If the folder is missing or not writable, if the name is a folder or another thing
        than a file, if it is a file that no run wrote, or if another run is writing there.
    """
    target = Path(path).resolve()
    folder = target.parent
    if target.is_dir():
        raise InputError(f"{path}: is a folder; give the name of a file in it")
    if target.exists() and not target.is_file():
        raise InputError(f"{path}: is not a regular file; choose another output")
    if not folder.is_dir():
        raise InputError(f"{path}: the folder {folder} does not exist; create it first")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(f"{path}: no permission to write in {folder}; choose another")
    if target.exists() and not os.access(target, os.W_OK):
        raise InputError(f"{path}: exists and is read-only; choose another output")
    if target.exists() and not _may_be_replaced(target):
        raise InputError(
            f"{path}: exists and is no HDF5 file, so it is kept; choose another output"
        )
    if is_being_written(target):
        raise _busy(target)
    return target


def check_folder(folder: str | Path) -> None:
    """Test that a folder for pictures exists or can be made.

    Raises
    ------
    InputError
        If a file has its name, or nobody may write there.
    """
    target = Path(folder).resolve()
    if target.exists() and not target.is_dir():
        raise InputError(f"{folder}: is a file; choose another folder")
    nearest = next(place for place in (target, *target.parents) if place.exists())
    if not nearest.is_dir() or not os.access(nearest, os.W_OK | os.X_OK):
        raise InputError(f"{folder}: no permission to write in {nearest}; choose another folder")


def write_failed(path: Path, error: Exception, where: str = "") -> InputError:
    """Return the message for an output that could not be written.

    Parameters
    ----------
    path
        The output.
    error
        What HDF5 or the system raised.
    where
        How far the run had come, such as " at t = 3.2 s".
    """
    match = re.search(r"error message = '([^']+)'", str(error))
    text = match[1] if match else str(getattr(error, "strerror", None) or error)
    full = getattr(error, "errno", None) in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
    advice = "free some space or choose" if full else "choose"
    return InputError(f"{path}: cannot be written{where}: {text}; {advice} another output")


def free_space(folder: Path) -> int:
    """Return the space that is free on the disk of a folder [bytes], 0 if it is not known."""
    try:
        return shutil.disk_usage(folder).free
    except OSError:
        return 0


class OutputLock:
    """Says to other processes that an output is being written; vanishes with the process.

    HDF5 gives its own lock up when it starts writing for concurrent readers, so a second
    run would destroy the file of the first. A hidden file beside the output holds ours.

    Parameters
    ----------
    target
        The output.
    lends
        Whether writers of the same thread may take it, one at a time, as long as it is held.

    Raises
    ------
    InputError
        If another run is writing the output, or its folder takes no file.
    """

    def __init__(self, target: Path, *, lends: bool = False) -> None:
        self._path, self._target, self._lends = _lock_path(target), target, lends
        self._file: IO[str] | None = None
        self.is_lent, self._holder = False, _here()
        self._lender = _lender(target)
        if self._lender is not None:
            if lends or self._lender.is_lent:
                raise _busy(target)
            self._lender.is_lent = True
        elif fcntl is not None:
            while self._file is None:
                self._file = self._acquire(target)
        if lends:
            _lending[target] = self

    def _acquire(self, target: Path) -> IO[str] | None:
        try:
            file = self._path.open("a")
        except OSError as error:
            raise write_failed(target, error) from error
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.close()
            raise _busy(target) from None
        except OSError:  # a disk without locks: two runs on one output are not noticed
            return file
        # The holder before us may have removed the file between our opening and locking it.
        if os.fstat(file.fileno()).st_nlink == 0:
            file.close()
            return None
        return file

    def release(self) -> None:
        """Let other runs write there; releasing twice does nothing."""
        if self._lender is not None:
            self._lender.is_lent, self._lender = False, None
        if _lending.get(self._target) is self:
            del _lending[self._target]
        if self._file is not None:
            self._path.unlink(missing_ok=True)
            self._file.close()
            self._file = None

    @property
    def is_ours(self) -> bool:
        """Whether this thread of this process, and no child of it, took the lock."""
        return self._holder == _here()


_lending: dict[Path, OutputLock] = {}


def _here() -> tuple[int, int]:
    return os.getpid(), threading.get_ident()


def _lender(target: Path) -> OutputLock | None:
    """Return the lock of an output that this thread holds and lends."""
    lock = _lending.get(target)
    return lock if lock is not None and lock.is_ours else None


def is_being_written(target: Path) -> bool:
    """Return whether a living process holds the lock of this output, and does not just lend it."""
    path, lender = _lock_path(target), _lender(target)
    if lender is not None:
        return lender.is_lent
    if fcntl is None or not path.exists():
        return False
    try:
        with path.open("r") as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    return False


def _may_be_replaced(target: Path) -> bool:
    """Return whether a file is empty or HDF5, so that a slip does not cost a scenario."""
    try:
        if target.stat().st_size == 0:  # to read from a file of the system may wait for ever
            return True
        with target.open("rb") as file:
            return file.read(len(_HDF5_SIGNATURE)) == _HDF5_SIGNATURE
    except OSError:
        return True


def _lock_path(target: Path) -> Path:
    return target.with_name(f".{target.name}.lock")


def _busy(target: Path) -> InputError:
    return InputError(f"{target}: another run is writing this file; wait for it or choose another")
