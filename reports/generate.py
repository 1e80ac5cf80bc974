"""Write validation.md and the figures beside this file, for ``vehicledyn report --validation``.

Everything shown is computed here and now by the modules in tests/validation/reference_cases,
which the tests use too.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from reference_cases.comparison import Comparison, Group

HERE = Path(__file__).resolve().parent
CASES = HERE.parent / "tests" / "validation"
HEAD = """# Validation

Version {version}. {count} comparisons, {failures} out of their band.

This page and its figures are generated. To make them anew, in a clone of the repository:

    vehicledyn report --validation

A reference is published data, an independent program, or a second way to the same result
within this one; the source says which. Deviations far below their band are given as the decade
above them.
"""
COLUMNS = ("source", "quantity", "reference", "computed", "band", "verdict")


def compute(told: Callable[[str, float | None], None]) -> list[Group]:
    """Return all comparisons, computed now; ``told`` hears what is going on."""
    for folder in (CASES.parent, CASES, HERE):
        if str(folder) not in sys.path:
            sys.path.insert(0, str(folder))
    from reference_cases.groups import GROUPS, computed

    groups = []
    for place, name in enumerate(GROUPS):
        told(f"computing {name}", place / len(GROUPS))
        groups.append(computed(name))
    return groups


def write(groups: list[Group]) -> Path:
    """Write the table and draw the figures; return where the table is."""
    import pictures

    pictures.draw_all(HERE / "figures")
    target = HERE / "validation.md"
    target.write_text(page(groups, pictures.CAPTIONS), encoding="utf-8")
    return target


def page(groups: list[Group], captions: dict[str, str]) -> str:
    """Return the page: head, a table for each group, the figures."""
    import vehicledyn

    rows = [row for group in groups for row in group.rows]
    failures = sum(not row.passes for row in rows)
    head = HEAD.format(version=vehicledyn.__version__, count=len(rows), failures=failures)
    sections = [_section(group) for group in groups]
    pictures = [f"![{text}](figures/{name}.png)\n\n{text}\n" for name, text in captions.items()]
    return "\n".join([head, *sections, "## Figures\n", *pictures])


def table_rows(text: str) -> list[tuple[str, ...]]:
    """Return the rows of all tables of a page, without their heads, cells as texts."""
    lines = [line for line in text.splitlines() if line.startswith("|")]
    rows = [tuple(cell.strip() for cell in line.strip("|").split("|")) for line in lines]
    return [row for row in rows if row != COLUMNS and set(row[0]) != {"-"}]


def _section(group: Group) -> str:
    lines = [f"## {group.title}", "", group.note, "", _line(COLUMNS), _line(("---",) * 6)]
    lines += [_line(cells(row)) for row in group.rows]
    return "\n".join(lines) + "\n"


def cells(row: Comparison) -> tuple[str, ...]:
    """Return the cells of a comparison in the order of the columns."""
    texts = (row.source, row.quantity, row.reference, row.computed, row.band, row.verdict)
    return tuple(text.strip() for text in texts)


def _line(texts: tuple[str, ...]) -> str:
    return f"| {' | '.join(texts)} |"
