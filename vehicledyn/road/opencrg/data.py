"""Data of OpenCRG roads: what a file says, as arrays, before its modifiers."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.limits import read_regular
from vehicledyn.base.problems import Mark, Problem, refusal
from vehicledyn.road.opencrg.header import BLOCKS, LARGEST, Header, read_header
from vehicledyn.road.opencrg.payload import Array, PayloadError, read_payload

MOST_BYTES = 2_000_000_000
_MOST_INCLUDES = 10
_SMALLEST_STEP = 1e-6
_UNEVEN = 3e-2


@dataclass
class CrgData:
    """A curved regular grid as its file gives it.

    Parameters
    ----------
    source
        Name of the file.
    settings, options, modifiers
        Numbers of the blocks ``$ROAD_CRG``, ``$ROAD_CRG_OPTS`` and ``$ROAD_CRG_MODS``.
    has_modifiers
        Whether the file has a block of modifiers; if not, the standard's defaults apply.
    start, step
        First u and distance of cross sections [m].
    v
        Places of the long sections, growing, shape (n_v,) [m].
    is_even
        Whether the long sections are numbered, at equal distances.
    heights
        Heights over the reference line, shape (n_u, n_v), single precision [m].
    heading, bank, slope
        Along the reference line, shape (n_u,), or None [rad, 1, 1].
    """

    source: str
    settings: dict[str, float]
    options: dict[str, float]
    modifiers: dict[str, float]
    has_modifiers: bool
    start: float
    step: float
    v: Array
    is_even: bool
    heights: NDArray[np.float32]
    heading: Array | None = None
    bank: Array | None = None
    slope: Array | None = None
    lines: dict[str, int] = field(default_factory=dict)

    def setting(self, name: str) -> float:
        """Return a number of ``$ROAD_CRG``; zero where the file is silent."""
        return self.settings.get(name, 0.0)


def read_crg(path: Path) -> CrgData:
    """Return what an OpenCRG file says.

    Raises
    ------
    InputError
        If it cannot be read or is no road; with line and, for data, column.
    """
    header, content = _whole(path, 0)
    if not header.channels and not header.problems:
        header.refuse(header.line_count, "no channels are defined ($KD_Definition)")
    if not header.has_data and not header.problems:
        header.refuse(header.line_count, "the header does not end ($$$$): no data")
    rows = _announced(header)
    v = _places(header)
    if header.problems:
        raise refusal(header.problems, str(path))
    try:
        table = read_payload(content, header, rows)
    except PayloadError as error:
        raise refusal([error.problem], str(path)) from None
    return _data(header, table, v, path)


def _whole(path: Path, depth: int) -> tuple[Header, bytes]:
    """Return the header of a file joined with those of files that it includes, and the data."""
    content = read_regular(path, MOST_BYTES)
    header = read_header(content, str(path))
    for name in header.includes:
        if depth == _MOST_INCLUDES:
            raise InputError(f"{path}: more than {_MOST_INCLUDES} files include each other")
        below, data = _whole(path.parent / name, depth + 1)
        _join(header, below)
        if below.has_data and not header.has_data:
            content = data
            header.has_data, header.code, header.size = True, below.code, below.size
            header.line_count, header.source = below.line_count, below.source
            header.channels, header.channel_lines = below.channels, below.channel_lines
    return header, content


def _join(header: Header, below: Header) -> None:
    """Take over what an included file says; options and modifiers only as whole blocks."""
    for block in BLOCKS:
        if block != "ROAD_CRG" and block in header.blocks:
            continue
        header.values[block] = {**below.values[block], **header.values[block]}
        header.blocks |= below.blocks & {block}
    header.lines = {**below.lines, **header.lines}
    header.problems.extend(below.problems)


def _announced(header: Header) -> int | None:
    """Return the number of cross sections that the settings say, None where they do not."""
    values = header.values["ROAD_CRG"]
    step = values.get("reference_line_increment", 0.01)
    if not step >= _SMALLEST_STEP:
        words = f"must be at least {_SMALLEST_STEP:g} m, not {step:g}"
        line = header.lines.get("reference_line_increment", header.line_count)
        header.refuse(line, words, "reference_line_increment")
        return None
    end = values.get("reference_line_end_u")
    if end is None:
        return None
    length = end - values.get("reference_line_start_u", 0.0)
    if length <= 0.0:
        header.refuse(header.lines["reference_line_end_u"], "lies before the start of the line")
        return None
    return int(length / step + 0.5) + 1


def _places(header: Header) -> Array:
    """Return the places of the long sections in the order of the file [m]."""
    found = [c for c in header.channels if not isinstance(c, str)]
    line = header.channel_lines[0] if header.channel_lines else header.line_count
    for number, name in enumerate(header.channels):
        if isinstance(name, str) and name in ("x", "y"):
            words = "give the heading phi; x and y of the reference line follow from it"
            header.refuse(header.channel_lines[number], words, f"reference line {name}")
        elif isinstance(name, str) and header.channels.index(name) != number:
            header.refuse(header.channel_lines[number], "defined twice", f"reference line {name}")
    if header.problems:
        return np.empty(0)
    if len(found) < 2:
        header.refuse(line, f"a road needs two long sections at least, not {len(found)}")
        return np.empty(0)
    if len({type(c) for c in found}) > 1:
        header.refuse(line, "long sections are numbered or placed (at v = ...), not both")
        return np.empty(0)
    return _numbered(header, line) if isinstance(found[0], int) else _placed(header, line)


def _numbered(header: Header, line: int) -> Array:
    numbers = np.array([c for c in header.channels if not isinstance(c, str)])
    if sorted(numbers) != list(range(1, len(numbers) + 1)):
        header.refuse(line, f"long sections must be numbered from 1 to {len(numbers)}")
    values = header.values["ROAD_CRG"]
    step = values.get("long_section_v_increment", 0.01)
    if not step >= _SMALLEST_STEP:
        words = f"must be at least {_SMALLEST_STEP:g} m, not {step:g}"
        at = header.lines.get("long_section_v_increment", line)
        header.refuse(at, words, "long_section_v_increment")
    return values.get("long_section_v_right", 0.0) + (numbers - 1) * step


def _placed(header: Header, line: int) -> Array:
    places = np.array([c for c in header.channels if not isinstance(c, str)], dtype=float)
    if np.diff(np.sort(places)).min() < _SMALLEST_STEP:
        header.refuse(line, f"long sections must be {_SMALLEST_STEP:g} m apart at least")
    return places


def _data(header: Header, table: Array, v: Array, path: Path) -> CrgData:
    if len(table) < 2:
        words = f"a road needs two cross sections at least, not {len(table)}"
        mark = Mark(header.line_count, 1)
        raise refusal([Problem(header.source, mark, "", words)], str(path))
    beyond = np.abs(table) > LARGEST
    if beyond.any():
        row, column = np.argwhere(beyond)[0]
        words = f"number {column + 1} of cross section {row + 1} is {table[row, column]:g}"
        raise InputError(f"{path}: {words}; no road is farther or higher than {LARGEST:g} m")
    columns = {n: i for i, n in enumerate(header.channels) if isinstance(n, str)}
    along = {name: table[:, at].copy() for name, at in columns.items()}
    for name, numbers in along.items():
        if np.isnan(numbers[1:]).any():
            row = int(np.isnan(numbers[1:]).argmax()) + 2
            raise InputError(f"{path}: reference line {name}: no number in cross section {row}")
    values = header.values["ROAD_CRG"]
    start = values.get("reference_line_start_u", 0.0)
    step = values.get("reference_line_increment", 0.01)
    if "u" in along:
        start, step = _axis(along["u"], path)
    if "phi" in along:
        along["phi"][0] = values.get("reference_line_start_phi", 0.0)
    order = np.argsort(v)
    cells = [i for i, c in enumerate(header.channels) if not isinstance(c, str)]
    heights = table[:, cells][:, order].astype(np.float32)
    is_even = isinstance(header.channels[cells[0]], int)
    return CrgData(
        str(path),
        dict(values),
        dict(header.values["ROAD_CRG_OPTS"]),
        dict(header.values["ROAD_CRG_MODS"]),
        "ROAD_CRG_MODS" in header.blocks,
        start,
        step,
        v[order],
        is_even,
        heights,
        along.get("phi"),
        along.get("banking"),
        along.get("slope"),
        header.lines,
    )


def _axis(u: Array, path: Path) -> tuple[float, float]:
    """Return start and distance of cross sections from a column u."""
    steps = np.diff(u)
    if steps.min() < _SMALLEST_STEP or np.ptp(steps) > _UNEVEN * steps.min():
        raise InputError(f"{path}: reference line u: the places must grow in equal steps")
    return float(u[0]), float((u[-1] - u[0]) / (len(u) - 1))
