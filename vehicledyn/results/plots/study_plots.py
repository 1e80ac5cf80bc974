"""Figures of a study: distributions of key figures, main effects, channels of all cases.

References
----------
Saltelli et al. (2008), Global Sensitivity Analysis, Wiley, section 1.2: scatter plots and rank
correlation as measures of main effects.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.units import parse_unit
from vehicledyn.results.plots.picture_files import check_formats, save_figures
from vehicledyn.results.plots.plot_style import BLUE, STYLE, VERMILION, WIDTH, axis_label, plain
from vehicledyn.results.store.study_layout import DONE, ENDED
from vehicledyn.results.store.study_reader import StudyFile, open_study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NAMES = ("distributions", "effects", "channels")
MOST_PANELS = 12
MOST_CASES = 500
"""Cases whose samples are read for the bands of the channels."""

MOST_VALUES = 10_000_000
"""Samples that are read for them; of more only every so many-th."""

_FEWEST = 3
_ROUNDING = 1e-12
_COLUMNS = 3
_ROW = 1.7  # inch
_BAND = (5.0, 50.0, 95.0)
_SHOWN_IN = {"rad": "deg", "rad/s": "deg/s", "m": "m"}


def draw_study(
    path: Path, folder: Path, names: Sequence[str] | None, formats: Sequence[str]
) -> list[Path]:
    """Draw the figures of a study, all or those of some names; return where they are.

    Raises
    ------
    InputError
        If the file cannot be read, a name is unknown, there is nothing to draw or a picture
        cannot be written.
    """
    import matplotlib

    check_formats(formats)
    for name in names or ():
        if name not in NAMES:
            raise InputError(f"{path}: {unknown_name('figure', name, NAMES)}")
    with open_study(path) as file, matplotlib.rc_context(STYLE):
        figures = [(n, f) for n, f in study_figures(file) if names is None or n in names]
    if not figures:
        raise InputError(f"{path}: holds nothing to draw yet ({file.state})")
    return save_figures(figures, folder, formats)


def study_figures(file: StudyFile) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of all there is to draw of a study."""
    status = file.case_status()
    good = np.flatnonzero((status == DONE) | (status == ENDED))
    values = {name: file.figure(name)[good] for name in file.figures}
    varying = [n for n, v in values.items() if len(v) >= _FEWEST and _varies(v)][:MOST_PANELS]
    if varying:
        yield "distributions", _distributions(file, {n: values[n] for n in varying})
        axes = {
            axis.name: column
            for number, axis in enumerate(file.axes)
            if not axis.choices and _varies(column := file.axis(number)[good])
        }
        if axes:
            yield "effects", _effects(file, {n: values[n] for n in varying}, axes)
    if file.channels and good.size:
        yield "channels", _channels(file, good)


def rank_correlation(first: Any, second: Any) -> float:
    """Return Spearman's rank correlation of two samples, pairs that are not numbers left out."""
    both = np.isfinite(first) & np.isfinite(second)
    if both.sum() < _FEWEST or not (_varies(first[both]) and _varies(second[both])):
        return 0.0
    return float(np.corrcoef(_ranks(first[both]), _ranks(second[both]))[0, 1])


def _ranks(values: Any) -> Any:
    """Return the ranks, ties sharing their mean."""
    _, places, counts = np.unique(values, return_inverse=True, return_counts=True)
    ends = np.cumsum(counts)
    return (ends - 0.5 * (counts - 1))[places]


def _varies(values: Any) -> bool:
    """Return whether values differ by more than rounding makes of zero."""
    known = values[np.isfinite(values)]
    return bool(known.size and known.max() > known.min() and np.abs(known).max() > _ROUNDING)


def _grid(count: int, title: str, *, share_x: bool = False) -> tuple[Figure, list[Any]]:
    from matplotlib.figure import Figure

    rows = -(-count // _COLUMNS)
    figure = Figure(figsize=(WIDTH, 0.5 + _ROW * rows), layout="constrained")
    grid = figure.subplots(rows, min(count, _COLUMNS), squeeze=False, sharex=share_x).ravel()
    for axes in grid[count:]:
        axes.set_visible(False)
    figure.suptitle(title, fontsize=9.0)
    return figure, list(grid[:count])


def _title(file: StudyFile, what: str) -> str:
    state = "" if file.is_whole else f" ({file.state})"
    return f"{plain(file.title)}: {what}{plain(state)}"


def _distributions(file: StudyFile, values: dict[str, Any]) -> Figure:
    figure, grid = _grid(len(values), _title(file, "distributions of the key figures"))
    for axes, (name, column) in zip(grid, values.items(), strict=True):
        factor, unit = _scale(file.figures[name].unit)
        known = column[np.isfinite(column)] * factor
        axes.hist(known, bins=min(30, max(5, int(np.sqrt(known.size)))), color=BLUE)
        axes.locator_params(axis="x", nbins=4)
        axes.set_xlabel(axis_label(_words(name), unit))
        axes.set_ylabel("Cases [–]")
    return figure


def _effects(file: StudyFile, values: dict[str, Any], axes_values: dict[str, Any]) -> Figure:
    from matplotlib.figure import Figure

    names = list(axes_values)
    table = np.array(
        [[rank_correlation(column, axes_values[n]) for n in names] for column in values.values()]
    )
    height = 1.6 + 0.22 * len(names)
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    axes = figure.subplots()
    image = axes.imshow(table.T, cmap="RdBu_r", vmin=-1.0, vmax=1.0, aspect="auto")
    axes.grid(visible=False)
    axes.set_yticks(range(len(names)), [plain(n) for n in names])
    axes.set_xticks(range(len(values)), [_words(n) for n in values], rotation=35, ha="right")
    figure.colorbar(image, label="Rank correlation [–]")
    figure.suptitle(_title(file, "main effects"), fontsize=9.0)
    return figure


def _channels(file: StudyFile, good: Any) -> Figure:
    step = max(1, -(-len(good) // MOST_CASES))
    chosen = good[::step]
    channels = file.channels[:MOST_PANELS]
    every = max(1, -(-len(chosen) * len(file.times) * len(channels) // MOST_VALUES))
    what = f"{_BAND[1]:g} % and {_BAND[0]:g}–{_BAND[2]:g} % of {len(chosen)} cases"
    figure, grid = _grid(len(channels), _title(file, what), share_x=True)
    samples = np.stack([file.samples(int(case), every, len(channels)) for case in chosen])
    for number, (axes, channel) in enumerate(zip(grid, channels, strict=True)):
        factor, unit = _scale(channel.unit)
        values = samples[:, :, number] * factor
        reached = np.isfinite(values).any(axis=0)
        low, middle, high = np.nanpercentile(values[:, reached], _BAND, axis=0)
        times = file.times[::every][reached]
        axes.fill_between(times, low, high, color=BLUE, alpha=0.25, linewidth=0.0)
        axes.plot(times, middle, color=VERMILION)
        axes.set_ylabel(axis_label(channel.name, unit), fontsize=7.0)
    for axes in grid[-_COLUMNS:]:
        axes.set_xlabel("Time [s]")
    return figure


def _scale(unit: str) -> tuple[float, str]:
    wanted = _SHOWN_IN.get(unit, unit)
    return parse_unit(unit).factor / parse_unit(wanted).factor, wanted


def _words(name: str) -> str:
    return plain(name.replace("_", " ").capitalize())
