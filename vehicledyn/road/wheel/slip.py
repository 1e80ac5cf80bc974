"""Slip of a rolling wheel: what the tyre feels of the motion of the wheel, in ISO 8855 signs.

    κ = (Ω r - v_x) / |v_x|,    tan α = v_y / |v_x|

v_x and v_y are the velocity of the wheel centre along e_x and e_lat of the contact frame, Ω
the spin about the wheel axis and r the rolling radius. Driving gives κ > 0; motion to the
left gives α > 0. With |v_x| both keep their meaning when the wheel rolls backwards.

Below a low speed |v_x| is replaced by a floor, so that both stay finite at standstill; above
1.25 times the floor they are exact. A floor limits how stiff a wheel is: with slip stiffness C,
radius R and inertia I the spin settles at the rate C R²/(I floor), which an explicit method
must resolve.
"""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.road.tyres.smooth import floored
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

LONGITUDINAL_FLOOR = 4.0
"""Floor of |v_x| in the longitudinal slip [m/s].

RK4 with 1 ms is stable to a rate of 2785/s; C = 120 kN, R = 0.36 m and I = 1.9 kg m² make
2050/s at this floor.
"""

LATERAL_FLOOR = 0.8
"""Floor of |v_x| in the slip angle [m/s]; 60 kN/rad on 50 kg make 1500/s."""


@dataclass(frozen=True)
class SlipFloors:
    """Floors of |v_x| in the two slips [m/s]; a slip is exact above 1.25 times its floor."""

    longitudinal: float = LONGITUDINAL_FLOOR
    lateral: float = LATERAL_FLOOR


@dataclass(frozen=True)
class WheelMotion:
    """Velocity of the wheel centre in the contact frame and the spin.

    Attributes
    ----------
    longitudinal, lateral
        Components v_x and v_y [m/s].
    spin
        Angular velocity Ω about the wheel axis, absolute [rad/s].
    rolling_radius
        Radius r at which the wheel rolls without slip [m].
    turning
        Rate ω_n at which the wheel's plane turns about the ground's normal [rad/s].
    """

    longitudinal: Scalar
    lateral: Scalar
    spin: Scalar
    rolling_radius: Scalar
    turning: Scalar = 0.0

    @property
    def sliding(self) -> Scalar:
        """Velocity of the contact patch over the ground along e_x, v_x - Ω r [m/s]."""
        return self.longitudinal - self.spin * self.rolling_radius


def longitudinal_slip(motion: WheelMotion, floor: Scalar) -> Scalar:
    """Return κ = (Ω r - v_x) / max(|v_x|, floor), rounded near the floor [1]."""
    return -motion.sliding / floored(ops.absolute(motion.longitudinal), floor)


def slip_angle(motion: WheelMotion, floor: Scalar) -> Scalar:
    """Return α = atan(v_y / max(|v_x|, floor)), rounded near the floor [rad]."""
    return ops.atan(motion.lateral / floored(ops.absolute(motion.longitudinal), floor))


def turn_slip(motion: WheelMotion, floor: Scalar) -> Scalar:
    """Return φ_t = -ω_n / max(|v_x|, floor), the curvature of the path to the right [1/m]."""
    return -motion.turning / floored(ops.absolute(motion.longitudinal), floor)


def rolling_share(speed: Scalar) -> Scalar:
    """Return the share of camber thrust that a wheel at |v_x| builds up [1].

    Camber thrust comes of rolling: zero at standstill, 1 - (1 - (v/v1)²)² up to
    v1 = 1.25 LATERAL_FLOOR and exactly one above, so that with steady slip a standing car is
    in static equilibrium without forces along the ground.
    """
    missing = ops.maximum(1.0 - (speed / (1.25 * LATERAL_FLOOR)) ** 2, 0.0)
    return 1.0 - missing * missing
