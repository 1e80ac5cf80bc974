"""Start of a scenario when it was last prepared, so that running it again derives nothing.

An entry holds the facts of the equations, the key of the compiled kernel and the point that the
run starts from. Its name is a digest of everything these follow from: the resolved scenario
with all parameters, the files it names, the program's own files, the version of CasADi and the
compiler. A missing, old or damaged entry is as good as none. The channels that a scenario will have
are kept likewise, for what validates it.
"""

from __future__ import annotations

import hashlib
import json
import logging
import os
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from vehicledyn.analyses.preparation.named_files import named_files
from vehicledyn.base.errors import InputError
from vehicledyn.base.files.limits import read_regular
from vehicledyn.base.files.ownership import writable_by_others
from vehicledyn.base.version import FOLDER, PACKAGE
from vehicledyn.codegen.toolchain.cache import cache_folder, distrust
from vehicledyn.codegen.toolchain.compiler import CompilationError, find_compiler
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.symbolic.equations import Channel

MOST_ENTRIES = 1000
"""Entries that are kept, the youngest."""

_LARGEST_ENTRY = 50_000_000
_WITHOUT_EFFECT = ("title", "duration", "solver", "output")
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Memory:
    """Facts of the equations, key of the kernel, look, and start: states, unknowns, parameters."""

    facts: dict[str, Any]
    kernel: str
    state: list[float]
    unknowns: list[float]
    residual: float
    remark: str
    parameters: list[float]
    look: dict[str, Any]


def key_of_run(loaded: LoadedScenario) -> str | None:
    """Return the name of a scenario's entry; None where it cannot be known to be the same.

    That is so without a compiler, and for models and parts that are not the program's own.
    """
    if not _is_ours(loaded):
        return None
    try:
        compiler = find_compiler()
    except CompilationError:
        return None
    resolved = {k: v for k, v in loaded.resolved.items() if k not in _WITHOUT_EFFECT}
    facts = [_program(), version("casadi"), compiler.identity, resolved, named_files(loaded)]
    try:
        text = json.dumps(facts, sort_keys=True)
    except TypeError:
        return None
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def recall(key: str) -> Memory | None:
    """Return an entry, if there is a whole one that nobody else can have written."""
    try:
        content = _read(_path(key))
        return None if content is None else Memory(**content)
    except TypeError:
        return None


def remember(key: str, memory: Memory) -> None:
    """Write an entry whole or not at all; a folder that cannot be written is no error."""
    _write(_path(key), dict(vars(memory)))


def recall_channels(key: str) -> list[Channel] | None:
    """Return the channels that a scenario was found to have, or None."""
    content = _read(_path(key, "channels"))
    try:
        return None if content is None else [Channel(**item) for item in content["channels"]]
    except (KeyError, TypeError):
        return None


def remember_channels(key: str, channels: Sequence[Channel]) -> None:
    """Keep the channels that a scenario will have, as :func:`remember` does."""
    _write(_path(key, "channels"), {"channels": [asdict(channel) for channel in channels]})


def _read(path: Path) -> dict[str, Any] | None:
    """Return what a file holds, if it is whole and nobody else can have written it."""
    if distrust() or writable_by_others(path):
        return None
    try:
        content = json.loads(read_regular(path, _LARGEST_ENTRY))
        return content if _checksum(content) == content.pop("checksum") else None
    except (InputError, OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def _write(target: Path, content: dict[str, Any]) -> None:
    if distrust():
        return
    try:
        text = json.dumps(content | {"checksum": _checksum(content)})
        target.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        with tempfile.NamedTemporaryFile(
            "w", dir=target.parent, suffix=".part", delete=False, encoding="utf-8"
        ) as file:
            file.write(text)
        Path(file.name).replace(target)
        _forget_old(target.parent)
    except (OSError, TypeError) as error:
        _log.debug("what was prepared is not remembered: %s", error)


def _path(key: str, kind: str = "runs") -> Path:
    return cache_folder() / kind / f"{key}.json"


def _checksum(content: dict[str, Any]) -> str:
    plain = {k: v for k, v in content.items() if k != "checksum"}
    return hashlib.sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()


def _forget_old(folder: Path) -> None:
    entries = sorted(folder.glob("*.json"), key=lambda path: path.stat().st_mtime)
    for path in entries[:-MOST_ENTRIES]:
        path.unlink(missing_ok=True)


def _is_ours(loaded: LoadedScenario) -> bool:
    """Return whether the model and all parts of a scenario, theirs too, are this package's."""
    if loaded.built is not None:
        return False
    written = loaded.written
    kinds = [*_kinds(loaded.scenario), *written.classes, *_kinds(written.file)]
    return all(kind.__module__.split(".")[0] == PACKAGE for kind in kinds)


def _kinds(part: Any) -> Iterator[type]:
    """Yield the class of a part and of all parts in it."""
    if isinstance(part, list | tuple):
        for item in part:
            yield from _kinds(item)
    elif isinstance(part, dict):
        yield from _kinds(list(part.values()))
    elif hasattr(type(part), "model_fields"):
        yield type(part)
        for name in type(part).model_fields:
            yield from _kinds(getattr(part, name))


@cache
def _program() -> str:
    """Return a text that changes with any file of the package."""
    root = FOLDER
    facts = sorted(_files(str(root)))
    return hashlib.sha256(json.dumps(facts).encode()).hexdigest()


def _files(folder: str) -> Iterator[tuple[str, int, int]]:
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.is_dir():
                if entry.name != "__pycache__":
                    yield from _files(entry.path)
            else:
                facts = entry.stat()
                yield entry.path, facts.st_size, facts.st_mtime_ns
