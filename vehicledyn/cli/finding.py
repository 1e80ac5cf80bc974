"""How verbs find the files that they are given by path or by name."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from vehicledyn.cli.terminal import is_quiet, tell
from vehicledyn.library import Kind, locate


def find_file(given: str | Path, *kinds: Kind, others: Sequence[str] = ()) -> Path:
    """Return the file of a path or name, see :func:`vehicledyn.library.locate`.

    Where it is not the very path given, its path is printed as a message.
    """
    path = locate(str(given), kinds, others)
    if path != Path(given) and not is_quiet():
        tell(f"{given}: reading {path}")
    return path
