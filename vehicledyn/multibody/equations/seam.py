"""Where the surroundings of a system act on it: symbols stand for what they hand over.

A driver or a manoeuvre moves coordinates and exerts forces. Written with symbols for these, the
equations of the system are the same whoever acts, and are compiled once for all of them.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

from vehicledyn.multibody.model.parts import DrivenMotion, Loads, Part, Situation, loads_of
from vehicledyn.multibody.model.symbols import Symbols
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


@dataclass
class Handed:
    """Symbols of what surroundings hand over, and their values, by name.

    ``driven`` are the coordinates that they move.
    """

    symbols: dict[str, Scalar] = field(default_factory=dict)
    values: dict[str, Scalar] = field(default_factory=dict)
    driven: list[str] = field(default_factory=list)

    def take(self, name: str, value: Scalar) -> Scalar:
        """Return the symbol of a value."""
        self.symbols[name], self.values[name] = ops.symbol(name), ops.scalar(value)
        return self.symbols[name]

    def loads(self, part: Part, situation: Situation) -> Loads:
        """Return the loads of surroundings, with symbols for all that the system feels of them."""
        taken: list[str] = []

        def hand(name: str, value: Scalar) -> Scalar:
            taken.append(name)
            return self.take(f"{name} of {part.name}", value)

        loads = loads_of(part, replace(situation, handing=hand))
        self.driven += loads.accelerations
        return replace(
            loads,
            accelerations={
                name: self.take(f"{name}, acceleration", value)
                for name, value in loads.accelerations.items()
            },
            joint_forces={
                name: self.take(f"{name}, force of {part.name}", value)
                for name, value in loads.joint_forces.items()
            },
        )


@dataclass(frozen=True)
class Replacement:
    """Puts motions of driven coordinates, and what surroundings hand over, in place of symbols."""

    symbols: Symbols
    moved: dict[str, DrivenMotion]
    handed: Handed = field(default_factory=Handed)

    def __call__(self, expression: Scalar) -> Scalar:
        """Return an expression in time, states and unknowns alone."""
        names, values = self._known(list(self.moved))
        names += self.handed.symbols.values()
        values += self.handed_values
        return ops.substitute(expression, ops.column(names), ops.column(values))

    def opened(self, expression: Scalar) -> Scalar:
        """Return an expression that keeps the symbols of what surroundings hand over."""
        names, values = self._known([n for n in self.moved if n not in self.handed.driven])
        return ops.substitute(expression, ops.column(names), ops.column(values))

    @cached_property
    def handed_values(self) -> list[Scalar]:
        """What the symbols of loads stand for."""
        old, new = map(ops.column, self._known(list(self.moved)))
        return [ops.substitute(value, old, new) for value in self.handed.values.values()]

    def seam(self) -> tuple[list[str], list[Scalar], list[Scalar]]:
        """Return names, symbols and values of all that is handed over, motions first."""
        names = [text for n in self.handed.driven for text in (n, f"{n}, rate")]
        symbols, values = self._known(self.handed.driven)
        names += self.handed.symbols
        symbols += self.handed.symbols.values()
        return names, symbols, [*values, *self.handed_values]

    def _known(self, driven: list[str]) -> tuple[list[Scalar], list[Scalar]]:
        """Return symbols and values of positions and speeds of driven coordinates."""
        s, moved = self.symbols, self.moved
        old = [item for n in driven for item in (s.coordinates[n], s.rates[n])]
        return old, [item for n in driven for item in (moved[n].position, moved[n].velocity)]
