"""Collect the events of the parts: their functions, and the new values they give to states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.multibody.equations.impacts import Impacts
from vehicledyn.multibody.equations.outputs import Solved
from vehicledyn.multibody.model.parts import PartEvent
from vehicledyn.multibody.model.symbols import Symbols
from vehicledyn.multibody.model.system import System
from vehicledyn.symbolic import frames
from vehicledyn.symbolic.equations import Event
from vehicledyn.symbolic.ops import Scalar


@dataclass
class CollectedEvents:
    """Events with the columns that their indices refer to."""

    events: list[Event] = field(default_factory=list)
    functions: list[Scalar] = field(default_factory=list)
    new_values: list[Scalar] = field(default_factory=list)


def collect_events(
    system: System,
    symbols: Symbols,
    solved: Solved,
    *,
    states: Sequence[str],
    unknowns: Sequence[str],
    impacts: Impacts,
) -> CollectedEvents:
    """Return the events of all parts, in the order of the parts.

    Parameters
    ----------
    system, symbols, solved
        The system, with its accelerations known.
    states, unknowns
        Names of the states and of the algebraic unknowns, in the order of the equations.
    impacts
        Gives the rates after impulses.

    Raises
    ------
    InputError
        If two events have the same name, one resets what is no state, or guesses what is no
        unknown.
    """
    collected = CollectedEvents()
    for part in system.parts:
        with frames.naming("part", part.name):
            own = part.events(symbols.situation(part, solved.kinematics))
        for event in own:
            name = f"{part.name}.{event.name}" if event.name else part.name
            if any(other.name == name for other in collected.events):
                raise InputError(f"two events are named '{name}'")
            values = _new_values(name, event, impacts)
            first = len(collected.new_values)
            found = Event(
                name,
                len(collected.functions),
                event.direction,
                event.terminal,
                _rows(f"event '{name}' resets", "state", values, states, first),
                _rows(
                    f"event '{name}' guesses",
                    "dependent coordinate",
                    event.guesses,
                    unknowns,
                    first + len(values),
                ),
                event.advice,
                event.outcome,
            )
            collected.events.append(found)
            collected.functions.append(event.expression)
            collected.new_values.extend((*values.values(), *event.guesses.values()))
    return collected


def _new_values(name: str, event: PartEvent, impacts: Impacts) -> dict[str, Scalar]:
    """Return the new value of each state that an event changes."""
    if event.lands:
        return {**event.resets, **impacts.rates_after_landing(event.guesses)}
    if not event.impulses and event.restitution is None:
        return event.resets
    after = impacts.rates_after(name, event)
    twice = [state for state in event.resets if state in after]
    if twice:
        raise InputError(f"event '{name}' resets '{twice[0]}', which its impulses change as well")
    return {**event.resets, **after}


def _rows(
    words: str, what: str, values: dict[str, Scalar], known: Sequence[str], first: int
) -> tuple[tuple[int, int], ...]:
    """Return the index of each name among the known ones, with its row of new values."""
    rows = []
    for row, name in enumerate(values, first):
        if name not in known:
            raise InputError(f"{words} {unknown_name(what, name, known)}")
        rows.append((known.index(name), row))
    return tuple(rows)
