"""Files that the parts of a scenario or system name: read while the file itself is checked."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.problems import Place


def beside(parts: ParameterSet, folder: Path) -> Iterator[tuple[Place, str]]:
    """Yield what is wrong with files that parts name: the part's place, and one line of it.

    A part that names files has the method ``problems_beside``, which takes the folder of the file
    that holds it and returns the lines. Parts may be fields, entries of fields by name, or fields
    of these.
    """
    for name in type(parts).model_fields:
        field = getattr(parts, name)
        entries = field.items() if isinstance(field, dict) else ()
        named: list[tuple[Place, Any]] = [((name, key), item) for key, item in entries]
        for place, part in named or [((name,), field)]:
            look = getattr(part, "problems_beside", None)
            if callable(look):
                yield from ((place, line) for line in look(folder))
            elif isinstance(part, ParameterSet):
                yield from (((*place, *inner), line) for inner, line in beside(part, folder))
