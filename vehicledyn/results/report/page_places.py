"""Where pages lie, and how one refers to another."""

from __future__ import annotations

import os
from pathlib import Path
from urllib.parse import quote


def beside(result: Path, what: str) -> Path:
    """Return the page of some kind that belongs to a result file."""
    return result.with_name(f"{result.stem}_{what}.html")


def address(target: Path, page: Path) -> str:
    """Return the address of a file as seen from a page, relative and quoted."""
    relative = os.path.relpath(target.resolve(), page.resolve().parent)
    return "./" + quote(relative.replace(os.sep, "/").encode("utf-8", "surrogateescape"))
