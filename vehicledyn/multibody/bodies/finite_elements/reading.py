"""Reads finite-element matrices: NumPy archives and arrays, Matrix Market files, tables of text.

All numbers are in kg, m, s and rad. One archive (.npz) holds everything: ``nodes`` (n, 3), the
numbers of the nodes ``numbers`` (n,) where they are not 1, 2, ..., what each row stands for as
``dofs`` (n_rows, 2), number of the node and direction 1 to 6, where it is not 3 or 6 directions
node by node, and ``mass``, ``stiffness`` and if wanted ``damping``: each one array, or compressed
rows ``mass_data``, ``mass_indices`` and ``mass_indptr``. Or each is a file of its own: a matrix in
.mtx, .npy or a sparse .npz of SciPy, nodes and dofs in .npy or a table of text (.csv, .txt).
"""

from __future__ import annotations

import io
import re
import struct
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.limits import UnreadableFileError, read_regular
from vehicledyn.multibody.bodies.finite_elements.model import (
    FiniteElements,
    GeometricStiffness,
    Sparse,
    all_rows,
)

Array = NDArray[np.float64]
_LARGEST = 2_000_000_000
_LARGEST_TABLE = 200_000_000
_MATRICES = ("mass", "stiffness", "damping")
_PARTS = ("data", "indices", "indptr")
_GEOMETRIC = "geometric_"
_HELD = "geometric_held"
_UNREADABLE = (
    ValueError, TypeError, KeyError, AttributeError, OSError, EOFError, OverflowError, MemoryError,
    SyntaxError, NotImplementedError, RuntimeError, struct.error, zlib.error, zipfile.BadZipFile,
)  # fmt: skip
"""What NumPy raises at content that is none of its archives and arrays."""


def read_archive(path: Path) -> FiniteElements:
    """Return the model that an archive of NumPy holds, see the head of this module.

    Raises
    ------
    InputError
        If it cannot be read, lacks an array, or the matrices are of no free structure.
    """
    arrays = _arrays(path)
    known = {"nodes", "numbers", "dofs", *_MATRICES}
    known |= {f"{name}_{part}" for name in _MATRICES for part in _PARTS}
    unknown = sorted(name for name in arrays.keys() - known if not name.startswith(_GEOMETRIC))
    if unknown:
        words = f"{path}: has an array '{unknown[0]}' that says nothing to this program"
        raise InputError(f"{words}; known are {', '.join(sorted(known))}")
    matrices = {name: _matrix_in(arrays, name, path) for name in _MATRICES}
    lacking = [n for n in ("mass", "stiffness") if matrices[n] is None]
    lacking += [n for n in ("nodes",) if n not in arrays]
    if lacking:
        raise InputError(f"{path}: lacks the array '{lacking[0]}'; {_content()}")
    places = _of_width(arrays["nodes"], 3, f"{path}: nodes")
    numbers = _whole(arrays.get("numbers", np.arange(1, len(places) + 1)), f"{path}: numbers")
    numbers = numbers.ravel()
    if len(numbers) != len(places):
        words = f"{path}: numbers: {len(numbers)} numbers for {len(places)} nodes"
        raise InputError(f"{words}; give one number for each node")
    rows = None
    if "dofs" in arrays:
        rows = _whole(_of_width(arrays["dofs"], 2, f"{path}: dofs"), f"{path}: dofs")
    geometric = _geometric(arrays, path)
    return _model(str(path), (numbers, places), rows, matrices, geometric=geometric)


def _geometric(arrays: Mapping[str, Any], path: Path) -> GeometricStiffness | None:
    """Return the geometric stiffness under each load, None where the archive has none."""
    names = {name for name in arrays if name.startswith(_GEOMETRIC)} - {_HELD}
    if not names:
        return None
    loads = {name.removeprefix(_GEOMETRIC) for name in names}
    loads = {re.sub(r"_(data|indices|indptr)$", "", load) for load in loads}
    found = {load: _matrix_in(arrays, f"{_GEOMETRIC}{load}", path) for load in sorted(loads)}
    broken = [load for load, matrix in found.items() if matrix is None]
    if broken:
        raise InputError(f"{path}: {_GEOMETRIC}{broken[0]}: is no whole matrix")
    held = _whole(arrays.get(_HELD, 0), f"{path}: {_HELD}").ravel()
    if len(held) != 1:
        raise InputError(f"{path}: {_HELD}: give the number of one node, or 0")
    return GeometricStiffness(int(held[0]), found)


def read_matrices(files: Mapping[str, Path]) -> FiniteElements:
    """Return the model that several files hold.

    Parameters
    ----------
    files
        File of ``nodes``, ``mass`` and ``stiffness``, and if wanted of ``dofs`` and ``damping``.
        Tables have one row a node (number, x, y, z) and one row a direction (node, direction).

    Raises
    ------
    InputError
        If one cannot be read, or the matrices are of no free structure.
    """
    matrices = {n: read_matrix(files[n]) if n in files else None for n in _MATRICES}
    table, _ = _table(files["nodes"], 4)
    rows, lines = _table(files["dofs"], 2) if "dofs" in files else (None, [])
    kept = None if rows is None else _whole(rows, str(files["dofs"]))
    source = str(files["stiffness"])
    nodes = _whole(table[:, 0], f"{files['nodes']}: numbers of the nodes"), table[:, 1:]
    return _model(source, nodes, kept, matrices, lines=lines)


def read_matrix(path: Path) -> Sparse:
    """Return a matrix in compressed rows: from .mtx, .npy or a sparse .npz.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    from scipy.sparse import csr_matrix

    if path.suffix == ".mtx":
        return _matrix_market(path)
    if path.suffix == ".npy":
        return csr_matrix(_array(path))
    if path.suffix == ".npz":
        arrays = _arrays(path)
        found = _matrix_in({f"matrix_{k}": v for k, v in arrays.items()}, "matrix", path)
        if found is not None:
            return found
    raise InputError(f"{path}: is no matrix; give a .mtx, .npy or a sparse .npz file of SciPy")


def write_archive(model: FiniteElements, path: Path) -> None:
    """Write a model as an archive that :func:`read_archive` reads."""
    arrays: dict[str, Any] = {
        "numbers": model.numbers, "nodes": model.places, "dofs": model.rows,
    }  # fmt: skip
    for name in _MATRICES:
        matrix = getattr(model, name)
        if matrix is not None:
            arrays |= {f"{name}_{part}": getattr(matrix, part) for part in _PARTS}
    if model.geometric is not None:
        arrays[_HELD] = model.geometric.held
        for load, matrix in model.geometric.matrices.items():
            arrays |= {f"{_GEOMETRIC}{load}_{part}": getattr(matrix, part) for part in _PARTS}
    np.savez_compressed(path, **arrays)


def _model(
    source: str,
    nodes: tuple[NDArray[np.int64], Array],
    rows: NDArray[np.int64] | None,
    matrices: Mapping[str, Sparse | None],
    **more: Any,
) -> FiniteElements:
    (numbers, places), mass, stiffness = nodes, matrices["mass"], matrices["stiffness"]
    if rows is None:
        try:
            rows = all_rows(numbers, stiffness.shape[0])  # type: ignore[union-attr]
        except InputError as error:
            raise InputError(f"{source}: {error}") from None
    damping = matrices["damping"]
    return FiniteElements(source, numbers, places, rows, mass, stiffness, damping, **more)


def _content() -> str:
    return "an archive holds nodes, mass and stiffness, and if wanted numbers, dofs and damping"


def _bytes(path: Path, largest: int) -> bytes:
    try:
        return read_regular(path, largest)
    except UnreadableFileError as error:
        raise InputError(f"{path}: {error.words}") from None


def _arrays(path: Path) -> dict[str, Any]:
    """Return the arrays of an archive by name."""
    content = io.BytesIO(_bytes(path, _LARGEST))
    try:
        with np.load(content, allow_pickle=False) as archive:
            found = {name: archive[name] for name in archive.files}
    except _UNREADABLE:
        words = f"{path}: is no archive of NumPy with arrays of numbers"
        raise InputError(f"{words}; write one with numpy.savez") from None
    for name, array in found.items():
        if array.dtype.kind not in "iuf" and not name.endswith("format"):
            raise InputError(f"{path}: {name}: is of type {array.dtype}; give real numbers")
    return found


def _array(path: Path) -> Array:
    content = io.BytesIO(_bytes(path, _LARGEST))
    try:
        found = np.load(content, allow_pickle=False)
    except _UNREADABLE:
        words = f"{path}: is no array of NumPy with numbers"
        raise InputError(f"{words}; write one with numpy.save") from None
    if found.dtype.kind not in "iuf":
        raise InputError(f"{path}: is of type {found.dtype}; give real numbers")
    return np.atleast_2d(found.astype(float))


def _matrix_in(arrays: Mapping[str, Any], name: str, path: Path) -> Sparse | None:
    """Return a matrix of an archive, whole or as compressed rows; None where it has none."""
    from scipy.sparse import csr_matrix

    parts = [arrays.get(f"{name}_{part}") for part in _PARTS]
    try:
        if name in arrays:
            return csr_matrix(np.asarray(arrays[name], dtype=float))
        if any(part is None for part in parts):
            return None
        count = len(parts[2]) - 1  # type: ignore[arg-type]
        found = csr_matrix(tuple(parts), shape=(count, count), dtype=float)
        found.check_format(full_check=True)
        found = found.tocoo().tocsr()
    except (ValueError, TypeError) as error:
        raise InputError(f"{path}: {name}: is no matrix of numbers: {error}") from None
    kind = arrays.get(f"{name}_format")
    return found if kind is None or kind.item() != b"csc" else found.T.tocsr()


def _of_width(array: Any, width: int, where: str) -> Array:
    try:
        found = np.asarray(array, dtype=float)
    except (ValueError, TypeError):
        raise InputError(f"{where}: are no numbers") from None
    if found.ndim != 2 or found.shape[1] != width:
        raise InputError(f"{where}: has the shape {found.shape}; give rows of {width} numbers")
    return found


def _whole(values: Any, where: str) -> NDArray[np.int64]:
    """Return whole numbers, such as those of nodes and directions."""
    found = np.asarray(values, dtype=float)
    wrong = found[~((np.abs(found) < _LARGEST) & (found == np.round(found)))]
    if wrong.size:
        raise InputError(f"{where}: {wrong[0]:g} is no whole number; numbers count nodes and ways")
    return found.astype(np.int64)


def _table(path: Path, width: int) -> tuple[Array, list[str]]:
    """Return rows of numbers, and where each is written; # begins a comment."""
    if path.suffix == ".npy":
        return _of_width(_array(path), width, str(path)), []
    try:
        text = _bytes(path, _LARGEST_TABLE).decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not a text file; give a table of text or a .npy") from None
    found: list[list[float]] = []
    lines: list[str] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split("#")[0].replace(",", " ").split()
        if not words:
            continue
        try:
            row = [float(word) for word in words]
        except ValueError:
            if not found and number == 1:
                continue
            raise InputError(f"{path}:{number}: '{line.strip()}' is no row of numbers") from None
        if len(row) != width:
            what = "number, x, y, z of a node" if width == 4 else "node and direction"
            raise InputError(f"{path}:{number}: has {len(row)} numbers; give {width}: {what}")
        found.append(row)
        lines.append(f"{path}:{number}")
    if not found:
        raise InputError(f"{path}: has no rows; give one a node or direction")
    return np.array(found), lines


def _matrix_market(path: Path) -> Sparse:
    from scipy.io import mmread
    from scipy.sparse import csr_matrix

    content = _bytes(path, _LARGEST)
    try:
        found = mmread(io.BytesIO(content))
    except (ValueError, OverflowError, TypeError, IndexError, EOFError) as error:
        words = str(error).strip() or "it cannot be read"
        line, _, rest = words.partition(":")
        number = line.removeprefix("Line ")
        where = f"{path}:{number}:{rest}" if number.isdigit() else f"{path}: {words}"
        raise InputError(f"{where}; a Matrix Market file is needed") from None
    if np.iscomplexobj(found if isinstance(found, np.ndarray) else found.data):
        raise InputError(f"{path}: is complex; give a real matrix")
    return csr_matrix(found)
