"""Writing a report: the page of a result, of two side by side, or of a folder."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from urllib.parse import quote

from vehicledyn.base.errors import InputError
from vehicledyn.results.output import write_failed
from vehicledyn.results.report.page import render

MARK = b'<meta name="generator" content="vehicledyn report'
Told = Callable[[str, float | None], None]


def write_report(
    source: Path,
    output: Path | None = None,
    *,
    against: Path | None = None,
    told: Told = lambda text, part: None,
) -> Path:
    """Write the page of a result file, or of all result files in a folder; return where it is.

    Parameters
    ----------
    source
        Result file of any kind, or a folder of them.
    output
        The page; beside the result as NAME_report.html, or report.html in the folder if None.
    against
        Another result of the same kind to show beside it.
    told
        Told what is going on and the part done.

    Raises
    ------
    InputError
        If a file cannot be read, the two are of different kinds, or the page cannot be written,
        such as over a file that is no report.
    MissingPartError
        If jinja2 is not installed.
    """
    import matplotlib

    from vehicledyn.results.plot_style import STYLE
    from vehicledyn.results.report.folder import folder_page
    from vehicledyn.results.report.single import page_of, page_of_two

    target = output or usual_place(source)
    _check(target)
    with matplotlib.rc_context(STYLE):
        if source.is_dir():
            if against is not None:
                raise InputError(f"{source}: --against compares result files, not folders")
            page = folder_page(source, target, told)
        elif against is not None:
            page = page_of_two(source, against, target, told)
        else:
            page = page_of(source, target, told)
    told("writing the page", None)
    _write(target, render(page))
    return target


def usual_place(source: Path) -> Path:
    """Return where the page of a result or a folder goes."""
    return source / "report.html" if source.is_dir() else beside(source, "report")


def beside(result: Path, what: str) -> Path:
    """Return the page of some kind that belongs to a result file."""
    return result.with_name(f"{result.stem}_{what}.html")


def address(target: Path, page: Path) -> str:
    """Return the address of a file as seen from a page, relative and quoted."""
    relative = os.path.relpath(target.resolve(), page.resolve().parent)
    return "./" + quote(relative.replace(os.sep, "/").encode("utf-8", "surrogateescape"))


def _check(target: Path) -> None:
    if target.is_dir():
        raise InputError(f"{target}: is a folder; give the name of a page in it with -o")
    if not target.parent.is_dir():
        raise InputError(f"{target}: the folder {target.parent} does not exist; create it first")
    if not os.access(target.parent, os.W_OK | os.X_OK):
        raise InputError(f"{target}: no permission to write there; choose another with -o")
    if target.exists() and not _is_report(target):
        raise InputError(
            f"{target}: exists and is no report, so it is kept; choose another with -o"
        )


def _is_report(target: Path) -> bool:
    try:
        with target.open("rb") as file:
            start = file.read(2048)
    except OSError:
        return False
    return not start or MARK in start


def _write(target: Path, text: str) -> None:
    scratch = target.with_name(f".{target.name}.new")
    try:
        scratch.write_text(text, encoding="utf-8", errors="replace")
        scratch.replace(target)
    except OSError as error:
        raise write_failed(target, error) from error
    finally:
        scratch.unlink(missing_ok=True)
