"""Docstrings of the package, which are plain text, made safe for Sphinx.

They hold equations, in which ``*``, ``|`` and a trailing ``_`` mean what they look like, and
indent them without blank lines around. Literals, roles and listings stay as they are.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from sphinx.application import Sphinx
from sphinx.ext.napoleon import Config, NumpyDocstring

BEFORE_NAPOLEON = 400
_KEPT = re.compile(r"(``.+?``|:\w+:`[^`]+`)")
_SPECIAL = re.compile(r"([*|\\`]|(?<=\w)_(?!\w))")
_RULE = re.compile(r"^-{3,}$")
_TUPLE_FIELD = "Alias for field number"
_LITERAL = re.compile(r"^\s*(>>>|\.\.\.)")


def to_restructured(text: list[str]) -> list[str]:
    """Return a docstring's lines as reStructuredText that NumPy's sections may still divide."""
    return list(_spaced(_escaped(text)))


def render(text: str) -> str:
    """Return a whole docstring, without indentation, as finished reStructuredText."""
    lines = to_restructured(text.splitlines())
    return str(NumpyDocstring(lines, Config(napoleon_use_rtype=False)))


def _escaped(lines: list[str]) -> Iterator[str]:
    listing: int | None = None
    for line in lines:
        indent = len(line) - len(line.lstrip())
        if listing is not None and line.strip() and indent <= listing:
            listing = None
        if listing is not None or _LITERAL.match(line):
            yield line
            continue
        pieces = _KEPT.split(line)
        pieces[::2] = [_SPECIAL.sub(r"\\\1", piece) for piece in pieces[::2]]
        yield "".join(pieces)
        if line.rstrip().endswith("::"):
            listing = indent


def _spaced(lines: Iterator[str]) -> Iterator[str]:
    """Put blank lines where the indentation changes, but for the terms of NumPy's sections."""
    last, in_section, listing = "", False, False
    for line in lines:
        if _RULE.match(line.strip()):
            in_section = True
        listing = bool(_LITERAL.match(line)) or (listing and bool(line.strip()))
        deeper = _indent(line) - _indent(last)
        is_term = in_section and _indent(last) == 0
        is_bullet = last.lstrip().startswith(("- ", "* ")) and deeper == 2
        if last.strip() and line.strip() and not listing and not is_bullet:
            if deeper > 0 and not is_term:
                yield ""
            if deeper < 0 and not (in_section and _indent(line) == 0):
                yield ""
        yield line
        last = line


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip())


def _process(*event: Any) -> None:
    lines: list[str] = event[-1]
    lines[:] = to_restructured(lines)


def _skip(*event: Any) -> bool | None:
    """Leave out what Python itself says of the fields of a named tuple."""
    thing = event[3]
    return True if str(getattr(thing, "__doc__", "")).startswith(_TUPLE_FIELD) else None


def setup(app: Sphinx) -> dict[str, Any]:
    """Take docstrings before napoleon does."""
    app.connect("autodoc-process-docstring", _process, priority=BEFORE_NAPOLEON)
    app.connect("autodoc-skip-member", _skip)
    return {"parallel_read_safe": True}
