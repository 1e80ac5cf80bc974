"""Titles of runs whose scenario was changed from outside, which its own title does not know."""

from __future__ import annotations

from collections.abc import Sequence

_BESIDE = ("title", "description", "duration", "output", "solver")
"""Sections of a scenario that say how it is computed and kept, not what happens."""

_MOST = 3


def changed_title(title: str, overrides: Sequence[str]) -> str:
    """Return the title of a run with the changes ``key=value`` of what happens in it.

    >>> changed_title("Ramp steer at 20 m/s", ["speed=10 m/s", "solver.step=1 ms"])
    'Ramp steer at 20 m/s, changed: speed = 10 m/s'
    """
    values = {}
    for override in overrides:
        key, _, value = override.partition("=")
        values[key.strip().removeprefix("parameters.")] = " ".join(value.split()).strip("\"'")
    lines = [f"{key} = {text}" for key, text in values.items() if key.split(".")[0] not in _BESIDE]
    if not lines or "title" in values:
        return title
    more = [f"and {len(lines) - _MOST} more"] if len(lines) > _MOST else []
    return f"{title}, changed: {', '.join([*lines[:_MOST], *more])}"
