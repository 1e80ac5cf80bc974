"""The standard figures of any result file, one after the other."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from vehicledyn.results.plots.linear_results import is_linear, linear_figures
from vehicledyn.results.plots.run_plots import plots_of
from vehicledyn.results.plots.study_plots import study_figures
from vehicledyn.results.store.reader import open_result
from vehicledyn.results.store.study_reader import is_study_file, open_study

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def standard_figures(path: Path) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of all that is usually drawn of a result.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    from vehicledyn.results.plots.figures import draw_figure

    if is_study_file(path):
        with open_study(path) as study:
            yield from study_figures(study)
    elif is_linear(path):
        yield from linear_figures(path)
    else:
        with open_result(path) as result:
            for plot in plots_of(result) if len(result.time) else ():
                yield plot.name, draw_figure(result, plot)
