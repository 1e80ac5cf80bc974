"""The user's cache of compiled kernels: found by content, checked before use, safe to share.

An entry is one file whose name holds the key (what it was built from) and the checksum of its
bytes, so a truncated or altered file is seen before it is loaded, and a single rename makes an
entry appear whole. Two processes that build the same entry at once both succeed. Loading a library
runs it: an entry that other users could have written is built again, a folder that they can
write to is not used.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import shutil
import stat
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from vehicledyn.base.files.ownership import writable_by_others
from vehicledyn.codegen.toolchain.compiler import CompilationError

T = TypeVar("T")

_BUILDING = "build-"
_LONGEST_BUILD = 86_400.0  # s
_NOT_OPENED = (OSError, AttributeError, ValueError, RuntimeError)


@dataclass(frozen=True)
class CachedLibrary:
    """A library ready to load: its path, whether it was found, and a remark for the user.

    ``temporary`` is the folder to remove once the library is loaded, where it is not kept.
    """

    path: Path
    found: bool
    remark: str = ""
    temporary: tempfile.TemporaryDirectory[str] | None = None


def cache_folder() -> Path:
    """Return the folder of the cache: VEHICLEDYN_CACHE, or the system's place for caches."""
    named = os.environ.get("VEHICLEDYN_CACHE")
    if named:
        return Path(named).absolute()
    import platformdirs

    return Path(platformdirs.user_cache_dir("vehicledyn", appauthor=False)) / "kernels"


def distrust() -> str:
    """Return why the folder of the cache is not used, or an empty text.

    That is so where others than this user and root can write to the folder or replace it.
    """
    reason = writable_by_others(cache_folder())
    return f"the cache folder is not used, since {reason}" if reason else ""


def key_of(*parts: str) -> str:
    """Return the key of an entry built from these texts."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(f"{len(part)}:".encode())
        digest.update(part.encode())
    return digest.hexdigest()[:32]


def obtain(key: str, build: Callable[[Path], Path]) -> CachedLibrary:
    """Return the entry of a key, building it where it is missing or damaged.

    Parameters
    ----------
    key
        From :func:`key_of`.
    build
        Builds the library in the empty folder it is given and returns its path.

    Raises
    ------
    CompilationError
        If the library cannot be built, in the cache folder or a temporary one.
    """
    folder, reason = cache_folder(), distrust()
    if reason:
        return _build_apart(build, reason)
    found, remark = _find(folder, key)
    if found is not None:
        return CachedLibrary(found, found=True)
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        _remove_leftovers(folder)
        with tempfile.TemporaryDirectory(dir=folder, prefix=_BUILDING) as place:
            return CachedLibrary(_enter(folder, key, build(Path(place))), False, remark)
    except (OSError, CompilationError) as error:
        return _build_apart(build, f"the cache folder {folder} cannot be used ({error})")


def load(
    key: str, build: Callable[[Path], Path], open_library: Callable[[Path], T]
) -> tuple[T, CachedLibrary]:
    """Return what is in the library of a key, and its entry.

    One that is whole but cannot be opened is built once more.

    Parameters
    ----------
    key, build
        See :func:`obtain`.
    open_library
        Opens a library; what it raises of OSError, AttributeError, ValueError and RuntimeError
        says that the file is none.

    Raises
    ------
    CompilationError
        If the library cannot be built or opened.
    """
    entry = obtain(key, build)
    if entry.found:
        try:
            return open_library(entry.path), entry
        except _NOT_OPENED:
            discard(entry)
            entry = obtain(key, build)
    try:
        return open_library(entry.path), entry
    except _NOT_OPENED as error:
        discard(entry)
        raise CompilationError(f"the compiled library cannot be loaded ({error})") from None
    finally:
        if entry.temporary is not None:
            entry.temporary.cleanup()


def known(key: str) -> Path | None:
    """Return the sound library of a key, if there is one."""
    return None if distrust() else _find(cache_folder(), key)[0]


def discard(entry: CachedLibrary) -> None:
    """Remove an entry that passed the check but cannot be loaded."""
    entry.path.unlink(missing_ok=True)


def _find(folder: Path, key: str) -> tuple[Path | None, str]:
    """Return the sound file of a key, or a remark on what was found; remove the others."""
    remark = ""
    try:
        candidates = sorted(folder.glob(f"{key}-*"))
    except OSError:
        return None, remark
    for path in candidates:
        try:
            reason = _refusal(path)
            if not reason and path.stem.partition("-")[2] == _checksum(path):
                return path, ""
            remark = f"{reason}; the kernel is compiled again" if reason else remark
            path.unlink(missing_ok=True)
        except OSError:
            continue
    return None, remark


def _refusal(path: Path) -> str:
    """Return why a file of the cache, whose folder is safe, must not be loaded."""
    if not stat.S_ISREG(path.lstat().st_mode):
        return f"{path} is no regular file"
    return writable_by_others(path)


def _enter(folder: Path, key: str, built: Path) -> Path:
    built.chmod(0o700)
    with built.open("rb+") as file:
        os.fsync(file.fileno())
    target = folder / f"{key}-{_checksum(built)}{built.suffix}"
    built.replace(target)
    return target


def _remove_leftovers(folder: Path) -> None:
    """Remove what processes that were killed while they built left behind."""
    for place in folder.glob(f"{_BUILDING}*"):
        with contextlib.suppress(OSError):
            if time.time() - place.lstat().st_mtime > _LONGEST_BUILD:
                shutil.rmtree(place, ignore_errors=True)


def _build_apart(build: Callable[[Path], Path], reason: str) -> CachedLibrary:
    workplace = tempfile.TemporaryDirectory(prefix="vehicledyn-", ignore_cleanup_errors=True)
    remark = f"{reason}; the kernel is compiled for this run only"
    unsafe = writable_by_others(Path(workplace.name))
    if unsafe:
        workplace.cleanup()
        raise CompilationError(f"{reason}, and in the folder for temporary files {unsafe}")
    try:
        return CachedLibrary(build(Path(workplace.name)), False, remark, workplace)
    except CompilationError:
        workplace.cleanup()
        raise
    except OSError as error:
        workplace.cleanup()
        raise CompilationError(f"{reason}, nor can {workplace.name} ({error})") from None


def _checksum(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
