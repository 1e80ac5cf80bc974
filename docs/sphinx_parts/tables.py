"""Tables in Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

_CODE = re.compile(r"(`[^`]*`|\]\([^)]*\))")


def plain(text: str) -> str:
    """Return a text in which Markdown finds nothing to emphasise; code and links stay."""
    pieces = _CODE.split(" ".join(text.split()))
    pieces[::2] = [re.sub(r"([*_<>$\\])", r"\\\1", piece) for piece in pieces[::2]]
    return "".join(pieces)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table; cells may hold code and links."""
    lines = [head, ["---"] * len(head), *([plain(cell) for cell in row] for row in rows)]
    return "\n".join(
        "| " + " | ".join(c.replace("|", "\\|") for c in line) + " |" for line in lines
    )
