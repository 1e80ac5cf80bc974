"""Component modes of files, kept while the files stay what they are."""

from __future__ import annotations

from collections.abc import Hashable
from pathlib import Path
from typing import Any

from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodies.finite_elements.model import FiniteElements
from vehicledyn.multibody.bodies.finite_elements.reading import read_archive, read_matrices
from vehicledyn.multibody.bodies.finite_elements.reduced_modes import ReducedModes, reduced_modes
from vehicledyn.multibody.bodies.finite_elements.reduction import component_modes
from vehicledyn.multibody.bodies.finite_elements.standard_input import read_standard_input
from vehicledyn.multibody.bodies.finite_elements.standard_input_modes import modes_from

_KEPT = 8
_MODELS: BoundedCache[Hashable, FiniteElements] = BoundedCache(_KEPT)
_MODES: BoundedCache[Hashable, ReducedModes] = BoundedCache(4 * _KEPT)


class MissingNodeError(InputError):
    """A node that a file does not have."""


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


def modes_of(files: dict[str, Path], **options: Any) -> ReducedModes:
    """Return the component modes of files; ``options`` are those of :func:`component_modes`."""
    key = _stamp(files), repr(sorted(options.items()))
    return _MODES.get(key, lambda: reduced_modes(component_modes(model_of(files), **options)))


def standard_modes_of(file: Path, frames: dict[str, dict[str, int]]) -> ReducedModes:
    """Return the modes of a file of standard input data.

    Parameters
    ----------
    file
        The file.
    frames
        Nodes of the frames by name, by the field that names them.

    Raises
    ------
    InputError
        If it cannot be read, holds no body, or lacks a node.
    """

    def make() -> ReducedModes:
        data = read_standard_input(file)
        for where, nodes in frames.items():
            for name, number in nodes.items():
                if number not in data.nodes:
                    near = min(data.nodes, key=lambda known: abs(known - number))
                    words = f"{file} has no node {number}; the nearest number is {near}"
                    place = where if where == "lines" else f"{where}.{name}"
                    raise MissingNodeError(f"{place}: {words}")
        return modes_from(data, {n: k for nodes in frames.values() for n, k in nodes.items()})

    try:
        return _MODES.get((_stamp({"standard": file}), repr(frames)), make)
    except MissingNodeError:
        raise
    except InputError as error:
        raise InputError(f"file: {error}") from None


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
