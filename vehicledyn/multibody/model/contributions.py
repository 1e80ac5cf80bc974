"""Bodies, cuts and constraints that parts bring with them, put among those of a system."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol, TypeVar

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.model.bodies import Body


class _Named(Protocol):
    @property
    def name(self) -> str: ...


T = TypeVar("T", bound=_Named)


def merged(
    what: str, own: Sequence[T], brought: Iterable[T], before: frozenset[str]
) -> tuple[T, ...]:
    """Return what a system has of its own and what its parts bring now.

    Parameters
    ----------
    what
        Word for an item in messages.
    own
        Items of the system, also those that its parts brought before and that may have been
        changed since, as in their starts.
    brought
        Items that its parts bring.
    before
        Names of those that were brought before.

    Raises
    ------
    InputError
        If a name is taken.
    """
    offered: dict[str, T] = {}
    for item in brought:
        if item.name in offered:
            raise InputError(f"two parts bring a {what} '{item.name}'; give the parts other names")
        offered[item.name] = item
    kept = [item for item in own if item.name not in before or item.name in offered]
    taken = {item.name for item in kept}
    clash = sorted(taken & set(offered) - before)
    if clash:
        raise InputError(f"a part brings a {what} '{clash[0]}', a name that is taken")
    return (*kept, *(item for name, item in offered.items() if name not in taken))


def parents_first(bodies: tuple[Body, ...]) -> tuple[Body, ...]:
    """Return bodies with each after its parent where there is one, else in their order."""
    waiting = {body.name: body for body in bodies}
    if len(waiting) != len(bodies):
        return bodies
    ordered: list[Body] = []
    while waiting:
        ready = [body for body in waiting.values() if body.parent not in waiting]
        if not ready:
            return bodies
        ordered += ready
        for body in ready:
            del waiting[body.name]
    return tuple(ordered)
