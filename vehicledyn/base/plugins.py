"""Laws and parts of the user's own: Python files and installed packages that register them.

They are loaded because the user or the installation says so, never because a scenario does.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib.util
import os
import sys
import threading
import traceback
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

from vehicledyn.base.errors import InputError, VehicledynError, unknown_name
from vehicledyn.base.files.limits import read_regular
from vehicledyn.base.registry import all_or_nothing, families, own_families

GROUP = "vehicledyn.plugins"
"""Entry points of this group name modules to load, whenever catalogues are."""

MODULE_PREFIX = "vehicledyn_plugin_"
"""Begins the names under which files are imported, the same in every process."""

_LARGEST = 10_000_000
_loaded: dict[Path, list[tuple[str, str]]] = {}
_loading = threading.RLock()
"""Held while a file is run, so that threads that ask for it run it once."""


def load_plugin(
    path: str | Path, complete: Callable[[], object] | None = None
) -> list[tuple[str, str]]:
    """Run a Python file that registers laws or parts; return family and name of each.

    A file that was loaded before is not run again. A file that fails registers nothing.
    ``complete`` enters all of this package's catalogues; without it no catalogue is unknown.

    Raises
    ------
    InputError
        If there is no such file, it fails, or it registers a name that is taken; the message
        names file and line.
    """
    with _loading:
        return _loaded_once(path, Path(path).resolve(), complete)


def _loaded_once(
    path: str | Path, place: Path, complete: Callable[[], object] | None
) -> list[tuple[str, str]]:
    if place in _loaded:
        return _loaded[place]
    if Path(path).suffix == ".py":
        read_regular(Path(path), _LARGEST)
    if {Path(path).suffix, place.suffix} != {".py"}:
        raise InputError(f"{path}: a plugin is a Python file, my_tyre.py for example")
    name = f"{MODULE_PREFIX}{place.stem}_{zlib.crc32(str(place).encode()):08x}"
    specification = importlib.util.spec_from_file_location(name, place)
    if specification is None or specification.loader is None:
        raise InputError(f"{path}: cannot be loaded as a Python file")
    module = importlib.util.module_from_spec(specification)
    with _failures_told(str(path), place), all_or_nothing() as found, _importable(name, module):
        specification.loader.exec_module(module)
        _refuse_families(complete)
    _loaded[place] = found
    return found


def load_installed(complete: Callable[[], object]) -> None:
    """Load the plugins of all installed packages; ``complete`` is as for :func:`load_plugin`.

    Raises
    ------
    InputError
        If one fails; the message names it and the package.
    """
    if not any(map(_names_plugins, sys.path)):
        return
    from importlib.metadata import entry_points

    for entry in entry_points(group=GROUP):
        package = entry.dist.name if entry.dist is not None else "an unknown package"
        with _failures_told(f"plugin '{entry.name}' of {package}", None), all_or_nothing():
            _load(entry)
            _refuse_families(complete)


def loaded_plugins() -> tuple[str, ...]:
    """Return the files that were loaded as plugins, for other processes to load as well."""
    return tuple(map(str, _loaded))


def plugin_line(error: BaseException) -> str:
    """Return the innermost line of a loaded plugin that an error went through, empty if none."""
    names = set(loaded_plugins())
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if frame.filename in names]
    return f"{own[-1].filename}:{own[-1].lineno}" if own else ""


def plugin_digest(path: str) -> str:
    """Return a text that changes with a plugin's file."""
    return hashlib.sha256(read_regular(Path(path), _LARGEST)).hexdigest()


def _names_plugins(folder: str) -> bool:
    """Return whether a package in a folder of modules names plugins, without loading much."""
    wanted = f"[{GROUP}]".encode()
    with contextlib.suppress(OSError), os.scandir(folder or ".") as entries:
        for entry in entries:
            if entry.name.endswith("-info"):
                with contextlib.suppress(OSError):
                    if wanted in Path(entry.path, "entry_points.txt").read_bytes():
                        return True
    return False


def _load(entry: Any) -> None:
    found = entry.load()
    if callable(found) and not isinstance(found, type):
        found()


def _refuse_families(complete: Callable[[], object] | None) -> None:
    """Refuse what was registered in a catalogue that this package does not have."""
    if complete is None or not own_families():
        return
    complete()  # a plugin may be the first to enter something in a catalogue
    for family in own_families():
        known = [name for name in families() if name not in own_families()]
        raise InputError(unknown_name("catalogue", family, known))


@contextmanager
def _importable(name: str, module: ModuleType) -> Iterator[None]:
    """Enter a module, and let it import what lies beside it while it is run."""
    folder = str(Path(str(module.__file__)).parent)
    sys.modules[name] = module
    sys.path.append(folder)
    try:
        yield
    except BaseException:
        del sys.modules[name]
        raise
    finally:
        sys.path.remove(folder)


@contextmanager
def _failures_told(what: str, place: Path | None) -> Iterator[None]:
    """Turn whatever a plugin raises into one message with the line where it happened."""
    try:
        yield
    except KeyboardInterrupt:
        raise
    except VehicledynError as error:
        raise InputError(f"{_where(what, place, error)}: {error}") from error
    except (Exception, SystemExit) as error:
        reason = " ".join(str(error).split()) or "no reason given"
        kind = "" if isinstance(error, ValueError) else f"{type(error).__name__}: "
        raise InputError(
            f"{_where(what, place, error)}: the plugin cannot be loaded: {kind}{reason}"
        ) from error


def _where(what: str, place: Path | None, error: BaseException) -> str:
    """Return the last line of the plugin that an error went through."""
    frames = traceback.extract_tb(error.__traceback__)
    if isinstance(error, SyntaxError) and error.filename and error.lineno:
        name = what if Path(error.filename) == place else error.filename
        return f"{name}:{error.lineno}"
    if place is None:
        own = [frame for frame in frames if not _is_machinery(frame.filename)]
        return f"{what}: {own[-1].filename}:{own[-1].lineno}" if own else what
    own = [frame for frame in frames if Path(frame.filename) == place]
    return f"{what}:{own[-1].lineno}" if own else what


def _is_machinery(filename: str) -> bool:
    return filename.startswith("<") or "importlib" in filename or Path(filename) == Path(__file__)
