"""Patterns that choose what is compared, and those that match nothing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase

from vehicledyn.base.argument_names import argument
from vehicledyn.results.compare.tolerances import Tolerances
from vehicledyn.results.store.near_names import near

Patterns = Sequence[str] | None


def is_chosen(name: str, patterns: Patterns) -> bool:
    """Return whether a name matches one of some patterns; all do without patterns."""
    return patterns is None or any(fnmatchcase(name, pattern) for pattern in patterns)


def unmatched(known: Iterable[str], channels: Patterns, tolerances: Tolerances) -> list[str]:
    """Return what is wrong with patterns that match no name of the reference.

    Parameters
    ----------
    known
        What the reference holds.
    channels
        Patterns of what is compared.
    tolerances
        Tolerances, whose patterns are looked at too.
    """
    names = list(known)
    asked = {"channels": channels or (), "tolerances": tolerances.by_channel}
    return [
        f"{argument(name)}: no channel matches '{pattern}'; {near(pattern, names)}"
        for name, patterns in asked.items()
        for pattern in patterns
        if not any(is_chosen(other, [pattern]) for other in names)
    ]
