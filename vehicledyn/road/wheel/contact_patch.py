"""Transient slip with a contact patch that has a mass between carcass and tread.

The patch slides over the ground at w, the wheel above it at v_s = (v_x - Ω r, v_y). The carcass
is a spring and damper between them, the tread a row of bristles that rolls off over the half
length a of the patch:

    u' = w - v_s,    F_wheel = c u + k u',    m w' = F(κ', α') - F_wheel,
    e_x' = -w_x - |v_x| e_x/a,    e_y' = w_y - |v_x| e_y/a,    κ' = e_x/a,    tan α' = e_y/a.

The steady law F gets κ' and α'; the wheel feels the force of the carcass. In steady rolling it is
that of the law. The relaxation length comes out as slip stiffness over c, plus a; it falls with
slip, and slip may change fast: the patch swings at √((C/a + c)/m). Below LOW_SPEED the carcass
gets the further damping τ c, and bristles keep at most HOLDING_SLIP a, as the single contact point
of :mod:`vehicledyn.road.wheel.relaxation`; τ c is at most SLOWING m, so that a patch without
load, which nothing but this damping moves, is no faster than one that swings on its tread.
"""

from __future__ import annotations

from dataclasses import replace

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.tyres.tyre import Tyre, TyreForces, TyreInput
from vehicledyn.road.wheel.relaxation import (
    DAMPING_TIME,
    DEFLECTIONS,
    States,
    TransientSlip,
    WheelRelaxation,
    low_speed_share,
    rolled_off,
)
from vehicledyn.road.wheel.slip import WheelMotion
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Variable
from vehicledyn.symbolic.ops import Scalar

SLOWING = 1500.0
"""Largest rate at which the damping at low speed slows a patch by itself [1/s]."""

SLIDING = (
    Variable("tyre.longitudinal_patch_velocity", "m/s", "Velocity of the patch along the wheel"),
    Variable("tyre.lateral_patch_velocity", "m/s", "Velocity of the patch across the wheel"),
)
TREAD = (
    Variable("tyre.longitudinal_tread", "m", "Deflection of the tread along the wheel"),
    Variable("tyre.lateral_tread", "m", "Deflection of the tread across the wheel"),
)


@register("relaxation", "contact_patch")
class ContactPatch(WheelRelaxation):
    """A patch with mass on the spring of the carcass: the enhanced transient model of MF 6.2.

    Stiffnesses of the carcass that are left out are LONGITUDINAL_STIFFNESS and LATERAL_STIFFNESS
    of the tyre's property file.

    References
    ----------
    Pacejka (2012), Tire and Vehicle Dynamics, section 7.2.3 (enhanced non-linear transient model),
    without its yaw of the patch; damping at low speed as in its section 7.2.2.
    """

    mass: float = quantity("kg", "Mass m of the contact patch", gt=0)
    half_length: float = quantity("m", "Half length a of the contact patch", gt=0)
    longitudinal_stiffness: float | None = quantity(
        "N/m", "Stiffness c_x of the carcass along the wheel", default=None, gt=0
    )
    lateral_stiffness: float | None = quantity(
        "N/m", "Stiffness c_y of the carcass across the wheel", default=None, gt=0
    )
    longitudinal_damping: float = quantity("N*s/m", "Damping k_x along the wheel", ge=0)
    lateral_damping: float = quantity("N*s/m", "Damping k_y across the wheel", ge=0)

    def check_tyre(self, tyre: Tyre) -> None:
        """Raise InputError if neither the tyre nor this set gives the carcass's stiffness."""
        self._stiffness(tyre)

    @property
    def deflections(self) -> tuple[Variable, ...]:
        """Deflections of the carcass, velocities of the patch and deflections of the tread."""
        return (*DEFLECTIONS, *SLIDING, *TREAD)

    def slips(
        self, tyre: Tyre, rolling: TyreInput, motion: WheelMotion, states: States
    ) -> TransientSlip:
        """Return the slips of the tread; its rates are those of the bristles."""
        speed = ops.absolute(motion.longitudinal)
        low = low_speed_share(speed)
        along, across = (states[item.name] for item in SLIDING)
        bent = [states[item.name] for item in TREAD]
        stiffness = self._stiffness(tyre)
        slip, slip_rate = _of_tread(-along, speed, low, bent[0], self.half_length)
        tangent, angle_rate = _of_tread(across, speed, low, bent[1], self.half_length)
        return TransientSlip(slip, ops.atan(tangent), slip_rate, angle_rate, stiffness)

    def passed_on(
        self, forces: TyreForces, slips: TransientSlip, motion: WheelMotion, states: States
    ) -> tuple[TyreForces, dict[str, Scalar]]:
        """Return the forces of the carcass and the rates of all states."""
        above = (motion.sliding, motion.lateral)
        law = (forces.longitudinal_force, forces.lateral_force)
        damping = (self.longitudinal_damping, self.lateral_damping)
        low = low_speed_share(ops.absolute(motion.longitudinal))
        rates, held = {}, []
        for k, stiffness in enumerate(slips.carcass):
            rate = states[SLIDING[k].name] - above[k]
            added = ops.minimum(DAMPING_TIME * stiffness, SLOWING * self.mass)
            resistance = damping[k] + low * added
            held.append(stiffness * states[DEFLECTIONS[k].name] + resistance * rate)
            rates[DEFLECTIONS[k].name] = rate
            rates[SLIDING[k].name] = (law[k] - held[k]) / self.mass
        rates[TREAD[0].name], rates[TREAD[1].name] = slips.longitudinal_rate, slips.lateral_rate
        return replace(forces, longitudinal_force=held[0], lateral_force=held[1]), rates

    def _stiffness(self, tyre: Tyre) -> tuple[Scalar, Scalar]:
        """Return the carcass's stiffnesses, the file's where none are given."""
        given = (self.longitudinal_stiffness, self.lateral_stiffness)
        own = tyre.carcass_stiffness()
        found = tuple(
            mine if mine is not None else other for mine, other in zip(given, own, strict=True)
        )
        if found[0] is None or found[1] is None:
            raise InputError(
                f"tyres of the kind '{tyre.kind}' have no stiffness of the carcass; give the "
                "relaxation 'contact_patch' longitudinal_stiffness and lateral_stiffness"
            )
        return found[0], found[1]


def _of_tread(
    drive: Scalar, speed: Scalar, low: Scalar, deflection: Scalar, length: Scalar
) -> tuple[Scalar, Scalar]:
    """Return slip and rate of the bristles, which have no damping of their own."""
    _, rate = rolled_off(drive, speed, low, deflection, length)
    return deflection / length, rate
