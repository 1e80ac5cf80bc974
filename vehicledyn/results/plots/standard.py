"""The standard figures of any result file, of one or of several results over each other."""

from __future__ import annotations

import logging
import re
from collections.abc import Collection, Iterator, Mapping
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from vehicledyn.base.errors import InputError
from vehicledyn.results.plots.arrangement import arranged
from vehicledyn.results.plots.overlay import overlaid
from vehicledyn.results.plots.plot_description import Plot, TimePlot
from vehicledyn.results.plots.run_plots import MOST_SAMPLES, plots_of
from vehicledyn.results.plots.studies.study_plots import NAMES, study_figures
from vehicledyn.results.plots.table_results import holds_table, table_figures
from vehicledyn.results.store.linear_file import format_of
from vehicledyn.results.store.reader import ENDS, Result, open_result
from vehicledyn.results.store.study_reader import is_study_file, open_study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LOG = logging.getLogger(__name__)


def standard_figures(
    path: Path, names: Collection[str] | None = None
) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of what is usually drawn of a result, all or some names of it.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    from vehicledyn.results.plots.figures import draw_figure

    if is_study_file(path):
        with open_study(path) as study:
            yield from _chosen(study_figures(study), names)
    elif holds_table(path):
        yield from _chosen(table_figures(path), names)
    else:
        with open_result(path, MOST_SAMPLES) as result:
            for plot in plots_of(result) if len(result.time) else ():
                if names is None or plot.name in names:
                    yield plot.name, draw_figure(result, plot)


def figure_names(path: Path) -> list[str]:
    """Return the names of the standard figures of a result.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    if is_study_file(path):
        return list(NAMES)
    if holds_table(path):
        return [name for name, _ in table_figures(path)]
    with open_result(path, ENDS) as result:
        return [plot.name for plot in plots_of(result)]


def overlaid_figures(
    results: Mapping[str, Path], names: Collection[str] | None = None
) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of the standard figures, those of several results over each other.

    Figures that cannot share their axes follow one after the other, named after their results.

    Raises
    ------
    InputError
        If a file cannot be read or the results are of different kinds.
    """
    for name, figures in figure_sets(results, names):
        together = overlaid(figures)
        if together is not None:
            yield name, together
        else:
            yield from ((_file_name(name, label), figure) for label, figure in figures.items())


def _file_name(name: str, label: str) -> str:
    return f"{name}_{re.sub(r'[^A-Za-z0-9._-]+', '_', label).strip('_')}"


def figure_sets(
    results: Mapping[str, Path], names: Collection[str] | None = None, most: int = MOST_SAMPLES
) -> Iterator[tuple[str, dict[str, Figure]]]:
    """Yield the name of each standard figure and the figures of all results that have it, by label.

    Panels and their channels are those of the first result, so that the axes are the same. A
    figure that nobody named and that cannot be drawn is left out with a warning.

    Parameters
    ----------
    results
        Files by label, all of one kind.
    names
        Names of figures, all if None.
    most
        Samples of a run to draw, of more the envelope.

    Raises
    ------
    InputError
        If a file cannot be read or the results are of different kinds.
    """
    kinds = {path: "study" if is_study_file(path) else format_of(path) for path in results.values()}
    if len(set(kinds.values())) > 1:
        listed = " and ".join(str(path) for path in results.values())
        raise InputError(f"{listed}: results of different kinds cannot share a figure")
    first = next(iter(results.values()))
    if is_study_file(first) or holds_table(first):
        found = {label: dict(standard_figures(path, names)) for label, path in results.items()}
        for name in next(iter(found.values())):
            yield name, {label: each[name] for label, each in found.items() if name in each}
        return
    with ExitStack() as stack:
        opened = {k: stack.enter_context(open_result(p, most)) for k, p in results.items()}
        yield from _run_sets({k: r for k, r in opened.items() if len(r.time)}, names)


def _run_sets(
    results: Mapping[str, Result], names: Collection[str] | None
) -> Iterator[tuple[str, dict[str, Figure]]]:
    from vehicledyn.results.plots.figures import draw_figure

    if not results:
        return
    first = next(iter(results.values()))
    for described in plots_of(first):
        if names is not None and described.name not in names:
            continue
        plot = described
        if isinstance(described, TimePlot) and described.arranged:
            plot = replace(arranged(first, described), arranged=False, named=True)
        holding = {label: r for label, r in results.items() if r is first or _has_channels(r, plot)}
        beside = tuple(holding.values())
        try:
            yield plot.name, {k: draw_figure(r, plot, beside=beside) for k, r in holding.items()}
        except (InputError, ArithmeticError, ValueError) as error:
            if names is not None or len(results) == 1:
                raise
            _LOG.warning("%s: figure '%s' cannot be drawn: %s", first.path, plot.name, error)


def _has_channels(result: Result, plot: Plot) -> bool:
    known = set(result.channels)
    if isinstance(plot, TimePlot):
        needed = {channel for panel in plot.panels for channel in panel.channels}
        return (needed | ({plot.x} if plot.x else set())) <= known
    return {plot.x, plot.y, *([plot.heading] if plot.heading else [])} <= known


def _chosen(
    figures: Iterator[tuple[str, Figure]], names: Collection[str] | None
) -> Iterator[tuple[str, Figure]]:
    return ((name, figure) for name, figure in figures if names is None or name in names)
