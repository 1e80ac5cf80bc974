"""Say where in a system file the parts stand that an error of the equations is about."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.base.problems import Problem
from vehicledyn.run.vehicle import Target
from vehicledyn.systems.read import SystemModel


@contextmanager
def told_with_places(target: Target) -> Iterator[None]:
    """Give the errors of a block the lines of the parts they are about, where there is a file.

    Raises
    ------
    InputError, NumericalError
        The block's own, as ``file:line:column: field: message``.
    """
    try:
        yield
    except (InputError, NumericalError) as error:
        places = target.written.places if isinstance(target.written, SystemModel) else {}
        known = [name for name in dict.fromkeys(error.about) if name in places]
        if not known:
            raise
        kind = InputError if isinstance(error, InputError) else NumericalError
        raise kind(_with_places(str(error), known, places)) from None


def _with_places(text: str, names: list[str], places: Mapping[str, Problem]) -> str:
    first, lines = places[names[0]], [places[name].mark for name in names]
    others = [
        f"'{name}' is in line {mark.line}"
        for name, mark in zip(names, lines, strict=True)
        if mark is not None and mark != lines[0]
    ]
    told = f"{text} ({', '.join(others)})" if others else text
    return str(first._replace(message=told))
