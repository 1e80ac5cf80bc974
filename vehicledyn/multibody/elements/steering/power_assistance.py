"""Power assistance of steerings by a map over torsion-bar torque and speed."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.multibody.elements.straight_lines import straight_lines
from vehicledyn.multibody.model.declaration import choice, coordinate_name, function, number
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar

Row = tuple[float, ...]


@register("element_type", "power_assistance")
@dataclass(frozen=True, kw_only=True)
class PowerAssistance(BasePart):
    """A motor that assists the driver's hands by a map over sensed torque and speed.

        T_a = sign(T) A(|T|, |v|) - d q̇

    acts along ``coordinate``, the turn of pinion or column. T is the torque of the torsion bar,
    positive as it turns the coordinate forward. A is linear between the torques and speeds of the
    map and constant beyond the last ones. d is the active damping of the control. The motor
    has no lag; its inertia is that of the body it turns.
    """

    coordinate: str = coordinate_name("Coordinate that the motor turns")
    torque: Callable[[Situation], Scalar] = function(
        "N*m", "Torque T of the torsion bar along the coordinate", of="motion"
    )
    speed: Callable[[Situation], Scalar] = function(
        "m/s", "Speed v of the vehicle, of either sign", of="motion"
    )
    torques: Row = choice("Torques of the map, growing from 0", unit="N*m")
    speeds: Row = choice("Speeds of the map, growing, 0 or more", unit="m/s")
    assistance: Row = choice(
        "Assistance A at all torques, speed after speed; 0 without torque", unit="N*m"
    )
    damping: Scalar = number("N*m*s/rad", "Active damping d", default=0.0, least=0.0)

    def __post_init__(self) -> None:
        """Refuse maps that are no functions of torque and speed.

        Raises
        ------
        InputError
            If torques or speeds do not grow, the lists do not fit together, a number is not finite
            or negative, or there is assistance without torque.
        """
        if len(self.torques) < len(("from", "to")):
            raise InputError("torques: the map has less than two torques; give two at least")
        if len(self.assistance) != len(self.speeds) * len(self.torques) or not self.speeds:
            counts = f"{len(self.speeds)} speeds, {len(self.torques)} torques and "
            counts += f"{len(self.assistance)} values"
            raise InputError(f"assistance: {counts}; give a value for each torque at each speed")
        _check_growing("torques", self.torques, "N*m")
        _check_growing("speeds", self.speeds, "m/s")
        if self.torques[0] != 0.0:
            raise InputError(f"torques: begin at {self.torques[0]:g} N*m; they must begin at 0")
        for speed, row in zip(self.speeds, self._rows(), strict=True):
            for value in row:
                if not math.isfinite(value) or value < 0.0:
                    words = f"the map holds {value:g} N*m at {speed:g} m/s"
                    raise InputError(f"assistance: {words}; a finite number, 0 or more, is due")
            if row[0] != 0.0:
                words = f"{row[0]:g} N*m at {speed:g} m/s without torque of the hands"
                raise InputError(f"assistance: {words}; give 0 there")

    def _rows(self) -> list[Row]:
        """Return the part of the map at each speed."""
        count = len(self.torques)
        return [self.assistance[k * count : (k + 1) * count] for k in range(len(self.speeds))]

    def loads(self, situation: Situation) -> Loads:
        """Return the torque on the coordinate."""
        return Loads(joint_forces={self.coordinate: self._assisting(situation)})

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return torque and power of the motor."""
        torque, name = self._assisting(situation), self.name
        power = torque * situation.kinematics.rate(self.coordinate)
        return (
            Output(Channel(f"{name}.torque", "N*m", f"Torque on {self.coordinate}"), torque),
            Output(Channel(f"{name}.power", "W", "Power of the motor"), power),
        )

    def _assisting(self, situation: Situation) -> Scalar:
        bar_torque = self.torque(situation)
        size = ops.absolute(bar_torque)
        rows = [straight_lines(self.torques, row, size) for row in self._rows()]
        amount = _between(self.speeds, rows, ops.absolute(self.speed(situation)))
        rate = situation.kinematics.rate(self.coordinate)
        return ops.sign(bar_torque) * amount - self.damping * rate


def _between(x: Row, values: Sequence[Scalar], at: Scalar) -> Scalar:
    """Return straight lines between values that are expressions, constant beyond them."""
    total = values[0]
    for k in range(len(x) - 1):
        share = (at - x[k]) / (x[k + 1] - x[k])
        total = total + (values[k + 1] - values[k]) * ops.minimum(ops.maximum(share, 0.0), 1.0)
    return total


def _check_growing(name: str, values: Row, unit: str) -> None:
    for value in values:
        if not math.isfinite(value) or value < 0.0:
            raise InputError(f"{name}: the map holds {value:g} {unit}; 0 or more is due")
    for before, after in pairwise(values):
        if after <= before:
            words = f"{after:g} {unit} follows {before:g} {unit}"
            raise InputError(f"{name}: do not grow: {words}; sort the map")
