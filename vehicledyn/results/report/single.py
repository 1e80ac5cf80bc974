"""The page of one result file, and the page that compares two."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path

from vehicledyn.base.errors import InputError
from vehicledyn.results.plots.overlay import overlaid
from vehicledyn.results.plots.standard import figure_sets
from vehicledyn.results.report.content import Content, ReportFigure, key_table
from vehicledyn.results.report.differences import differences
from vehicledyn.results.report.images import picture
from vehicledyn.results.report.page import (
    Facts,
    FileLink,
    Notes,
    Page,
    Picture,
    PictureRow,
    Section,
    TextTable,
)
from vehicledyn.results.report.read_content import read_content
from vehicledyn.results.report.run_content import MOST_FIGURES, MOST_SAMPLES
from vehicledyn.results.report.texts import change

Progress = Callable[[str, float | None], None]


def page_of(path: Path, target: Path, progress: Progress) -> Page:
    """Return the page of a result file."""
    progress("reading", None)
    content = read_content(path)
    sections = list(_warnings(content.warnings()))
    sections.append(Section("What was computed", [Facts(content.facts)]))
    if content.key_figures:
        sections.append(Section("Key figures", key_table(content.key_figures)))
    pictures = []
    for name, figure in content.figures():
        progress(f"drawing {name}", None)
        pictures.append(picture(figure))
    if pictures:
        sections.append(Section("Figures", [PictureRow(pictures)]))
    return Page(
        title=content.title,
        subtitle=f"{content.what} · {path.name}",
        sections=[*sections, *content.details()],
        state=content.state,
        links=_links(path, target, "Moving picture"),
    )


def page_of_two(path: Path, other: Path, target: Path, progress: Progress) -> Page:
    """Return the page that compares a result with another of the same kind.

    Raises
    ------
    InputError
        If they are of different kinds.
    """
    progress("reading", None)
    first, second = read_content(path), read_content(other)
    if first.what != second.what:
        raise InputError(
            f"{path} is of kind '{first.what}', {other} of kind '{second.what}': "
            "only results of one kind can be compared on a page"
        )
    names = _names(path, other)
    warned = [
        f"{name}: {text}"
        for name, content in zip(names, (first, second), strict=True)
        for text in ([content.state] if content.state else []) + list(content.warnings())
    ]
    progress("comparing", None)
    sections = [
        *_warnings(warned),
        Section("What was computed", [_facts_of_two(first, second, names)]),
        Section("Key figures", [_key_figures_of_two(first, second, names)]),
        *differences(first, second, names),
        _figures_of_two(dict(zip(names, (path, other), strict=True)), progress),
    ]
    links = [*_links(path, target, names[0]), *_links(other, target, names[1])]
    return Page(
        title=f"{first.title} – compared",
        subtitle=f"{first.what} · {path.name} against {other.name}",
        sections=sections,
        state=first.state,
        links=links,
    )


def _figures_of_two(paths: Mapping[str, Path], progress: Progress) -> Section:
    pictures = list(_together(paths, progress))
    shared = [item for item, in_pair in pictures if not in_pair]
    pairs = [item for item, in_pair in pictures if in_pair]
    blocks = [PictureRow(shared)] if shared else []
    return Section("Figures", [*blocks, *([PictureRow(pairs, paired=True)] if pairs else [])])


def _links(path: Path, target: Path, text: str) -> list[FileLink]:
    """Return links to the moving picture of a result, if there is one."""
    from vehicledyn.results.report.page_places import address, beside

    animation = beside(path, "animation")
    if not animation.is_file():
        return []
    return [FileLink(address(animation, target), f"{text}: watch it move")]


def _warnings(texts: Sequence[str]) -> Iterator[Section]:
    if texts:
        yield Section("Warnings", [Notes(texts, warning=True)])


def _names(path: Path, other: Path) -> tuple[str, str]:
    if path.name != other.name:
        return path.stem, other.stem
    return f"{path.parent.name}/{path.stem}", f"{other.parent.name}/{other.stem}"


def _facts_of_two(first: Content, second: Content, names: tuple[str, str]) -> TextTable:
    left = {"Title": first.title, **dict(first.facts)}
    right = {"Title": second.title, **dict(second.facts)}
    rows = [(key, left.get(key, "–"), right.get(key, "–")) for key in left | right]
    return TextTable(("", *names), rows)


def _key_figures_of_two(first: Content, second: Content, names: tuple[str, str]) -> TextTable:
    left, right = ({f.name: f for f in content.key_figures} for content in (first, second))
    rows = []
    for name in left | right:
        a, b = left.get(name), right.get(name)
        meaning = next((f.meaning for f in (a, b) if f is not None), "")
        rows.append((meaning or name, _text(a), _text(b), _change(a, b)))
    return TextTable(("Quantity", *names, "Difference"), rows, numbers=(1, 2, 3))


def _text(figure: ReportFigure | None) -> str:
    return "–" if figure is None else figure.text


def _change(first: ReportFigure | None, second: ReportFigure | None) -> str:
    if first is None or second is None or first.unit != second.unit:
        return "–"
    return change(first.value, second.value, first.unit)


def _together(paths: Mapping[str, Path], progress: Progress) -> Iterator[tuple[Picture, bool]]:
    """Yield figures of both results over each other; in pairs, and true, where they cannot be."""
    for name, figures in islice(figure_sets(paths, most=MOST_SAMPLES), MOST_FIGURES):
        progress(f"drawing {name}", None)
        together = overlaid(figures)
        if together is not None:
            yield picture(together), False
            continue
        for label, figure in figures.items():
            yield picture(figure, caption=label), True
