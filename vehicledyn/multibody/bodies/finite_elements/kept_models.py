"""Component modes of files, kept while the files stay what they are."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from pathlib import Path
from typing import Any

from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodies.finite_elements.model import FiniteElements
from vehicledyn.multibody.bodies.finite_elements.reading import read_archive, read_matrices
from vehicledyn.multibody.bodies.finite_elements.reduction import ComponentModes, component_modes

_KEPT = 8
_MODELS: BoundedCache[Hashable, FiniteElements] = BoundedCache(_KEPT)
_MODES: BoundedCache[Hashable, ComponentModes] = BoundedCache(4 * _KEPT)


def model_of(files: dict[str, Path]) -> FiniteElements:
    """Return the model of an ``archive``, or of the files of nodes and matrices by name.

    Raises
    ------
    InputError
        If a file cannot be read or holds no free structure.
    """

    def make() -> FiniteElements:
        if "archive" in files:
            return read_archive(files["archive"])
        return read_matrices(files)

    return _MODELS.get(_stamp(files), make)


def modes_of(files: dict[str, Path], **options: Any) -> ComponentModes:
    """Return the component modes of files; ``options`` are those of :func:`component_modes`."""
    key = _stamp(files), repr(sorted(options.items()))
    make: Callable[[], ComponentModes] = lambda: component_modes(model_of(files), **options)  # noqa: E731
    return _MODES.get(key, make)


def _stamp(files: dict[str, Path]) -> Hashable:
    """Return what changes when a file does."""
    found = []
    for name, path in sorted(files.items()):
        try:
            facts = path.stat()
        except (OSError, ValueError):
            raise InputError(f"{path}: there is no such file") from None
        found.append((name, str(path.absolute()), facts.st_mtime_ns, facts.st_size))
    return tuple(found)
