"""Headers of OpenCRG files: named blocks of settings, options, modifiers and channels.

The format is that of ASAM OpenCRG 1.2: blocks begin with a line ``$NAME``, settings are
``name = number``, ``*`` in the first column and ``!`` in a line begin comments, and a line of
``$$$$`` ends the header. Names are the same in capitals and small letters.
"""

from __future__ import annotations

import codecs
import math
import re
from dataclasses import dataclass, field

from vehicledyn.base.problems import Mark, Problem

BLOCKS = ("ROAD_CRG", "ROAD_CRG_OPTS", "ROAD_CRG_MODS")
_KNOWN = {*BLOCKS, "CT", "ROAD_CRG_FILE", "ROAD_CRG_MPRO", "KD_DEFINITION"}
_LINE = "reference_line_"
SETTINGS = {
    *(
        f"{_LINE}{end}_{of}"
        for end in ("start", "end")
        for of in ("u", "x", "y", "z", "phi", "b", "s")
    ),
    *(f"{_LINE}{end}_{of}" for end in ("start", "end") for of in ("lon", "lat", "alt")),
    *(f"{_LINE}offset_{of}" for of in ("x", "y", "z", "phi")),
    f"{_LINE}increment",
    *(f"long_section_v_{of}" for of in ("right", "left", "increment")),
}
OPTIONS = {
    *("border_mode_u", "border_mode_v", "border_offset_u", "border_offset_v"),
    *("border_smooth_ubeg", "border_smooth_uend", "refline_continuation"),
    *("refline_search_far", "refline_search_close", "refline_search_u", "refline_search_ufrac"),
    *("warn_msgs", "warn_curv_local", "warn_curv_global", "log_msgs", "log_eval", "log_hist"),
    *("log_eval_freq", "log_hist_freq", "log_stat", "log_stat_freq"),
    *("check_eps", "check_inc", "check_tol"),
}
MODIFIERS = {
    *(f"scale_{of}" for of in ("z_grid", "slope", "banking", "length", "width", "curvature")),
    *("grid_nan_mode", "grid_nan_offset", "refline_rotcenter_x", "refline_rotcenter_y"),
    *(f"refline_offset_{of}" for of in ("phi", "x", "y", "z")),
    *(f"refpoint_{of}" for of in ("u", "u_fraction", "u_offset", "v", "v_fraction", "v_offset")),
    *(f"refpoint_{of}" for of in ("x", "y", "z", "phi")),
}
_NAMES = {"ROAD_CRG": SETTINGS, "ROAD_CRG_OPTS": OPTIONS, "ROAD_CRG_MODS": MODIFIERS}
_UNITS = {"phi": "rad", "banking": "m/m", "slope": "m/m"}
_CHANNEL = re.compile(r"reference line (x|y|u|phi|banking|slope)\b", re.I)
_AT_PLACE = re.compile(r"long section at v\s*=\s*([^,\s]+)\s*,\s*m\s*$", re.I)
_NUMBERED = re.compile(r"long section\s+(\d+)\s*,\s*m\s*$", re.I)
_LONGEST_LINE = 1000
LARGEST = 1e6
"""Largest magnitude of a number in a file; no road is farther, longer or higher [m]."""


@dataclass
class Header:
    """What a header says; names in small letters, each with the line it stands in.

    ``channels`` are the columns of the data in their order: names of quantities along the
    reference line, or the number (int) or place v [m] (float) of a long section.
    """

    source: str
    values: dict[str, dict[str, float]] = field(default_factory=lambda: {b: {} for b in BLOCKS})
    lines: dict[str, int] = field(default_factory=dict)
    blocks: set[str] = field(default_factory=set)
    channels: list[str | int | float] = field(default_factory=list)
    channel_lines: list[int] = field(default_factory=list)
    code: str = "KRBI"
    includes: list[str] = field(default_factory=list)
    size: int = 0
    line_count: int = 0
    has_data: bool = False
    problems: list[Problem] = field(default_factory=list)

    def refuse(self, line: int, words: str, name: str = "") -> None:
        """Note a problem in a line (from 1)."""
        self.problems.append(Problem(self.source, Mark(line, 1), name, words))


def read_header(content: bytes, source: str) -> Header:
    """Return the header of a file's content; ``problems`` lists all that is wrong with it."""
    header = Header(source)
    block, start = "", len(codecs.BOM_UTF8) if content.startswith(codecs.BOM_UTF8) else 0
    while start < len(content) and not header.has_data:
        end = min(
            (at for at in (content.find(b"\n", start), content.find(b"\r", start)) if at >= 0),
            default=len(content),
        )
        raw = content[start:end]
        start = end + (2 if content[end : end + 2] == b"\r\n" else 1)
        header.line_count += 1
        if len(raw) > _LONGEST_LINE or b"\0" in raw:
            header.refuse(header.line_count, "this is no text; is it an OpenCRG file?")
            break
        block = _line(header, block, raw.decode("latin-1"))
    header.size = min(start, len(content))
    return header


def _line(header: Header, block: str, text: str) -> str:
    """Take in one line; return the block that the next one belongs to."""
    number = header.line_count
    if text.startswith("$$$$"):
        header.has_data = True
        return ""
    if text.startswith("$"):
        return _block(header, text)
    words = text.split("!", 1)[0].strip()
    if not words or text.lstrip().startswith("*") or block in ("", "CT", "ROAD_CRG_MPRO"):
        return block
    if block == "ROAD_CRG_FILE":
        header.includes.append(words)
    elif block == "KD_DEFINITION":
        _definition(header, words)
    else:
        _setting(header, block, words, number)
    return block


def _block(header: Header, text: str) -> str:
    name = re.split(r"[\s!*]", text[1:], maxsplit=1)[0].upper()
    if not name:
        return ""
    if name not in _KNOWN:
        header.refuse(header.line_count, f"unknown block '${name}'")
        return "CT"
    header.blocks.add(name)
    return name


def _setting(header: Header, block: str, words: str, number: int) -> None:
    name, equals, text = (part.strip() for part in words.partition("="))
    name = name.lower()
    if not equals:
        header.refuse(number, f"'{words[:60]}' is no setting; write name = number")
        return
    if name not in _NAMES[block]:
        header.refuse(number, f"unknown name in ${block}", name)
        return
    try:
        value = _number(text)
    except ValueError:
        header.refuse(number, f"'{text[:60]}' is no number", name)
        return
    if not abs(value) <= LARGEST:
        header.refuse(number, f"must be a finite number, {LARGEST:g} at most", name)
        return
    if name in header.values[block]:
        header.refuse(number, f"set before, in line {header.lines[name]}", name)
        return
    header.values[block][name] = value
    header.lines[name] = number


def _number(text: str) -> float:
    """Return a number; exponents as Fortran writes them (d) and "1.5+e00" of old writers count."""
    return float(re.sub(r"([+-])e", r"e\1", text.lower().replace("d", "e")))


def _definition(header: Header, words: str) -> None:
    number, kind, rest = header.line_count, words[:2].upper(), words[2:].strip()
    if kind == "#:":
        header.code = rest[:4].upper()
        if header.code not in ("LRFI", "LDFI", "KRBI", "KDBI"):
            header.refuse(number, f"unknown data format '{rest[:20]}'; LRFI, LDFI, KRBI or KDBI")
    elif kind == "D:":
        channel = _channel(header, rest)
        if channel is not None:
            header.channels.append(channel)
            header.channel_lines.append(number)
    elif kind != "U:":
        header.refuse(number, f"'{words[:60]}' is no definition; U:, D: or #:")


def _channel(header: Header, text: str) -> str | int | float | None:
    along = _CHANNEL.match(text)
    if along:
        name = along[1].lower()
        unit = _UNITS.get(name, "m")
        if text.rpartition(",")[2].strip().lower() != unit:
            header.refuse(header.line_count, f"unit must be {unit}", f"reference line {name}")
        return name
    numbered, placed = _NUMBERED.match(text), _AT_PLACE.match(text)
    if numbered:
        return int(numbered[1])
    if placed:
        try:
            place = float(placed[1])
        except ValueError:
            place = math.inf
        if abs(place) <= LARGEST:
            return place
        header.refuse(header.line_count, f"'{placed[1][:40]}' is no place v")
        return None
    header.refuse(header.line_count, f"unknown channel '{text[:60]}'")
    return None
