"""Refuse runs that start with rigid contacts whose bodies are not where the contacts say."""

from __future__ import annotations

from vehicledyn.analyses.preparation.prepare import AssembledPoint
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.errors import InputError

_TOUCHES, _GAP, _GAP_RATE = ".touches", ".gap", ".gap_rate"
_APART = 1e-5
"""Gap of a contact that touches at the start beyond which the run is refused [m]."""
_DEEP = -1e-6
"""Gap of one in flight below which it is refused: no event would find it [m]."""
_FAST = 1e-3
"""Speed of the gap of a contact that touches beyond which the run is warned of [m/s]."""


def refuse_open_contacts(prepared: Prepared, start: AssembledPoint) -> None:
    """Raise InputError if bodies are apart where they touch at the start, or overlap in flight.

    Such a contact would draw its bodies together, and one in flight would never hit.

    Parameters
    ----------
    prepared
        What is to be run.
    start
        The point it starts from.
    """
    problems, about = [], []
    for name, touches, gap, _ in _contacts(prepared, start):
        if touches and abs(gap) > _APART:
            where = "apart" if gap > 0.0 else "into each other"
            problems.append(
                f"the bodies of '{name}' are {1e3 * abs(gap):.6g} mm {where} at the start, where "
                "it touches; move them together by 'initial', or write 'touching: false' if they "
                "start apart"
            )
        elif not touches and gap < _DEEP:
            problems.append(
                f"the bodies of '{name}' are {-1e3 * gap:.6g} mm into each other at the start, "
                "where it does not touch ('touching: false'); move them apart by 'initial'"
            )
        else:
            continue
        about.append(name)
    if problems:
        raise InputError("; ".join(problems), about=about)


def unsteady_contacts(prepared: Prepared, start: AssembledPoint) -> list[str]:
    """Return a warning for contacts that touch at the start with a gap that opens or closes."""
    return [
        f"warning: '{name}' touches at the start while its gap {'opens' if rate > 0 else 'closes'} "
        f"at {abs(rate):.4g} m/s, which the contact ends within some 20 ms without an impact; give "
        "its bodies a start rate that keeps the gap, or write 'touching: false'"
        for name, touches, _, rate in _contacts(prepared, start)
        if touches and abs(rate) > _FAST
    ]


def _contacts(prepared: Prepared, start: AssembledPoint) -> list[tuple[str, bool, float, float]]:
    """Return the rigid contacts by name, whether they touch, their gaps and how fast these grow."""
    places = {variable.name: k for k, variable in enumerate(prepared.equations.states)}
    stems = [name.removesuffix(_TOUCHES) for name in places if name.endswith(_TOUCHES)]
    if not stems:
        return []
    names = [channel.name for channel in prepared.equations.channels]
    outputs = prepared.kernel.outputs(0.0, start.state, start.unknowns)
    values = dict(zip(names, map(float, outputs), strict=True))
    return [
        (
            stem,
            bool(start.state[places[stem + _TOUCHES]] > 0.5),
            values[stem + _GAP],
            values.get(stem + _GAP_RATE, 0.0),
        )
        for stem in stems
        if stem + _GAP in values
    ]
