"""Lines of a tyre property file: sections, names and values, with the line each stands on."""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from vehicledyn.base.files.limits import read_regular
from vehicledyn.base.problems import Mark, Problem, refusal

LARGEST_FILE = 2_000_000
"""Most bytes that are read of a tyre property file; usual ones have 20 kB."""

_MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
"""What a file begins with in another encoding than Latin-1."""

_END = b"\x1a"
"""End of a text of DOS."""

_SECTION = re.compile(r"\[\s*([^\]]+?)\s*\]")
_TABLES = ("SHAPE", "DEFLECTION_LOAD_CURVE", "BOTTOMING_CURVE", "COMMENTS")
"""Sections that hold no ``name = value`` lines alone, or only words."""


@dataclass(frozen=True)
class Assignment:
    """One ``name = value`` line; ``text`` is the value without quotes and comment."""

    section: str
    name: str
    text: str
    line: int


def read_text(path: Path) -> str:
    """Return the text of a tyre property file, without the marks that editors put at its ends.

    Raises
    ------
    InputError
        If the file cannot be read, is too large or no text.
    """
    content = read_regular(path, LARGEST_FILE).rstrip(_END)
    encoding = next((name for mark, name in _MARKS.items() if content.startswith(mark)), "latin-1")
    text = content.decode(encoding, errors="replace")
    if "\0" in text:
        words = "this is a binary file; a tyre property file (.tir) is text"
        raise refusal([Problem(str(path), Mark(1, 1), "", words)], str(path))
    return text


def read_lines(path: Path) -> tuple[list[Assignment], list[Problem]]:
    """Return the entries of a tyre property file, and the problems of its lines.

    Raises
    ------
    InputError
        If the file cannot be read, is too large or no text.
    """
    text = read_text(path)
    entries: list[Assignment] = []
    problems: list[Problem] = []
    for item in _entries(text, str(path)):
        (entries if isinstance(item, Assignment) else problems).append(item)  # type: ignore[arg-type]
    if not entries and not problems:
        words = "no 'NAME = value' lines; is this a tyre property file (.tir)?"
        problems.append(Problem(str(path), Mark(1, 1), "", words))
    return entries, problems


def _entries(text: str, source: str) -> Iterator[Assignment | Problem]:
    section = ""
    for number, raw in enumerate(text.splitlines(), start=1):
        line = raw.strip()
        if not line or line[0] in "$!#":
            continue
        found = _SECTION.match(line)
        if found:
            section = found[1].upper()
        elif section in _TABLES or line[0] == "{":
            continue
        elif "=" in line:
            name, _, rest = line.partition("=")
            yield Assignment(section, name.strip().upper(), _value(rest), number)
        else:
            words = f"expected 'NAME = value', found {line[:40]!r}"
            yield Problem(source, Mark(number, 1), f"[{section}]" if section else "", words)


def _value(rest: str) -> str:
    """Return what stands behind the equals sign, without comment and quotes."""
    text = rest.strip()
    if text[:1] in ("'", '"'):
        return text[1:].partition(text[0])[0].strip()
    return re.split(r"[$!]", text, maxsplit=1)[0].strip()
