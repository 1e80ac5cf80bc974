"""What a shell completes beside verbs, options and files: models, channels, figures.

Nothing is derived for it; what cannot be found at once is not completed.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vehicledyn.base.errors import VehicledynError

if TYPE_CHECKING:
    from vehicledyn.results.store.reader import Result

MOST = 500


def model_names(incomplete: str) -> list[str]:
    """Return the names of models that begin so; of none, the shell completes files."""
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.base.registry import kinds

    return [name for name in kinds("model") if name.startswith(incomplete)]


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
