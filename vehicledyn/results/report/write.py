"""Writing a report: the page of a result, of two compared, or of a folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError
from vehicledyn.results.hdf5.page_file import check_page, write_page
from vehicledyn.results.report.page import render
from vehicledyn.results.report.page_places import beside

Progress = Callable[[str, float | None], None]


def write_report(
    source: Path,
    output: Path | None = None,
    *,
    against: Path | None = None,
    progress: Progress = lambda text, part: None,
) -> Path:
    """Write the page of a result file, or of all result files in a folder; return where it is.

    Parameters
    ----------
    source
        Result file of any kind, or a folder of them.
    output
        The page; beside the result as NAME_report.html, or report.html in the folder if None.
    against
        Another result of the same kind to compare it with.
    progress
        Called with what is going on and the part done.

    Raises
    ------
    InputError
        If a file cannot be read, the two are of different kinds, or the page cannot be written,
        such as over a file that is no report.
    MissingPartError
        If jinja2 is not installed.
    """
    import matplotlib

    from vehicledyn.results.plots.plot_style import STYLE
    from vehicledyn.results.report.folder import folder_page
    from vehicledyn.results.report.single import page_of, page_of_two

    target = output or usual_place(source)
    check_page(target, "report")
    with matplotlib.rc_context(STYLE):
        if source.is_dir():
            if against is not None:
                raise InputError(
                    f"{source}: {argument('against')} compares result files, not folders"
                )
            page = folder_page(source, target, progress)
        elif against is not None:
            page = page_of_two(source, against, target, progress)
        else:
            page = page_of(source, target, progress)
    progress("writing the page", None)
    write_page(target, render(page))
    return target


def usual_place(source: Path) -> Path:
    """Return where the page of a result or a folder goes."""
    return source / "report.html" if source.is_dir() else beside(source, "report")
