"""Triggers and switches: events of a system with what they do, and states that only they change."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from vehicledyn.multibody.model.parts import BasePart, Loads, PartEvent, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Direction, Variable
from vehicledyn.symbolic.ops import Scalar

VALUE = "value"
"""Short name of the state of a switch."""


@dataclass(frozen=True)
class Switch(BasePart):
    """A number that stays as it is until an event resets it: latched or free, stuck or sliding."""

    start: float = 0.0

    def states(self) -> tuple[Variable, ...]:
        """Return the number."""
        return (Variable(VALUE, "1", f"Switch '{self.name}'", self.start),)

    def loads(self, situation: Situation) -> Loads:
        """Let it stay."""
        return Loads(rates={VALUE: ops.scalar(0.0)})


@dataclass(frozen=True)
class Trigger(BasePart):
    """An event where a function of the motion passes zero, and what it changes.

    ``function`` and the values of the mappings are functions of the situation. ``rates`` give
    coordinates new rates by impulses on these coordinates, ``restitution`` the function of the
    event a rate of this times the opposite of what it was, by an impulse along its gradient;
    all rates then jump so that momentum is balanced and the constraints hold. ``values`` are new
    values of coordinates and of states of parts, by the states' full names.
    """

    function: Callable[[Situation], Scalar]
    direction: Direction = "either"
    terminal: bool = False
    restitution: Callable[[Situation], Scalar] | None = None
    rates: tuple[tuple[str, Callable[[Situation], Scalar]], ...] = ()
    values: tuple[tuple[str, Callable[[Situation], Scalar]], ...] = ()

    @property
    def changes_motion(self) -> bool:
        """Whether it gives states new values."""
        return self.restitution is not None or bool(self.rates or self.values)

    def events(self, situation: Situation) -> tuple[PartEvent, ...]:
        """Return the event, which has the name of the trigger."""
        return (
            PartEvent(
                "",
                self.function(situation),
                self.direction,
                self.terminal,
                resets={n: value(situation) for n, value in self.values},
                impulses={n: value(situation) for n, value in self.rates},
                restitution=None if self.restitution is None else self.restitution(situation),
            ),
        )


def switches(situation: Situation) -> dict[str, Scalar]:
    """Return the values of all switches by name."""
    return {n: states[VALUE] for n, states in situation.all_states.items() if VALUE in states}
