"""Collect the events of the parts: their functions, and the new values they give to states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.multibody.impacts import Impacts
from vehicledyn.multibody.observation import Solved
from vehicledyn.multibody.parts import PartEvent
from vehicledyn.multibody.system import System
from vehicledyn.multibody.unknowns import Symbols
from vehicledyn.symbolic.equations import Event
from vehicledyn.symbolic.ops import Scalar


@dataclass
class CollectedEvents:
    """Events with the columns that their indices refer to."""

    events: list[Event] = field(default_factory=list)
    functions: list[Scalar] = field(default_factory=list)
    new_values: list[Scalar] = field(default_factory=list)


def collect_events(
    system: System, symbols: Symbols, solved: Solved, states: Sequence[str], impacts: Impacts
) -> CollectedEvents:
    """Return the events of all parts, in the order of the parts.

    Parameters
    ----------
    system, symbols, solved
        The system, with its accelerations known.
    states
        Names of the states, in the order of the equations.
    impacts
        Gives the rates after impulses.

    Raises
    ------
    InputError
        If two events have the same name, or one resets what is no state.
    """
    collected = CollectedEvents()
    for part in system.parts:
        for event in part.events(symbols.situation(part, solved.kinematics)):
            name = f"{part.name}.{event.name}" if event.name else part.name
            if any(other.name == name for other in collected.events):
                raise InputError(f"two events are named '{name}'")
            values = _new_values(name, event, impacts)
            resets = _resets(name, values, states, len(collected.new_values))
            index = len(collected.functions)
            collected.events.append(Event(name, index, event.direction, event.terminal, resets))
            collected.functions.append(event.expression)
            collected.new_values.extend(values.values())
    return collected


def _new_values(name: str, event: PartEvent, impacts: Impacts) -> dict[str, Scalar]:
    """Return the new value of each state that an event changes."""
    if not event.impulses and event.restitution is None:
        return event.resets
    after = impacts.rates_after(name, event)
    twice = [state for state in event.resets if state in after]
    if twice:
        raise InputError(f"event '{name}' resets '{twice[0]}', which its impulses change as well")
    return {**event.resets, **after}


def _resets(
    name: str, values: dict[str, Scalar], states: Sequence[str], first: int
) -> tuple[tuple[int, int], ...]:
    resets = []
    for row, state in enumerate(values, first):
        if state not in states:
            raise InputError(f"event '{name}' resets {unknown_name('state', state, states)}")
        resets.append((states.index(state), row))
    return tuple(resets)
