"""Keys that tell whether a target is what it was: texts, files, the program and the compiler."""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Iterator
from functools import cache
from importlib.metadata import version
from pathlib import Path
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
    return target.built is None and not _foreign_modules(target)


def foreign_sources(target: Target) -> list[str]:
    """Return the code of models and parts of a scenario that are not this package's."""
    modules = [sys.modules.get(name) for name in sorted(_foreign_modules(target))]
    files = [Path(module.__file__) for module in modules if getattr(module, "__file__", None)]  # type: ignore[union-attr, arg-type]
    return [file.read_text(encoding="utf-8", errors="replace") for file in files if file.is_file()]


def _foreign_modules(target: Target) -> set[str]:
    written = target.written
    kinds = [*_kinds(target.choices), *written.classes, *_kinds(written.file)]
    names = {kind.__module__ for kind in kinds}
    return {name for name in names if name.split(".")[0] != PACKAGE}


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
