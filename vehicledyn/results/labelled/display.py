"""How a result shows itself: as text, and as a table in a notebook."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from vehicledyn.base.units import shown
from vehicledyn.results.labelled.labels import LabelledSet

MOST_TEXT, MOST_HTML = 12, 60
"""Arrays that are listed as text and in a notebook."""


def as_text(data: LabelledSet) -> str:
    """Return what a result is and holds, in some lines."""
    rows = list(_arrays(data, MOST_TEXT))
    width = max((len(row[0]) for row in rows), default=0)
    lines = [_heading(data)]
    lines += [f"  {name} = {text}  {words}".rstrip() for name, text, words in _summary(data)]
    lines += [
        f"  {name:{width}}  {size}  {unit}  {words}".rstrip() for name, size, unit, words in rows
    ]
    hidden = len(data) - len(rows)
    return "\n".join([*lines, *([f"  ... and {hidden} more arrays"] if hidden > 0 else [])])


def as_html(data: LabelledSet) -> str:
    """Return a heading, the key figures and the arrays as tables."""
    figures = "".join(
        f"<tr><td>{escape(name)}</td><td>{escape(text)}</td><td>{escape(words)}</td></tr>"
        for name, text, words in _summary(data)
    )
    rows = "".join(
        "<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>"
        for row in _arrays(data, MOST_HTML)
    )
    hidden = len(data) - MOST_HTML
    more = f"<p>... and {hidden} more arrays</p>" if hidden > 0 else ""
    head = "<tr><th>array</th><th>size</th><th>unit</th><th>meaning</th></tr>"
    summary = f"<table>{figures}</table>" if figures else ""
    return (
        f"<b>{escape(_heading(data))}</b>{summary}<details open><summary>{len(data)} arrays"
        f"</summary><table>{head}{rows}</table>{more}</details>"
    )


def _heading(data: LabelledSet) -> str:
    model = f" of {data.model}" if data.model else ""
    state = data.status if not data.status_message else f"{data.status}: {data.status_message}"
    return f"{data.kind}{model}: {data.title} ({state})"


def _summary(data: LabelledSet) -> Iterator[tuple[str, str, str]]:
    for name, entry in data.summary.items():
        yield name, shown(entry.value, entry.unit), entry.description


def _arrays(data: LabelledSet, most: int) -> Iterator[tuple[str, str, str, str]]:
    """Yield name, size, unit and meaning of the first arrays."""
    for name in list(data)[:most]:
        array = data[name]
        yield name, array.size_in_words, array.unit, array.description
