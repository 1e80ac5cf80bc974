"""The user's cache of compiled kernels: found by content, checked before use, safe to share.

An entry is one file whose name holds the key (what it was built from) and the checksum of its
bytes, so a truncated or altered file is seen before it is loaded, and a single rename makes an
entry appear whole. Two processes that build the same entry at once both succeed.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from vehicledyn.solve.compiler import CompilationError

T = TypeVar("T")

_NOT_OPENED = (OSError, AttributeError, ValueError, RuntimeError)


@dataclass(frozen=True)
class Entry:
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
        return Path(named)
    import platformdirs

    return Path(platformdirs.user_cache_dir("vehicledyn", appauthor=False)) / "kernels"


def key_of(*parts: str) -> str:
    """Return the key of an entry built from these texts."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(f"{len(part)}:".encode())
        digest.update(part.encode())
    return digest.hexdigest()[:32]


def obtain(key: str, build: Callable[[Path], Path]) -> Entry:
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
    folder = cache_folder()
    known = _find(folder, key)
    if known is not None:
        return Entry(known, found=True)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder, prefix="build-") as place:
            return Entry(_enter(folder, key, build(Path(place))), found=False)
    except (OSError, CompilationError) as error:
        return _build_apart(build, f"the cache folder {folder} cannot be used ({error})")


def load(
    key: str, build: Callable[[Path], Path], open_library: Callable[[Path], T]
) -> tuple[T, Entry]:
    """Return what is in the library of a key, and its entry.

    One that is whole but cannot be opened is built once more.

    Parameters
    ----------
    key, build
        See :func:`obtain`.
    open_library
        Opens a library; what it raises of OSError, AttributeError, ValueError and RuntimeError
        tells that the file is none.

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
    return _find(cache_folder(), key)


def discard(entry: Entry) -> None:
    """Remove an entry that passed the check but cannot be loaded."""
    entry.path.unlink(missing_ok=True)


def _find(folder: Path, key: str) -> Path | None:
    """Return the sound file of a key; remove the damaged ones."""
    try:
        candidates = sorted(folder.glob(f"{key}-*"))
    except OSError:
        return None
    for path in candidates:
        try:
            if path.stem.partition("-")[2] == _checksum(path):
                return path
            path.unlink(missing_ok=True)
        except OSError:
            continue
    return None


def _enter(folder: Path, key: str, built: Path) -> Path:
    with built.open("rb+") as file:
        os.fsync(file.fileno())
    target = folder / f"{key}-{_checksum(built)}{built.suffix}"
    built.replace(target)
    return target


def _build_apart(build: Callable[[Path], Path], reason: str) -> Entry:
    workplace = tempfile.TemporaryDirectory(prefix="vehicledyn-", ignore_cleanup_errors=True)
    remark = f"{reason}; the kernel is compiled for this run only"
    try:
        return Entry(build(Path(workplace.name)), False, remark, workplace)
    except CompilationError:
        workplace.cleanup()
        raise
    except OSError as error:
        workplace.cleanup()
        raise CompilationError(f"{reason}, nor can {workplace.name} ({error})") from None


def _checksum(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
