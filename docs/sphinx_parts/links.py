"""Pages written for a code hosting site, made a book: chapters from lists, links that stay inside.

``index.md`` names the chapters in its headings, a chapter its pages in a list; these become the
tables of contents. A link to a file outside of ``docs`` becomes a download, one to a folder its
name, since the book is read without the repository.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

CHAPTERS = re.compile(r"^## \[[^]]+\]\(([^)#]+)\.md\)", re.MULTILINE)
PAGES = re.compile(r"^- \[[^]]+\]\(([^)#]+)\.md\)", re.MULTILINE)
_LINK = re.compile(r"(?<!!)\[([^]\n]+)\]\((\.\./[^)\s]+)\)")
_INSIDE = {
    "README.md": "index.md",
    "reports/validation.md": "reference/validation.md",
    "CONTRIBUTING.md": "reference/contributing.md",
    "CHANGELOG.md": "reference/changelog.md",
}
"""Pages for files of the repository that the book holds too."""


def contents(page: str, text: str) -> list[str]:
    """Return the documents below a page: chapters of the index, pages of a chapter."""
    return (CHAPTERS if page == "index" else PAGES).findall(text)


def turn_inwards(text: str, *, page: Path, docs: Path) -> str:
    """Return a page's text without links that leave the book.

    Parameters
    ----------
    text
        The page in Markdown.
    page
        Its file.
    docs
        Folder of the book; files of the repository lie beside it.
    """

    def replaced(match: re.Match[str]) -> str:
        label, target = match[1], match[2].partition("#")[0]
        path = Path(os.path.normpath(page.parent / target))
        if path == docs:
            return f"[{label}]({os.path.relpath(docs / 'index.md', page.parent)})"
        if path.is_relative_to(docs):
            return match[0]
        inside = _INSIDE.get(path.relative_to(docs.parent).as_posix())
        if inside is not None:
            return f"[{label}]({os.path.relpath(docs / inside, page.parent)})"
        return f"[{label}]({target})" if path.is_file() else f"`{label.strip('`')}`"

    return _LINK.sub(replaced, text)


def _read(app: Sphinx, page: str, source: list[str]) -> None:
    docs = Path(app.srcdir)
    below = contents(page, source[0])
    text = turn_inwards(source[0], page=docs / f"{page}.md", docs=docs)
    if below:
        text += "\n```{toctree}\n:hidden:\n\n" + "\n".join(below) + "\n```\n"
    source[0] = text


def setup(app: Sphinx) -> dict[str, Any]:
    """Rewrite each page as it is read, after the lists of generated pages are in it."""
    app.connect("source-read", _read, priority=600)
    return {"parallel_read_safe": True}
