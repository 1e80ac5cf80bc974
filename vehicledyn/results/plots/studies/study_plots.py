"""Figures of a study: distributions of key figures, main effects, channels of all cases.

References
----------
Saltelli et al. (2008), Global Sensitivity Analysis, Wiley, section 1.2: scatter plots and rank
correlation as measures of main effects.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from vehicledyn.results.plots.canvas import new_canvas
from vehicledyn.results.plots.plot_description import unit_factor
from vehicledyn.results.plots.plot_style import BLUE, WIDTH, plain
from vehicledyn.results.plots.scales import suitable_unit
from vehicledyn.results.plots.studies.study_curves import (
    COLUMNS,
    MOST_PANELS,
    Varied,
    draw_channels,
    draw_dependence,
    grid_of,
    label_of,
)
from vehicledyn.results.store.study_layout import DONE, ENDED, LOST
from vehicledyn.results.store.study_reader import StudyFile

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NAMES = ("dependence", "distributions", "effects", "channels")
ACCURACY_FIGURES = (
    "accuracy",
    "estimated_error",
    "recommended_step",
    "energy_drift",
    "largest_loop_gap",
    "largest_loop_speed",
)
"""Key figures that say how exact a case is; they are in the table and not drawn."""

FEWEST_FOR_BARS = 10
"""Cases from which on bars show a distribution."""

MOST_BARS = 30
_FEWEST = 3
_ROUNDING = 1e-12
_SAME = 1e-6
"""Spread, as part of the size, up to which values count as equal."""


def study_figures(file: StudyFile) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of all there is to draw of a study.

    Key figures are drawn over the quantity that was varied where it is a single one, else by
    their distributions and rank correlations; those that say how exact the cases are, are not.
    """
    status = file.case_status()
    good = np.flatnonzero(np.isin(status, (DONE, ENDED, LOST)))
    values = {n: file.figure(n)[good] for n in file.figures if n not in ACCURACY_FIGURES}
    varying = [n for n, v in values.items() if len(v) >= _FEWEST and _varies(v)][:MOST_PANELS]
    columns = {n: values[n] for n in varying}
    varied = [
        Varied(axis.name, axis.unit, column)
        for number, axis in enumerate(file.axes)
        if not axis.choices and _varies(column := file.axis(number)[good])
    ]
    if columns and len(varied) == 1 and len(file.axes) == 1:
        title = _title(file, "key figures")
        yield "dependence", draw_dependence(file, columns, varied[0], title)
    elif columns:
        if good.size >= FEWEST_FOR_BARS:
            yield "distributions", _distributions(file, columns)
        if len(varied) > 1:
            yield "effects", _effects(file, columns, {v.name: v.values for v in varied})
    if file.channels and good.size:
        yield "channels", draw_channels(file, good, varied, _title(file, ""))


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
    if not known.size:
        return False
    largest = float(np.abs(known).max())
    return bool(largest > _ROUNDING and np.ptp(known) > _SAME * largest)


def _title(file: StudyFile, what: str) -> str:
    state = "" if file.is_whole else f" ({file.state})"
    return plain(": ".join(filter(None, (file.title, what)))) + plain(state)


def _distributions(file: StudyFile, values: dict[str, Any]) -> Figure:
    from matplotlib.ticker import MaxNLocator

    figure, grid = grid_of(len(values), _title(file, "distributions of the key figures"))
    for place, (axes, (name, column)) in enumerate(zip(grid, values.items(), strict=True)):
        facts = file.figures[name]
        unit = suitable_unit(facts.unit, column)
        known = column[np.isfinite(column)] * unit_factor(facts.unit, unit)
        axes.hist(known, bins=_bins(known), color=BLUE)
        axes.locator_params(axis="x", nbins=4)
        axes.yaxis.set_major_locator(MaxNLocator(4, integer=True))
        axes.set_xlabel(label_of(name, facts.description, unit), fontsize=7.0)
        if place % COLUMNS == 0:
            axes.set_ylabel("Cases [–]")
    return figure


def _bins(values: Any) -> Any:
    """Return the edges of bars: one for each whole number where there are few, else by spread."""
    whole = np.unique(values)
    if len(whole) <= MOST_BARS and (whole == np.round(whole)).all() and np.ptp(whole) < MOST_BARS:
        return np.arange(whole[0] - 0.5, whole[-1] + 1.0)
    return len(np.histogram_bin_edges(values, bins="auto")[:MOST_BARS])


def _effects(file: StudyFile, values: dict[str, Any], axes_values: dict[str, Any]) -> Figure:
    names = list(axes_values)
    table = np.array(
        [[rank_correlation(column, axes_values[n]) for n in names] for column in values.values()]
    )
    height = 1.6 + 0.22 * len(names)
    figure = new_canvas(WIDTH, height)
    axes = figure.subplots()
    image = axes.imshow(table.T, cmap="RdBu_r", vmin=-1.0, vmax=1.0, aspect="auto")
    axes.grid(visible=False)
    axes.set_yticks(range(len(names)), [plain(n) for n in names])
    texts = [label_of(n, file.figures[n].description, "").partition(" [")[0] for n in values]
    axes.set_xticks(range(len(values)), texts, rotation=35, ha="right", fontsize=7.0)
    figure.colorbar(image, label="Rank correlation [–]")
    title = _title(file, "main effects")
    figure.suptitle(title, fontsize=10.5, fontweight="bold", x=0.01, ha="left")
    return figure
