"""The reference chapter, generated: commands, files, catalogues, modules, validation.

Before Sphinx reads anything, the pages are written into ``docs/reference``, which is no part of
the repository, and their list is added to ``reference.md``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

from sphinx_parts import catalogues, commands, copies, modules, schemas

Pages = dict[str, tuple[str, str]]

_remembered: Pages = {}


def pages(root: Path) -> Pages:
    """Return name, text and a line of description of each generated page, in reading order."""
    return {
        **commands.pages(),
        **schemas.pages(),
        **catalogues.pages(),
        **modules.pages(root / "vehicledyn"),
        **copies.pages(root),
    }


def _write(app: Sphinx) -> None:
    folder = Path(app.srcdir) / "reference"
    folder.mkdir(exist_ok=True)
    _remembered.update(pages(Path(app.srcdir).parent))
    for name, (text, _) in _remembered.items():
        path = folder / f"{name}.md"
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    for path in folder.glob("*.md"):
        if path.stem not in _remembered:
            path.unlink()


def _list(app: Sphinx, page: str, source: list[str]) -> None:
    if page == "reference":
        lines = [
            f"- [{text.partition(chr(10))[0].lstrip('# ')}](reference/{name}.md): {note}"
            for name, (text, note) in _remembered.items()
        ]
        source[0] += "\n" + "\n".join(lines) + "\n"


def setup(app: Sphinx) -> dict[str, Any]:
    """Write the pages first, list them before links are turned."""
    app.connect("builder-inited", _write)
    app.connect("source-read", _list, priority=500)
    return {"parallel_read_safe": True}
