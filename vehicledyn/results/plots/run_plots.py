"""Plots of a result, made from the file alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from vehicledyn.results.plots.default_plots import default_plots
from vehicledyn.results.plots.figures import draw_figure
from vehicledyn.results.plots.picture_files import save_figures
from vehicledyn.results.plots.plot_description import PathPlot, Plot, read_plots
from vehicledyn.results.store.reader import Result, open_result

__all__ = ["default_plots", "draw_described", "plots_of"]

MOST_SAMPLES = 50_000
"""Samples that a figure shows; of longer runs it shows the envelope."""


def draw_described(path: Path, folder: Path, share: tuple[int, int] = (0, 1)) -> list[Path]:
    """Draw the plots that a result file describes; none if it has fewer than two samples.

    Parameters
    ----------
    path, folder
        Result file, and where the pictures go.
    share
        Which of how many shares to draw, where several processes divide the plots.
    """
    with open_result(path, MOST_SAMPLES) as result:
        found = read_plots(result.plots, result.path) if len(result.time) > 1 else ()
        return _draw_all(result, found, folder, ("png", "svg"), share) if found else []


def plots_of(result: Result) -> tuple[Plot, ...]:
    """Return the plots a file describes, or plots of all its channels if it describes none."""
    return read_plots(result.plots, result.path) or default_plots(result)


def _draw_all(
    result: Result,
    plots: Sequence[Plot],
    folder: Path,
    formats: Sequence[str],
    share: tuple[int, int] = (0, 1),
) -> list[Path]:
    owners = _divided(plots, share[1])
    figures = (
        (plot.name, draw_figure(result, plot) if owner == share[0] else None)
        for plot, owner in zip(plots, owners, strict=True)
    )
    return save_figures(figures, folder, formats)


def _divided(plots: Sequence[Plot], number: int) -> list[int]:
    """Return which of so many equal shares each plot is in; a path takes as long as three others.

    >>> _divided(["yaw", "roll", "load"], 2)
    [0, 1, 0]
    """
    loads, owners = [0] * number, []
    for plot in plots:
        owner = loads.index(min(loads))
        loads[owner] += 3 if isinstance(plot, PathPlot) else 1
        owners.append(owner)
    return owners
