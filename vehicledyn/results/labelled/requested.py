"""Figures that a user asks for by name: standard ones, or any arrays by shell patterns."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib

from vehicledyn.base.errors import InputError
from vehicledyn.results.labelled.figure import draw_data, draw_standard
from vehicledyn.results.labelled.labels import LabelledSet
from vehicledyn.results.plots.picture_files import (
    check_formats,
    picture_kind,
    save_figures,
    save_picture,
)
from vehicledyn.results.plots.plot_style import STYLE
from vehicledyn.results.plots.standard import figure_names, overlaid_figures
from vehicledyn.results.store.near_names import unknown_array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_FORMATS = ("png", "svg")
"""Formats of pictures where none is asked for."""

_MOST_NAMES = 12
"""Names of figures in a message."""

_LONGEST = 80
"""Letters of a file's name."""


def draw_requested(
    data: Mapping[str, LabelledSet], patterns: Sequence[str], against: str | None
) -> Figure:
    """Return the one figure of standard figures or arrays by name, of results by label.

    Raises
    ------
    InputError
        If a name is unknown, or something cannot be drawn.
    """
    if not patterns and against is None:
        return draw_standard(data)
    first = next(iter(data.values()))
    named, others = _sorted(first, patterns)
    if len(named) == 1 and not others and against is None:
        return draw_standard(data, named[0])
    if named:
        raise InputError(f"'{named[0]}' is a standard figure; draw it by itself")
    return draw_data(data, patterns, against)


def save_requested(
    data: Mapping[str, LabelledSet],
    target: Path,
    *,
    patterns: Sequence[str] = (),
    against: str | None = None,
    formats: Sequence[str] = _FORMATS,
) -> list[Path]:
    """Draw what was asked for of results by label into picture files; return their paths.

    Without patterns all standard figures are drawn. Names of standard figures are drawn as these,
    all other patterns together in one figure of arrays. The target is a folder, or a file where it
    is named as a picture and one figure is drawn.

    Raises
    ------
    InputError
        If a name is unknown, there is nothing to draw, or a picture cannot be written.
    """
    check_formats(formats)
    with matplotlib.rc_context(STYLE):
        figures = list(_figures(data, patterns, against))
    return _saved(figures, next(iter(data.values())).path, target, formats)


def save_standard(
    paths: Mapping[str, Path], target: Path, *, formats: Sequence[str] = _FORMATS
) -> list[Path]:
    """Draw all standard figures of results by label into picture files; return their paths.

    The target is a folder, or a file where it is named as a picture and there is one figure.

    Raises
    ------
    InputError
        If a result is damaged, there is nothing to draw, or a picture cannot be written.
    """
    check_formats(formats)
    with matplotlib.rc_context(STYLE):
        figures = list(overlaid_figures(paths))
    return _saved(figures, next(iter(paths.values())), target, formats)


def _saved(
    figures: list[tuple[str, Figure]], first: Path, target: Path, formats: Sequence[str]
) -> list[Path]:
    """Save figures in a folder, or the only one in a file where the target is named as a picture.

    Raises
    ------
    InputError
        If there is no figure, or there are several for one file.
    """
    if not figures:
        raise InputError(f"{first}: holds nothing to draw")
    kind = picture_kind(target)
    if kind is None:
        return save_figures(figures, target, formats)
    if len(figures) > 1:
        names = ", ".join(name for name, _ in figures[:_MOST_NAMES])
        more = ", ..." if len(figures) > _MOST_NAMES else ""
        raise InputError(
            f"{target}: one file, and {len(figures)} figures to draw ({names}{more}); "
            "name a folder, or ask for one figure by its name"
        )
    if kind not in formats and set(formats) != set(_FORMATS):
        raise InputError(f"{target}: is to be written as {' and '.join(formats)}; name it so")
    return [save_picture(figures[0][1], target, kind)]


def _figures(
    data: Mapping[str, LabelledSet], patterns: Sequence[str], against: str | None
) -> Iterator[tuple[str, Figure]]:
    paths = {label: one.path for label, one in data.items()}
    if not patterns:
        if against is not None:
            raise InputError(f"against '{against}': name the channels to draw, too")
        yield from overlaid_figures(paths)
        return
    named, others = _sorted(next(iter(data.values())), patterns)
    if named:
        yield from overlaid_figures(paths, named)
    if others:
        yield _file_name(others, against), draw_data(data, others, against)


def _sorted(first: LabelledSet, patterns: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return patterns that name standard figures, and those that match arrays.

    Raises
    ------
    InputError
        For one that does neither.
    """
    arrays = list(first)
    others = [p for p in patterns if any(fnmatchcase(name, p) for name in arrays)]
    rest = [p for p in patterns if p not in others]
    figures = figure_names(first.path) if rest else []
    for pattern in rest:
        if pattern not in figures:
            raise InputError(f"{first.path}: {unknown_array(pattern, arrays, figures)}")
    return rest, others


def _file_name(patterns: Sequence[str], against: str | None) -> str:
    """Return a name that a file can have: the patterns, wildcards as "all"."""
    text = "_and_".join(pattern.replace("*", "all") for pattern in patterns)
    if against is not None:
        text += f"_against_{against}"
    return re.sub(r"[^A-Za-z0-9._-]+", "_", text)[:_LONGEST].strip("._") or "channels"
