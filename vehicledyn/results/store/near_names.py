"""Messages for arrays that a result does not hold: the nearest names instead of hundreds."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches

from vehicledyn.base.errors import unknown_name

MOST_NAMED = 6
FEW = 20
"""Number of names up to which all are listed."""


def unknown_array(name: str, known: Iterable[str], figures: Sequence[str] = ()) -> str:
    """Return the message for a name or pattern that matches nothing, with near ones.

    >>> unknown_array("chassis.yawrate", [f"w{k}.load" for k in range(30)] + ["chassis.yaw_rate"])
    "no channel matches 'chassis.yawrate'; nearest: chassis.yaw_rate (of 31)"
    """
    names = list(dict.fromkeys(known))
    if len(names) <= FEW:
        kind = "channel or figure" if figures else "channel"
        return unknown_name(kind, name, [*names, *figures])
    text = f"no channel{' or figure' if figures else ''} matches '{name[:80]}'; {near(name, names)}"
    return f"{text}; figures: {', '.join(figures)}" if figures else text


def near(name: str, names: Sequence[str]) -> str:
    """Return which of many names are near one that is not among them, or of what they are.

    >>> near("speeed", ["car.speed", "car.y"])
    'there are 2, in car.*'
    """
    plain = name.strip("*?")
    part = [n for n in names if plain and plain in n]
    like = get_close_matches(name, names, MOST_NAMED, 0.6)
    last = [n for n in names if n.rpartition(".")[2] == plain.rpartition(".")[2]]
    found = list(dict.fromkeys([*like, *part, *last]))[:MOST_NAMED]
    if found:
        return f"nearest: {', '.join(found)} (of {len(names)})"
    groups = list(dict.fromkeys(n.partition(".")[0] for n in names))
    shown = ", ".join(f"{group}.*" for group in groups[:FEW])
    return f"there are {len(names)}, in {shown}{', ...' if len(groups) > FEW else ''}"
