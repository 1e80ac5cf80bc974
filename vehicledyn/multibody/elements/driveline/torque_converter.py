"""Hydrodynamic torque converters by tables over the speed ratio."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.multibody.elements.straight_lines import straight_lines
from vehicledyn.multibody.model.declaration import choice, coordinate_name, function
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar

STANDSTILL = 1e-6
"""Speed below which a speed ratio fades to zero, so that none is a division by zero [rad/s]."""


def _one(_: Situation) -> Scalar:
    return 1.0


@register("element_type", "torque_converter")
@dataclass(frozen=True, kw_only=True)
class TorqueConverter(BasePart):
    """A hydrodynamic torque converter between the shafts of pump and turbine.

    With the speeds ω_p of the pump, i ω_t of the turbine, i the ratio of gears behind it, and the
    speed ratio ν = i ω_t/ω_p,

        T_p = λ(ν) ω_p |ω_p|,    T_t = R(ν) T_p    for |i ω_t| ≤ |ω_p|
        T_p = -λ(1/ν) i ω_t |i ω_t|,    T_t = T_p    for |i ω_t| > |ω_p|

    T_p acts against the pump and i T_t along the turbine's coordinate; the carrier of both takes
    the rest, the torque of the stator. Capacity λ and torque ratio R are straight lines between
    points. Where a turbine runs backwards λ is that at stall and R fades from its stall value to 1
    at ν = -1, so that the torques are continuous. The loss is T_p ω_p - T_t i ω_t, never negative.

    References
    ----------
    Gillespie (1992), Fundamentals of Vehicle Dynamics, SAE, chapter 2 (capacity factor K is
    1/√λ); Project Chrono, ChShaftsTorqueConverter.
    """

    pump: str = coordinate_name("Coordinate of the pump, on the engine's shaft")
    turbine: str = coordinate_name("Coordinate that the turbine turns")
    ratio: Callable[[Situation], Scalar] = function(
        "1", "Turns i of the turbine a turn of its coordinate", of="motion", default=_one,
        written=1.0,
    )  # fmt: skip
    speed_ratios: tuple[float, ...] = choice("Speed ratios ν from 0 to 1, growing", unit="1")
    torque_ratios: tuple[float, ...] = choice("Torque ratio R at each of them", unit="1")
    capacities: tuple[float, ...] = choice(
        "Capacity λ at each of them, 0 at the last", unit="N*m*s^2/rad^2"
    )

    def __post_init__(self) -> None:
        """Refuse tables that are none of a torque converter.

        Raises
        ------
        InputError
            If the lists differ in length, a number is not finite or negative, the speed ratios do
            not grow from 0 to 1, the last capacity is not 0, or the converter gains power.
        """
        for name in ("torque_ratios", "capacities"):
            if len(getattr(self, name)) != len(self.speed_ratios):
                counts = f"{len(self.speed_ratios)} speed ratios and {len(getattr(self, name))}"
                raise InputError(f"{counts} values of '{name}'; give as many")
        for value in (*self.speed_ratios, *self.torque_ratios, *self.capacities):
            if not math.isfinite(value) or value < 0.0:
                raise InputError(f"the tables hold {value:g}; a finite number, 0 or more, is due")
        self._check_speed_ratios()
        if self.capacities[-1] != 0.0:
            words = f"the capacity at speed ratio 1 is {self.capacities[-1]:g}"
            raise InputError(f"{words}; it must be 0, as torques change sign there")
        self._check_power()

    def _check_speed_ratios(self) -> None:
        ratios = self.speed_ratios
        if len(ratios) < len(("from", "to")) or (ratios[0], ratios[-1]) != (0.0, 1.0):
            raise InputError("the speed ratios must run from 0 (stall) to 1")
        for before, after in pairwise(ratios):
            if after <= before:
                raise InputError(f"speed ratio {after:g} follows {before:g}; sort the points")

    def _check_power(self) -> None:
        """Refuse an efficiency R ν above 1, also between the points, where it is a parabola."""
        x, y = self.speed_ratios, self.torque_ratios
        for k in range(len(x) - 1):
            slope = (y[k + 1] - y[k]) / (x[k + 1] - x[k])
            places = [x[k], x[k + 1]]
            if slope < 0.0:
                places.append(min(max(0.5 * (x[k] - y[k] / slope), x[k]), x[k + 1]))
            for place in places:
                efficiency = place * (y[k] + slope * (place - x[k]))
                if efficiency > 1.0 + 1e-12:
                    words = f"the torque ratio makes an efficiency of {efficiency:.6g}"
                    raise InputError(f"{words} at speed ratio {place:.6g}; at most 1 is possible")

    def loads(self, situation: Situation) -> Loads:
        """Return the torques on both coordinates."""
        pump, turbine, *_ = self._torques(situation)
        ratio = self.ratio(situation)
        return Loads(joint_forces={self.pump: -pump, self.turbine: ratio * turbine})

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return torques, speed ratio and loss."""
        pump, turbine, before, after = self._torques(situation)
        name = self.name
        loss = pump * before - turbine * after
        quotient = _quotient(after, before)
        words = "Speed of the turbine over that of the pump"
        return (
            Output(Channel(f"{name}.pump_torque", "N*m", "Torque that the pump takes"), pump),
            Output(Channel(f"{name}.turbine_torque", "N*m", "Torque of the turbine"), turbine),
            Output(Channel(f"{name}.speed_ratio", "1", words), quotient),
            Output(Channel(f"{name}.loss", "W", "Power that becomes heat"), loss),
        )

    def _torques(self, situation: Situation) -> tuple[Scalar, Scalar, Scalar, Scalar]:
        """Return torque of pump and turbine [N m] and their speeds [rad/s]."""
        before = situation.kinematics.rate(self.pump)
        after = self.ratio(situation) * situation.kinematics.rate(self.turbine)
        drives = abs(before) >= abs(after)
        fast, slow = ops.where(drives, before, after), ops.where(drives, after, before)
        quotient = _quotient(slow, fast)
        torque = straight_lines(self.speed_ratios, self.capacities, quotient) * fast * abs(fast)
        more = straight_lines(self.speed_ratios, self.torque_ratios, quotient) - 1.0
        backwards = 1.0 + ops.minimum(quotient, 0.0)
        pump = ops.where(drives, torque, -torque)
        return pump, pump * ops.where(drives, 1.0 + more * backwards, 1.0), before, after


def _quotient(slow: Scalar, fast: Scalar) -> Scalar:
    return slow * fast / (fast * fast + STANDSTILL**2)
