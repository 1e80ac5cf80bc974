"""Keys that tell whether a target is what it was: texts, files, the program and the compiler."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator
from functools import cache
from importlib.metadata import version
from typing import Any

from vehicledyn.analyses.preparation.memory.named_files import named_files
from vehicledyn.base.version import FOLDER, PACKAGE
from vehicledyn.codegen.toolchain.compiler import CompilationError, find_compiler
from vehicledyn.files.scenario.target import Target

_WITHOUT_EFFECT = ("title", "duration", "solver", "output")


def key_of(target: Target, *choices: object) -> str | None:
    """Return a key of a target; None where it cannot be known to be the same another time.

    That is so without a compiler, and for models and parts that are not the program's own.
    ``choices`` are what else counts.
    """
    if not _is_ours(target):
        return None
    try:
        compiler = find_compiler()
    except CompilationError:
        return None
    resolved = {k: v for k, v in target.resolved.items() if k not in _WITHOUT_EFFECT}
    if target.choices is None:
        resolved = {"model": target.model_name, "changes": target.overrides}
        resolved |= target.written.described
    facts = [_program(), version("casadi"), compiler.identity, resolved, named_files(target)]
    try:
        text = json.dumps([*facts, *choices], sort_keys=True)
    except TypeError:
        return None
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _is_ours(target: Target) -> bool:
    """Return whether the model and all parts of a scenario, theirs too, are this package's."""
    if target.built is not None:
        return False
    written = target.written
    kinds = [*_kinds(target.choices), *written.classes, *_kinds(written.file)]
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
