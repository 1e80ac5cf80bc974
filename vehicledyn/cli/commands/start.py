"""The verb "init": files to begin with."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from vehicledyn.cli.options import Quiet
from vehicledyn.cli.terminal import emit, tell


class Start(StrEnum):
    """What one begins with."""

    ROAD = "road"
    MECHANISM = "mechanism"
    WHEELSET = "wheelset"


def add_verbs(app: typer.Typer) -> None:
    """Add the verb of this module to the command line."""
    app.command()(init)


def init(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="Folder to write to; created if missing.")
    ] = Path(),
    *,
    kind: Annotated[Start, typer.Option(help="What to start with.")] = Start.ROAD,
    quiet: Quiet = False,
) -> None:
    """Write a starter model and scenario, with schemas for editors; never overwrites."""
    import vehicledyn.catalogue  # noqa: F401
    from vehicledyn.analyses.models.start_files import write_start

    written = write_start(folder, kind.value)
    for path in written:
        emit(str(path))
    if not quiet:
        tell(f"Next: vehicledyn run {written[1]}")
