"""The tree of assemblies of a system, for people and as plain data."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from vehicledyn.files.system.assemblies.read import Assembly


def assembly_lines(assemblies: Sequence[Assembly]) -> list[str]:
    """Return lines with each assembly, its file and title, those inside further indented."""
    return ["assemblies", *_lines(assemblies, "  "), ""] if assemblies else []


def assemblies_as_data(assemblies: Sequence[Assembly]) -> list[dict[str, Any]]:
    """Return the tree as nested mappings with name, file, title and assemblies."""
    return [
        {
            "name": item.name,
            "file": item.file,
            "title": item.title,
            "assemblies": assemblies_as_data(item.inner),
        }
        for item in assemblies
    ]


def _lines(assemblies: Sequence[Assembly], indent: str) -> Iterator[str]:
    for item in assemblies:
        what = f"{item.file}, {item.title}" if item.file else item.title
        yield f"{indent}{item.name}: {what}"
        yield from _lines(item.inner, f"{indent}  ")
