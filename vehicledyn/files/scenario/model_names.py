"""Names of models: vehicles of the catalogue, systems of the library, or files."""

from __future__ import annotations

from pathlib import Path, PurePath
from typing import Any

from vehicledyn.base.registry import kinds
from vehicledyn.library import find_entry, names_of

PYTHON = "python:"
"""Begins the names of models that were built in Python, which take the place of a file."""


def known_models() -> tuple[str, ...]:
    """Return the names of all models that come with the program, sorted."""
    return tuple(sorted({*kinds("model"), *names_of("system")}))


def is_written(model: Any) -> bool:
    """Return whether a model is a system file: one of the user's, or one of the library."""
    if not isinstance(model, str) or model in kinds("model"):
        return False
    return _is_file_name(model) or find_entry(model, ("system",)) is not None


def system_path(model: str, folder: Path) -> Path:
    """Return the system file of a name that :func:`is_written`.

    Parameters
    ----------
    model
        Path of the file, or a name of the library.
    folder
        Where relative paths begin.
    """
    entry = None if _is_file_name(model) else find_entry(model, ("system",))
    return folder / model if entry is None else entry.path


def _is_file_name(model: str) -> bool:
    return PurePath(model).suffix.lower() in (".yaml", ".yml") or model.startswith(PYTHON)
