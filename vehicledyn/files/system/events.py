"""Events of system files: when something passes zero, and what changes then."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field, field_validator

from vehicledyn.files.expressions.expressions import Expression
from vehicledyn.files.expressions.fields import Scalar, SystemSet, measured, read_mapping
from vehicledyn.files.system.laws import Values
from vehicledyn.files.system.places import Place
from vehicledyn.files.system.sensors import motion_of

if TYPE_CHECKING:
    from vehicledyn.multibody.model.parts import Part, Situation

RATE = "_rate"
_DIRECTIONS = {"rising": "rising", "falling": "falling", "both": "either"}


class EventSet(SystemSet):
    """Something happens where an expression passes zero."""

    when: Scalar = measured(
        "", "The expression whose change of sign is the event", variables="event"
    )
    direction: Literal["rising", "falling", "both"] = Field(
        default="both", description="Which changes of sign count"
    )
    terminal: bool = Field(default=False, description="Whether the event ends the run")
    restitution: Scalar | None = measured(
        "1",
        "Impact: the rate of 'when' goes back with this part of what it was, by an impulse along "
        "the gradient of 'when'",
        default=None,
        least=0.0,
        most=1.0,
    )
    reset: dict[str, Scalar] = Field(
        default_factory=dict,
        description="New values of rates (coordinate_rate, by impulses on these coordinates), "
        "coordinates and switches, from the values before",
        json_schema_extra={"expressions": True},
    )
    points: dict[str, Place] = Field(
        default_factory=dict,
        description="Points by name; the expressions have their world position as name.x and so "
        "on, their velocity as name_velocity.x",
    )

    @field_validator("reset", mode="before")
    @classmethod
    def _read_reset(cls, value: Any) -> Any:
        return read_mapping(value)

    def part(
        self, name: str, value: Values, coordinates: Sequence[str], switches: Sequence[str]
    ) -> Part:
        """Return the event of this name.

        Parameters
        ----------
        name
            Its name.
        value
            Value of an expression.
        coordinates, switches
            All of the system.
        """
        from vehicledyn.multibody.elements.triggers import VALUE, Trigger

        def at(expression: Expression) -> Any:
            return lambda situation: value(
                expression,
                **motion_of(situation, coordinates),
                **self._seen(situation, value),
            )

        rates, values = [], []
        for key, expression in self.reset.items():
            if key in switches:
                values.append((f"{key}.{VALUE}", at(expression)))
            elif key in coordinates:
                values.append((key, at(expression)))
            else:
                rates.append((key.removesuffix(RATE), at(expression)))
        return Trigger(
            name,
            at(self.when),
            _DIRECTIONS[self.direction],  # type: ignore[arg-type]
            self.terminal,
            None if self.restitution is None else at(self.restitution),
            tuple(rates),
            tuple(values),
        )

    def _seen(self, situation: Situation, value: Values) -> dict[str, Any]:
        """Return position and velocity of the points by their names."""
        kinematics, names = situation.kinematics, {}
        for name, place in self.points.items():
            point = value(place.point)
            names[name] = _items(kinematics.position(place.body, point))
            names[f"{name}_velocity"] = _items(kinematics.velocity(place.body, point))
        return names


def switch(name: str, start: float) -> Part:
    """Return the switch of this name."""
    from vehicledyn.multibody.elements.triggers import Switch

    return Switch(name, start)


def _items(vector: Any) -> tuple[Any, Any, Any]:
    return vector[0], vector[1], vector[2]
