"""Transient slip: the tyre's carcass as a spring that rolls off, so that a car can stand still.

    u' = -v_sx - |v_x| u/σ_κ,    v' = v_y - |v_x| v/σ_α,    κ' = u/σ_κ,    tan α' = v/σ_α

u and v are deflections of the contact patch, v_sx = v_x - Ω r its sliding velocity, σ the
relaxation lengths; the steady law gets κ' and α' instead of κ and α (Pacejka's single contact
point, in the signs of :mod:`vehicledyn.road.wheel.slip`). In steady rolling κ' = κ and α' = α. At
standstill the deflections are springs: locked wheels hold a car on a slope without creep.

With ``turning`` the patch is twisted, too (:mod:`vehicledyn.road.wheel.turning`).

Below LOW_SPEED two terms fade in. Damping, κ' = (u + τ u')/σ_κ with u' as above, settles a car
that comes to rest and leaves steady rolling as it is; τ is σ over DAMPING_SPEED, not less than
DAMPING_TIME. A leak takes off what exceeds HOLDING_SLIP times σ, so that wheels that slide at
standstill do not wind up. Above LOW_SPEED both are exactly zero.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace

from pydantic import Field

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.base.registry import register
from vehicledyn.road.tyres.smooth import floored
from vehicledyn.road.tyres.tyre import RelaxationLengths, Tyre, TyreForces, TyreInput
from vehicledyn.road.wheel.slip import WheelMotion
from vehicledyn.road.wheel.turning import Turning
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Variable
from vehicledyn.symbolic.ops import Scalar

LOW_SPEED = 2.5
"""Forward speed below which damping and leak act [m/s]."""

DAMPING_TIME = 0.01
"""Least τ, ratio of the carcass's damping to its stiffness at standstill [s]."""

DAMPING_SPEED = 10.0
"""σ/τ of longer carcasses, whose damping is the slip stiffness over this speed [m/s].

2 kN s/m each 20 kN of slip stiffness: a car that has stopped rocks twice. Steady slip with a floor
of a speed is the same damper without a spring.
"""

HOLDING_SLIP = 0.15
"""Deflection over σ that a tyre keeps at standstill; more than the slip of the peak [1]."""

LEAK_TIME = 0.01
"""Time in which more deflection than that is lost [s]."""


DEFLECTIONS = (
    Variable(
        "tyre.longitudinal_deflection", "m", "Deflection of the contact patch along the wheel"
    ),
    Variable("tyre.lateral_deflection", "m", "Deflection of the contact patch across the wheel"),
)
TWIST = Variable("tyre.twist", "rad", "Twist of the contact patch against the ground")

States = Mapping[str, Scalar]
"""States of a wheel by their names."""


class WheelRelaxation(ParameterSet):
    """How slips and forces of a tyre build up; every kind of the catalogue derives from it."""

    turning: Turning | None = Field(
        default=None, description="Patch that resists turning on the spot; none without"
    )

    @property
    @abstractmethod
    def deflections(self) -> tuple[Variable, ...]:
        """The states but for the twist."""

    @abstractmethod
    def slips(
        self, tyre: Tyre, rolling: TyreInput, motion: WheelMotion, states: States
    ) -> TransientSlip:
        """Return what the tyre law feels; ``rolling`` has load and camber."""

    @abstractmethod
    def passed_on(
        self, forces: TyreForces, slips: TransientSlip, motion: WheelMotion, states: States
    ) -> tuple[TyreForces, dict[str, Scalar]]:
        """Return the forces that reach the wheel, and the rates of the deflections."""

    def check_tyre(self, tyre: Tyre) -> None:
        """Raise InputError if a tyre lacks what this kind takes from its law."""

    def states(self) -> tuple[Variable, ...]:
        """Return the deflections, and the twist of a patch that resists turning."""
        return self.deflections + (() if self.turning is None else (TWIST,))

    def answer(
        self,
        forces: TyreForces,
        slips: TransientSlip,
        motion: WheelMotion,
        states: States,
        load: Scalar,
    ) -> tuple[TyreForces, dict[str, Scalar]]:
        """Return forces on the wheel, with the moment of turning, and the rates of all states."""
        found, rates = self.passed_on(forces, slips, motion, states)
        if self.turning is None:
            return found, rates
        twist, speed = states[TWIST.name], ops.absolute(motion.longitudinal)
        moment = found.aligning_moment + self.turning.moment(twist, load)
        rates[TWIST.name] = self.turning.rate(twist, load, motion.turning, speed)
        return replace(found, aligning_moment=moment), rates


class SinglePoint(WheelRelaxation):
    """Pacejka's single contact point: two deflections that roll off over their lengths."""

    @abstractmethod
    def lengths(self, tyre: Tyre, contact: TyreInput) -> RelaxationLengths:
        """Return the relaxation lengths of a tyre at a contact."""

    def check_tyre(self, tyre: Tyre) -> None:
        """Raise InputError if a tyre has no relaxation lengths and this kind gives none."""
        self.lengths(tyre, TyreInput(1.0, 0.0, 0.0, 0.0))

    @property
    def deflections(self) -> tuple[Variable, ...]:
        """The deflections of the patch along and across the wheel."""
        return DEFLECTIONS

    def slips(
        self, tyre: Tyre, rolling: TyreInput, motion: WheelMotion, states: States
    ) -> TransientSlip:
        """Return the transient slips."""
        along, across = (states[item.name] for item in DEFLECTIONS)
        return transient_slip(motion, self.lengths(tyre, rolling), along, across)

    def passed_on(
        self, forces: TyreForces, slips: TransientSlip, motion: WheelMotion, states: States
    ) -> tuple[TyreForces, dict[str, Scalar]]:
        """Return the law's forces as they are."""
        rates = (slips.longitudinal_rate, slips.lateral_rate)
        return forces, {v.name: rate for v, rate in zip(DEFLECTIONS, rates, strict=True)}


@register("relaxation", "first_order")
class Relaxation(SinglePoint):
    """Relaxation lengths of a tyre."""

    longitudinal: float = quantity("m", "Relaxation length σ_κ of longitudinal slip", gt=0)
    lateral: float = quantity("m", "Relaxation length σ_α of side slip", gt=0)

    def lengths(self, tyre: Tyre, contact: TyreInput) -> RelaxationLengths:
        """Return the lengths, equal for all tyres and loads."""
        return RelaxationLengths(self.longitudinal, self.lateral)


@register("relaxation", "of_tyre")
class TyreRelaxation(SinglePoint):
    """Relaxation lengths by the tyre law itself: they change with load and camber.

    Tyres of property files have them by their coefficients, or as slip stiffness over the
    stiffness of the carcass; other laws have none.
    """

    shortest: float = quantity("m", "Least relaxation length, for small loads", default=0.05, gt=0)

    def lengths(self, tyre: Tyre, contact: TyreInput) -> RelaxationLengths:
        """Return the lengths of a tyre at a contact."""
        found = tyre.relaxation_lengths(contact)
        return RelaxationLengths(
            floored(found.longitudinal, self.shortest), floored(found.lateral, self.shortest)
        )


@dataclass(frozen=True)
class TransientSlip:
    """Slips that the tyre feels and the rates of its two deflections.

    Attributes
    ----------
    longitudinal_slip, slip_angle
        κ' [1] and α' [rad].
    longitudinal_rate, lateral_rate
        u' and v' [m/s].
    carcass
        Stiffnesses of the carcass along and across the wheel, where the kind has them [N/m].
    """

    longitudinal_slip: Scalar
    slip_angle: Scalar
    longitudinal_rate: Scalar
    lateral_rate: Scalar
    carcass: tuple[Scalar, ...] = ()


def transient_slip(
    motion: WheelMotion, lengths: RelaxationLengths, longitudinal: Scalar, lateral: Scalar
) -> TransientSlip:
    """Return the transient slips and rates at given deflections.

    Parameters
    ----------
    motion
        Motion of the wheel in the contact frame.
    lengths
        Relaxation lengths.
    longitudinal, lateral
        Deflections u and v [m].

    References
    ----------
    Pacejka, Tyre and Vehicle Dynamics, chapter 7, which asks for damping and a limit at low speed.
    Its damper acts on the sliding velocity, ours on the rate of the deflection, so that slip in
    steady rolling stays exact; size and leak are our own choice.
    """
    speed = ops.absolute(motion.longitudinal)
    low = low_speed_share(speed)
    slip, slip_rate = rolled_off(-motion.sliding, speed, low, longitudinal, lengths.longitudinal)
    tangent, angle_rate = rolled_off(motion.lateral, speed, low, lateral, lengths.lateral)
    return TransientSlip(slip, ops.atan(tangent), slip_rate, angle_rate)


def low_speed_share(speed: Scalar) -> Scalar:
    """Return (1 - (v/LOW_SPEED)²)², one at standstill and zero from LOW_SPEED on [1]."""
    inside = ops.maximum(1.0 - (speed / LOW_SPEED) ** 2, 0.0)
    return inside * inside


def rolled_off(
    drive: Scalar, speed: Scalar, low: Scalar, deflection: Scalar, length: Scalar
) -> tuple[Scalar, Scalar]:
    """Return the slip and the rate of one deflection that is driven at a velocity [m/s]."""
    kept = HOLDING_SLIP * length
    excess = deflection - ops.minimum(ops.maximum(deflection, -kept), kept)
    rolling = drive - speed * deflection / length
    damping_time = ops.maximum(length / DAMPING_SPEED, DAMPING_TIME)
    slip = (deflection + low * damping_time * rolling) / length
    return slip, rolling - low * excess / LEAK_TIME
