"""Files that the parts of a scenario or system name: read while the file itself is checked."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from vehicledyn.base.parameters import ParameterSet


def beside(parts: ParameterSet, folder: Path) -> Iterator[tuple[str, str]]:
    """Yield what is wrong with files that parts name: the part's field, and one line of it.

    A part that names files has the method ``problems_beside``, which takes the folder of the file
    that holds it and returns the lines.
    """
    for name in type(parts).model_fields:
        look = getattr(getattr(parts, name), "problems_beside", None)
        for line in look(folder) if callable(look) else ():
            yield name, line
