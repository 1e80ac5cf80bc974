"""Pages that the repository keeps elsewhere: validation, contributing, changelog."""

from __future__ import annotations

import re
from pathlib import Path

_SOURCES = {
    "validation": ("reports/validation.md", "published and independent figures beside ours."),
    "contributing": ("CONTRIBUTING.md", "how to add to the catalogues and to the program."),
    "changelog": ("CHANGELOG.md", "what has changed."),
}
_LINK = re.compile(r"\]\((?![a-z]+:|#)([^)\s]+)\)")


def pages(root: Path) -> dict[str, tuple[str, str]]:
    """Return the pages with links as seen from ``docs/reference``."""
    made = {}
    for name, (source, note) in _SOURCES.items():
        folder = Path(source).parent.as_posix()
        prefix = "../../" if folder == "." else f"../../{folder}/"
        text = (root / source).read_text(encoding="utf-8")
        made[name] = (_LINK.sub(lambda m, p=prefix: f"]({p}{m[1]})", text), note)
    return made
