"""Films of an animation, drawn without a browser."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from subprocess import CalledProcessError

import numpy as np

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError, MissingPartError
from vehicledyn.base.files.whole_file import whole_file
from vehicledyn.results.animation.scene import AnimatedScene
from vehicledyn.results.animation.still import RESOLUTION, figure_of, paint
from vehicledyn.results.hdf5.output import write_failed
from vehicledyn.results.plots.plot_style import STYLE

FILMS = (".gif", ".mp4")
MOST_PICTURES = 20_000


def draw_film(
    scene: AnimatedScene,
    target: Path,
    *,
    view: str,
    rate: int,
    speed: float,
    progress: Callable[[str, float | None], None],
) -> int:
    """Draw a scene into a GIF or MP4 film and return the number of its pictures.

    Parameters
    ----------
    scene
        What is drawn.
    target
        File that ends with .gif or .mp4.
    view
        Where the camera is, see ``VIEWS``.
    rate
        Pictures a second.
    speed
        Seconds of the result a second.
    progress
        Called with the part done.

    Raises
    ------
    MissingPartError
        If the tool that writes such films is absent.
    InputError
        If the ending is unknown or the film cannot be written.
    """
    import matplotlib as mpl
    from matplotlib import animation

    ending = target.suffix.lower()
    if ending not in FILMS:
        raise InputError(f"{target}: a film ends with .gif or .mp4")
    name = "pillow" if ending == ".gif" else "ffmpeg"
    if not animation.writers.is_available(name):
        raise MissingPartError(
            f"{target}: writing it needs {name}, which is not here; install it, or write "
            f"{'.mp4' if ending == '.gif' else '.gif'} or the page"
        )
    begin, end = float(scene.time[0]), float(scene.time[-1])
    count = (end - begin) * rate / speed
    if not count <= MOST_PICTURES:
        raise InputError(
            f"{target}: a film of {count:.3g} pictures is too long, {MOST_PICTURES} at most; "
            f"show a part of it, or give a higher {argument('speed')}"
        )
    times = np.arange(begin, end + 1e-9, speed / rate)
    writer = animation.writers[name](fps=rate)
    try:
        with mpl.rc_context(STYLE), whole_file(target) as partial:
            figure = figure_of(scene, begin, view)
            with writer.saving(figure, str(partial), dpi=RESOLUTION / 2):
                for number, time in enumerate(times):
                    progress("drawing the film", number / len(times))
                    paint(figure, scene, float(time), view)
                    writer.grab_frame()
    except CalledProcessError as error:
        raise write_failed(target, OSError(f"{name} failed")) from error
    except OSError as error:
        raise write_failed(target, error) from error
    return len(times)
