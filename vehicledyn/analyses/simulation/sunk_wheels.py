"""Refuse runs that start with a wheel deep in its rail, as one beside the rails is."""

from __future__ import annotations

import re

from vehicledyn.analyses.preparation.prepare import AssembledPoint
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.errors import InputError

DEEPEST = 2e-3
"""Approach of wheel and rail beyond which a start is refused [m].

By Hertz a wheel carries 5 to 10 MN there, a hundred times its load; rails yield long before.
"""

_CONTACT = re.compile(r"(.+)\.(left|right)\.contact_\d+\.approach")
_LISTED = 2


def refuse_sunk_wheels(prepared: Prepared, start: AssembledPoint) -> None:
    """Raise InputError if wheels lie deeper in their rails at the start than contact explains.

    A run whose start is a derailment already ends there, which is a result.

    Parameters
    ----------
    prepared
        What is to be run.
    start
        The point it starts from.
    """
    names = [channel.name for channel in prepared.equations.channels]
    contacts = [(name, match) for name in names if (match := _CONTACT.fullmatch(name))]
    if not contacts:
        return
    if _is_derailed(prepared, start):
        return
    outputs = prepared.kernel.outputs(0.0, start.state, start.unknowns)
    values = dict(zip(names, map(float, outputs), strict=True))
    deepest: dict[tuple[str, str], float] = {}
    for name, match in contacts:
        wheel = (match[1], match[2])
        deepest[wheel] = max(values[name], deepest.get(wheel, 0.0))
    sunk = {wheel: depth for wheel, depth in deepest.items() if depth > DEEPEST}
    if not sunk:
        return
    lines = [
        f"the {side} wheel of '{name}' is {1e3 * depth:.3g} mm deep in its rail"
        f"{_beside(values.get(f'{name}.lateral_shift'))}"
        for (name, side), depth in list(sunk.items())[:_LISTED]
    ]
    more = f"; so are {len(sunk) - _LISTED} more wheels" if len(sunk) > _LISTED else ""
    raise InputError(
        f"the vehicle starts beside the rails: {'; '.join(lines)}{more}; give start values with "
        "the wheels on the rails, or let them down by 'start: static'",
        about=list(dict.fromkeys(name for name, _ in sunk)),
    )


def _is_derailed(prepared: Prepared, start: AssembledPoint) -> bool:
    values = prepared.kernel.event_values(0.0, start.state, start.unknowns)
    events = prepared.equations.events
    return any(v > 0.0 for e, v in zip(events, values, strict=True) if e.outcome == "derailed")


def _beside(shift: float | None) -> str:
    if shift is None:
        return ""
    side = "left" if shift > 0.0 else "right"
    return f", shifted to the {side} by {1e3 * abs(shift):.3g} mm"
