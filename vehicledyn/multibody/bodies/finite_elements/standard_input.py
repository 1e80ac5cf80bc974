"""Reads files of the standard input data of flexible bodies (SID), as MBS preprocessors write them.

Wallrapp (1994), Standardization of flexible body modeling in multibody system codes, Part I,
Mech. Struct. Mach. 22(3), 283-304. A line opens a class, says ``key = value`` or ends a class; the
matrices are Taylor series in the amplitudes, ``m0(i,j)`` and ``m1(i,k,j)`` for amplitude k.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.limits import UnreadableFileError, read_regular

Array = NDArray[np.float64]
_LARGEST_FILE = 400_000_000
_LARGEST_COUNT = 2_000
_LARGEST = 1e30
_INDEX = re.compile(r"(m0|m1)\s*\(\s*(\d+)\s*,\s*(\d+)\s*(?:,\s*(\d+)\s*)?\)$")
_DIAGONAL, _SYMMETRIC, _UNIT = 1, 2, 4
MATRICES = ("mdCM", "J", "Ct", "Cr", "Me", "Gr", "Ge", "Oe", "ksigma", "Ke", "De")
NEEDED = ("mdCM", "J", "Ct", "Cr", "Me", "Gr", "Oe", "Ke")
_OF_NODE = ("origin", "phi", "psi", "AP")


@dataclass(frozen=True, eq=False)
class Taylor:
    """A matrix to first order in the amplitudes q: ``constant`` + Σ q_k ``linear[:, k]``.

    Shapes (rows, columns) and (rows, n, columns); ``line`` is where it begins.
    """

    constant: Array
    linear: Array
    line: int


@dataclass(frozen=True, eq=False)
class StandardInput:
    """A body as its file gives it: mass, matrices by name, and those of each node by number."""

    source: str
    count: int
    mass: float
    matrices: dict[str, Taylor]
    nodes: dict[int, dict[str, Taylor]]

    def where(self, name: str) -> str:
        """Return file and line of a matrix, for messages."""
        found = self.matrices.get(name)
        return self.source if found is None else f"{self.source}:{found.line}"


@dataclass
class _Class:
    """A class of the file: its name and line, its entries by key, and the classes in it."""

    name: str
    value: str
    line: int
    entries: dict[str, tuple[str, int]] = field(default_factory=dict)
    inner: list[_Class] = field(default_factory=list)

    def one(self, name: str) -> _Class | None:
        return next((item for item in self.inner if item.name == name), None)


def read_standard_input(path: Path) -> StandardInput:
    """Return the body that a file of standard input data holds, in kg, m and s.

    Raises
    ------
    InputError
        If it cannot be read, a class or matrix is missing, or an entry is none of its matrix.
    """
    try:
        text = read_regular(path, _LARGEST_FILE).decode("utf-8", "replace")
    except UnreadableFileError as error:
        raise InputError(f"{path}: {error.words}") from None
    modal = _classes(path, text)
    refmod, frame = modal.one("refmod"), modal.one("frame")
    for name, found in (("refmod", refmod), ("frame", frame)):
        if found is None:
            raise InputError(f"{path}:{modal.line}: lacks the class '{name}'; write the whole file")
    if refmod is None or frame is None:
        raise ValueError("refused above")
    count = _whole(path, refmod, "nelastq")
    mass = _number(path, refmod, "mass")
    if mass <= 0.0:
        raise InputError(f"{path}:{refmod.entries['mass'][1]}: mass: {mass:g} kg is not above zero")
    shapes = _shapes(count)
    named = {item.name: item for item in modal.inner if item.name in MATRICES}
    lacking = [name for name in NEEDED if name not in named]
    if lacking:
        raise InputError(f"{path}:{modal.line}: lacks the matrix '{lacking[0]}'")
    matrices = {n: _taylor(path, item, shapes[n], count) for n, item in named.items()}
    nodes: dict[int, dict[str, Taylor]] = {}
    for node in frame.inner:
        number = _node_number(path, node)
        if number in nodes:
            raise InputError(f"{path}:{node.line}: node {number} is given twice")
        own = {item.name: item for item in node.inner if item.name in _OF_NODE}
        lost = [name for name in ("origin", "phi") if name not in own]
        if lost:
            raise InputError(f"{path}:{node.line}: node {number} lacks '{lost[0]}'")
        nodes[number] = {n: _taylor(path, item, shapes[n], count) for n, item in own.items()}
    if not nodes:
        raise InputError(f"{path}:{frame.line}: holds no node; others take hold of nodes only")
    return StandardInput(str(path), count, mass, matrices, nodes)


def _shapes(n: int) -> dict[str, tuple[int, int]]:
    return {
        "mdCM": (3, 1), "J": (6, 1), "Ct": (n, 3), "Cr": (n, 3), "Me": (n, n), "Gr": (3, 3 * n),
        "Ge": (n, 3 * n), "Oe": (n, 6), "ksigma": (n, 1), "Ke": (n, n), "De": (n, n),
        "origin": (3, 1), "phi": (3, n), "psi": (3, n), "AP": (3, 3),
    }  # fmt: skip


def _lines(text: str) -> Iterator[tuple[int, str, str, bool]]:
    """Yield number, key, value and whether a value was written of each line that says something."""
    for number, line in enumerate(text.splitlines(), 1):
        key, equals, value = line.partition("=")
        key = " ".join(key.split())
        if key:
            yield number, key, value.strip(), bool(equals)


def _classes(path: Path, text: str) -> _Class:
    """Return the class ``modal`` with all that is in it."""
    rest = _lines(text)
    if all(key != "part" and not key.startswith("part ") for _, key, _, _ in rest):
        raise InputError(f"{path}: has no line 'part': it is no file of standard input data")
    outside = _Class("part", "", 0)
    stack = [outside]
    for number, key, value, is_entry in rest:
        if key.startswith("end"):
            name = key.removeprefix("end").strip()
            if name != stack[-1].name:
                words = f"'{key}' ends '{stack[-1].name}' of line {stack[-1].line}"
                raise InputError(f"{path}:{number}: {words}; each class has its own end")
            stack.pop()
        elif key.startswith("new ") or not is_entry:
            made = _Class(key.removeprefix("new ").strip(), value, number)
            stack[-1].inner.append(made)
            stack.append(made)
        else:
            stack[-1].entries[key.replace(" ", "")] = value, number
        if not stack:
            break
    if stack:
        raise InputError(f"{path}: ends within '{stack[-1].name}'; the file is not whole")
    modal = outside.one("modal")
    if modal is None:
        raise InputError(f"{path}: lacks the class 'modal'; it begins with 'new modal ='")
    return modal


def _entry(path: Path, item: _Class, key: str) -> tuple[str, int]:
    if key not in item.entries:
        raise InputError(f"{path}:{item.line}: '{item.name}' lacks '{key}'")
    return item.entries[key]


def _value(path: Path, key: str, text: str, line: int) -> float:
    try:
        found = float(re.sub("[dD]", "e", text))
    except ValueError:
        raise InputError(f"{path}:{line}: {key}: '{text[:40]}' is no number") from None
    if not math.isfinite(found) or abs(found) > _LARGEST:
        raise InputError(f"{path}:{line}: {key}: {text[:40]} is no number that a body has")
    return found


def _number(path: Path, item: _Class, key: str) -> float:
    return _value(path, key, *_entry(path, item, key))


def _whole(path: Path, item: _Class, key: str) -> int:
    text, line = _entry(path, item, key)
    if not text.isdigit() or not 0 < int(text[:9]) <= _LARGEST_COUNT:
        words = f"'{text[:40]}' is no whole number from 1 to {_LARGEST_COUNT}"
        raise InputError(f"{path}:{line}: {key}: {words}")
    return int(text)


def _node_number(path: Path, node: _Class) -> int:
    if node.name != "node" or not node.value.isdigit() or len(node.value) > 9:
        raise InputError(f"{path}:{node.line}: is no 'new node = NUMBER'")
    return int(node.value)


def _taylor(path: Path, item: _Class, shape: tuple[int, int], count: int) -> Taylor:
    """Return a matrix, its entries where its structure and their indices say."""
    for key, wanted in (("nrow", shape[0]), ("ncol", shape[1]), ("nq", count)):
        if key in item.entries and item.entries[key][0] != str(wanted):
            text, line = item.entries[key]
            words = f"{item.name}: {key}: is {text[:40]} and must be {wanted}"
            raise InputError(f"{path}:{line}: {words} with nelastq = {count}")
    structure = item.entries.get("structure", ("3", item.line))[0]
    constant, linear = np.zeros(shape), np.zeros((shape[0], count, shape[1]))
    if structure == str(_UNIT):
        constant[: min(shape), : min(shape)] = np.eye(min(shape))
    mirrored = structure == str(_SYMMETRIC) and shape[0] == shape[1]
    given = {key for key in item.entries if key.startswith("m")}
    for key in given:
        text, line = item.entries[key]
        match = _INDEX.match(key)
        if match is None or (match[1] == "m1") != (match[4] is not None):
            raise InputError(f"{path}:{line}: {item.name}: '{key}' is no entry of m0 or m1")
        indices = [int(part) - 1 for part in match.groups()[1:] if part is not None]
        where = constant if match[1] == "m0" else linear
        if any(not 0 <= k < size for k, size in zip(indices, where.shape, strict=True)):
            raise InputError(f"{path}:{line}: {item.name}: {key} is outside of the matrix")
        value = _value(path, f"{item.name}: {key}", text, line)
        where[tuple(indices)] = value
        other = [indices[-1], *indices[1:-1], indices[0]]
        if mirrored and f"{match[1]}({','.join(str(k + 1) for k in other)})" not in given:
            where[tuple(other)] = value
    return Taylor(constant, linear, item.line)
