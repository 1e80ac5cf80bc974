"""Figures to picture files, equal figures to equal files."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.files.whole_file import folder_for_files, whole_file
from vehicledyn.results.hdf5.output import write_failed
from vehicledyn.results.plots.plot_style import STYLE
from vehicledyn.results.plots.scales import leave_out_unbounded

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LONGEST_NAME = 100

_OTHER_PICTURES = frozenset(
    {"bmp", "emf", "eps", "gif", "jpeg", "jpg", "ps", "tif", "tiff", "webp"}
)
"""Endings of pictures that are not written, and that no folder is meant by."""

# No dates or versions: equal results give equal pictures.
METADATA: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None},
}


def save_figures(
    figures: Iterable[tuple[str, Figure | None]], folder: Path, formats: Sequence[str]
) -> list[Path]:
    """Save figures, (name, figure) pairs that are drawn on demand, in each format and one style.

    A name without figure is kept free for another process.

    Raises
    ------
    InputError
        If a format is unknown or a picture cannot be written.
    """
    import matplotlib

    check_formats(formats)
    written = []
    try:
        with folder_for_files(folder), matplotlib.rc_context(STYLE):
            taken: set[str] = set()
            for given, figure in figures:
                name = _free_name(given, taken)
                if figure is None:
                    continue
                settle(figure)
                written += [save(figure, folder / f"{name}.{kind}", kind) for kind in formats]
    except OSError as error:
        raise write_failed(folder, error) from error
    return written


def picture_kind(target: Path) -> str | None:
    """Return the format that a target is named as a picture file of, None for a folder.

    Raises
    ------
    InputError
        If the name is that of a picture in a format that is not written.

    Examples
    --------
    >>> picture_kind(Path("yaw.PNG")), picture_kind(Path("run_plots"))
    ('png', None)
    """
    kind = target.suffix[1:].lower()
    if target.is_dir() or kind not in {*METADATA, *_OTHER_PICTURES}:
        return None
    if kind in _OTHER_PICTURES:
        raise InputError(
            f"{target}: pictures are written as {', '.join(METADATA)}; "
            "name the file so, or a folder"
        )
    return kind


def save_picture(figure: Figure, target: Path, kind: str) -> Path:
    """Save one figure as a file; an InputError says why it cannot be written."""
    import matplotlib

    try:
        with folder_for_files(target.parent), matplotlib.rc_context(STYLE):
            settle(figure)
            return save(figure, target, kind)
    except OSError as error:
        raise write_failed(target, error) from error


def _free_name(name: str, taken: set[str]) -> str:
    """Return a name for a file, short and one of its own: quantities may differ in signs alone.

    >>> taken = set()
    >>> [_free_name(name, taken) for name in ("a", "b", "a")]
    ['a', 'b', 'a_2']
    """
    stem = name[:_LONGEST_NAME]
    ends = ("", *(f"_{number}" for number in range(2, len(taken) + 2)))
    found = next(stem + end for end in ends if (stem + end).casefold() not in taken)
    taken.add(found.casefold())
    return found


def check_formats(formats: Sequence[str]) -> None:
    """Raise an InputError for a format that cannot be written."""
    for kind in formats:
        if kind not in METADATA:
            raise InputError(unknown_name("picture format", kind, METADATA))


def settle(figure: Figure) -> None:
    """Lay the figure out once; rounded, as the layout is repeatable to rounding errors only."""
    engine = figure.get_layout_engine()
    if engine is None:
        return
    for axes in figure.axes:
        leave_out_unbounded(axes)
    with signs_may_be_missing():
        engine.execute(figure)
    figure.set_layout_engine(None)  # "none" leaves a stand-in, for which savefig draws twice
    for axes in figure.axes:
        left, bottom, width, height = axes.get_position(original=True).bounds
        axes.set_position((round(left, 6), round(bottom, 6), round(width, 6), round(height, 6)))


def save(figure: Figure, target: Path, kind: str) -> Path:
    """Save a figure and return where; an InputError says why it cannot be written."""
    try:
        with signs_may_be_missing(), whole_file(target) as place:
            figure.savefig(place, format=kind, metadata=METADATA[kind])
    except OSError as error:
        raise write_failed(target, error) from error
    return target


@contextlib.contextmanager
def signs_may_be_missing() -> Iterator[None]:
    """Draw signs that the font lacks, in titles of users, as boxes and without a warning."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        yield
