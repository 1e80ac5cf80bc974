"""Plots of a result, made from the file alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.results.plots.default_plots import default_plots
from vehicledyn.results.plots.figures import draw_figure
from vehicledyn.results.plots.picture_files import check_formats, save_figures
from vehicledyn.results.plots.plot_description import PathPlot, Plot, read_plots
from vehicledyn.results.store.reader import Result, open_result

__all__ = ["default_plots", "draw_described", "draw_plots", "plots_of"]

MOST_SAMPLES = 50_000
"""Samples that a figure shows; of longer runs it shows the envelope."""


def draw_plots(
    path: str | Path,
    folder: str | Path,
    names: Sequence[str] | None = None,
    formats: Sequence[str] = ("png", "svg"),
) -> list[Path]:
    """Draw the plots of a result file and return the pictures' paths.

    Parameters
    ----------
    path
        Result file; a partial one is drawn too and says so in the titles.
    folder
        Where the pictures go, one a plot and format; made if it is missing.
    names
        Names of the plots to draw; all if None.
    formats
        Of png, svg and pdf.

    Raises
    ------
    InputError
        If the file cannot be read, a name, channel or format is unknown, there is nothing
        to draw, or a picture cannot be written.
    """
    check_formats(formats)
    with open_result(path, MOST_SAMPLES) as result:
        if not len(result.time):
            raise InputError(f"{path}: holds no samples to plot ({result.state_of_run})")
        chosen = _chosen(result, names)
        return _draw_all(result, chosen, Path(folder), formats)


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


def _chosen(result: Result, names: Sequence[str] | None) -> list[Plot]:
    plots = {plot.name: plot for plot in plots_of(result)}
    for name in names or ():
        if name not in plots:
            raise InputError(f"{result.path}: {unknown_name('plot', name, plots)}")
    return [plots[name] for name in names or plots]


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
