"""What a shell completes beside verbs, options and files: models, channels, figures.

Nothing is derived for it; what cannot be found at once is not completed.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vehicledyn.base.errors import VehicledynError
from vehicledyn.library import names_of

if TYPE_CHECKING:
    from vehicledyn.results.store.reader import Result

MOST = 500


def model_names(incomplete: str) -> list[str]:
    """Return the names of models that begin so; of none, the shell completes files."""
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.files.scenario import known_models

    return [name for name in known_models() if name.startswith(incomplete)]


def scenario_names(incomplete: str) -> list[str]:
    """Return the names of scenarios of the library that begin so."""
    return [name for name in names_of("scenario") if name.startswith(incomplete)]


def example_names(incomplete: str) -> list[str]:
    """Return the names of files of the library that begin so."""
    known = names_of("scenario", "study", "system", "profile")
    return [name for name in known if name.startswith(incomplete)]


def channel_names(ctx: Any, incomplete: str) -> list[str]:
    """Return the channels of the last result named before that begin so."""
    with _last_result(ctx) as result:
        known = () if result is None else result.channels
        return [name for name in known if name.startswith(incomplete)][:MOST]


def figure_names(ctx: Any, incomplete: str) -> list[str]:
    """Return the figures that the last result named before describes and that begin so."""
    with _last_result(ctx) as result:
        plots = [] if result is None else result.plots
        names = [str(plot.get("name", "")) for plot in plots]
    return [name for name in names if name.startswith(incomplete)]


@contextmanager
def _last_result(ctx: Any) -> Iterator[Result | None]:
    """Give the last result file of an unfinished command, None if there is none to read."""
    from vehicledyn.results.store.reader import open_result

    # An option without its value leaves the files before it among the arguments not yet taken.
    given = [*reversed(ctx.args), ctx.params.get("reference"), ctx.params.get("result")]
    named = [str(text) for text in given if text and Path(str(text)).is_file()]
    try:
        result = open_result(named[0], most=2) if named else None
    except VehicledynError:
        result = None
    if result is None:
        yield None
        return
    with result:
        yield result
