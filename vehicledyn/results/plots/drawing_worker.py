"""The program of a process that draws figures: one request comes in by a pipe, one reply goes out.

Its start does all that drawing needs but the result, so that the figures of a run cost the time of
their lines alone.
"""

from __future__ import annotations

import io
import json
import os
import sys
import warnings
from pathlib import Path

import matplotlib

from vehicledyn.results.plots.figures import new_figure
from vehicledyn.results.plots.picture_files import METADATA, settle
from vehicledyn.results.plots.plot_style import STYLE
from vehicledyn.results.plots.run_plots import draw_described


def main() -> None:
    """Get ready, then draw the plots of the result that the request names; reply their number."""
    _draw_small()
    request = sys.stdin.readline()
    if not request:
        return
    # The process that the user sees draws again what is warned of, and shows the warning.
    warnings.simplefilter("error", RuntimeWarning)
    path, folder = map(Path, json.loads(request))
    sys.stdout.write(f"{_draw(path, folder)}\n")
    sys.stdout.flush()


def _draw(path: Path, folder: Path) -> int:
    """Draw half of the plots, a copy of this process the other half where one can be made."""
    if sys.platform != "linux":
        return len(draw_described(path, folder))
    reader, writer = os.pipe()
    if os.fork() == 0:
        try:
            os.write(writer, str(len(draw_described(path, folder, (1, 2)))).encode())
        finally:
            os._exit(0)
    os.close(writer)
    own = len(draw_described(path, folder, (0, 2)))
    others = int(os.read(reader, 99))  # nothing to read, if the copy failed, is no number
    os.wait()
    return own + others


def _draw_small() -> None:
    """Draw a figure that nobody sees: the first one loads fonts and parts of the library."""
    with matplotlib.rc_context(STYLE):
        figure = new_figure(1.0)
        figure.subplots().plot([0.0, 1.0])
        figure.suptitle("Time [s]", fontweight="bold")
        settle(figure)
        for kind in ("png", "svg"):
            figure.savefig(io.BytesIO(), format=kind, metadata=METADATA[kind])


if __name__ == "__main__":
    main()
