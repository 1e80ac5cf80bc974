"""Plots of a result, made from the file alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.results.default_plots import default_plots
from vehicledyn.results.figures import draw_figure
from vehicledyn.results.output import write_failed
from vehicledyn.results.plot_description import Plot, read_plots
from vehicledyn.results.plot_style import STYLE
from vehicledyn.results.reader import Result, open_result

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["default_plots", "draw_plots", "plots_of"]

# No dates or versions: equal results give equal pictures.
METADATA: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None},
}


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
    for kind in formats:
        if kind not in METADATA:
            raise InputError(unknown_name("picture format", kind, METADATA))
    with open_result(path) as result:
        if not len(result.time):
            raise InputError(f"{path}: holds no samples to plot ({result.state_of_run})")
        chosen = _chosen(result, names)
        return _draw_all(result, chosen, _made(Path(folder)), formats)


def plots_of(result: Result) -> tuple[Plot, ...]:
    """Return the plots a file describes, or plots of all its channels if it describes none."""
    return read_plots(result.plots) or default_plots(result)


def _chosen(result: Result, names: Sequence[str] | None) -> list[Plot]:
    plots = {plot.name: plot for plot in plots_of(result)}
    for name in names or ():
        if name not in plots:
            raise InputError(f"{result.path}: {unknown_name('plot', name, plots)}")
    return [plots[name] for name in names or plots]


def _draw_all(
    result: Result, plots: Sequence[Plot], folder: Path, formats: Sequence[str]
) -> list[Path]:
    import matplotlib

    written = []
    with matplotlib.rc_context(STYLE):
        for plot in plots:
            figure = draw_figure(result, plot)
            _settle(figure)
            for kind in formats:
                written.append(_save(figure, folder / f"{plot.name}.{kind}", kind))
    return written


def _settle(figure: Figure) -> None:
    """Lay the figure out once; rounded, as the layout is repeatable to rounding errors only."""
    engine = figure.get_layout_engine()
    if engine is None:
        return
    engine.execute(figure)
    figure.set_layout_engine("none")
    for axes in figure.axes:
        left, bottom, width, height = axes.get_position(original=True).bounds
        axes.set_position((round(left, 6), round(bottom, 6), round(width, 6), round(height, 6)))


def _save(figure: Figure, target: Path, kind: str) -> Path:
    try:
        figure.savefig(target, format=kind, metadata=METADATA[kind])
    except OSError as error:
        raise write_failed(target, error) from error
    return target


def _made(folder: Path) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise write_failed(folder, error) from error
    return folder
