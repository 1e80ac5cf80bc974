"""The page of a folder: every result in it with its key figures, unusable ones with the reason."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from vehicledyn.base.errors import InputError
from vehicledyn.results.report.content import Content, key_table
from vehicledyn.results.report.images import picture
from vehicledyn.results.report.page import (
    Block,
    Facts,
    FileLink,
    Notes,
    Page,
    PictureRow,
    Section,
    TextTable,
)
from vehicledyn.results.report.read_content import read_content

Progress = Callable[[str, float | None], None]

SUFFIXES = (".h5", ".hdf5", ".nc")
MOST_FILES = 500
MOST_PICTURES = 60
MOST_KEY_FIGURES = 8


def folder_page(folder: Path, target: Path, progress: Progress) -> Page:
    """Return the page of a folder and its subfolders.

    Raises
    ------
    InputError
        If there is no result file in it.
    """
    paths = results_in(folder)
    if not paths:
        raise InputError(f"{folder}: holds no result files ({', '.join(SUFFIXES)})")
    sections, index, unusable = [], [], []
    for place, path in enumerate(paths[:MOST_FILES]):
        name = path.relative_to(folder).as_posix()
        progress(f"reading {name}", place / len(paths))
        try:
            content = read_content(path)
            blocks = list(_blocks(content, target, drawn=place < MOST_PICTURES))
        except InputError as error:
            unusable.append((name, str(error).removeprefix(f"{path}: ")))
            continue
        state = content.state or "complete"
        index.append((name, content.what, content.title, state))
        sections.append(Section(name, blocks))
    blocks = [TextTable(("File", "Kind", "Title", "State"), index)] if index else []
    top = [Section("Results", blocks)] if blocks else []
    if unusable:
        top.insert(0, Section("Unusable files", [TextTable(("File", "Why"), unusable)]))
    if len(paths) > MOST_FILES:
        text = f"Only the first {MOST_FILES} of {len(paths)} files are shown."
        top.insert(0, Section("Warnings", [Notes([text], warning=True)]))
    return Page(
        title=f"Results in {folder.resolve().name or folder}",
        subtitle=f"{len(index)} results, {len(unusable)} unusable files",
        sections=[*top, *sections],
    )


def results_in(folder: Path) -> list[Path]:
    """Return the result files in a folder and its subfolders, hidden ones left out."""
    found = (path for suffix in SUFFIXES for path in folder.rglob(f"*{suffix}"))
    seen = [
        path
        for path in found
        if path.is_file() and not any(p.startswith(".") for p in path.relative_to(folder).parts)
    ]
    return sorted(seen)


def _blocks(content: Content, target: Path, *, drawn: bool) -> Iterator[Block]:
    from vehicledyn.results.report.page_places import address, beside

    for what, text in (("report", "Open its report"), ("animation", "Watch it move")):
        page = beside(content.path, what)
        if page.is_file() and page.resolve() != target.resolve():
            yield FileLink(address(page, target), text)
    if content.state:
        yield Notes([content.state], warning=True)
    yield Facts([("Title", content.title), *content.facts])
    yield from key_table(content.key_figures[:MOST_KEY_FIGURES])
    figure = next(iter(content.figures()), None) if drawn else None
    if figure is not None:
        yield PictureRow([picture(figure[1], dots=True)])
