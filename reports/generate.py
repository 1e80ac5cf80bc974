"""Write validation.md and the figures beside this file: ``python reports/generate.py``.

Everything shown is computed here and now by the modules in tests/validation/reference_cases,
which the tests use too.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from reference_cases.comparison import Comparison, Group

HERE = Path(__file__).resolve().parent
CASES = HERE.parent / "tests" / "validation"
HEAD = """# Validation

Version {version}. {count} comparisons, {failures} out of their band.

This page and its figures are generated. To make them anew, with the package installed:

    python reports/generate.py

A reference is published data, an independent program, or a second way to the same result
within this one; the source says which. Deviations far below their band are given as the decade
above them.
"""
COLUMNS = ("source", "quantity", "reference", "computed", "band", "verdict")


def main() -> int:
    """Write table and figures; return 1 if anything is out of its band."""
    sys.path.insert(0, str(CASES))
    sys.path.insert(0, str(HERE))
    import pictures
    from reference_cases.groups import GROUPS, computed

    groups = []
    for name in GROUPS:
        sys.stderr.write(f"computing {name}\n")
        groups.append(computed(name))
    pictures.draw_all(HERE / "figures")
    (HERE / "validation.md").write_text(page(groups, pictures.CAPTIONS), encoding="utf-8")
    failures = [row for group in groups for row in group.failures()]
    for row in failures:
        sys.stderr.write(f"out of its band: {row.quantity}: {row.computed}\n")
    return 1 if failures else 0


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


if __name__ == "__main__":
    raise SystemExit(main())
