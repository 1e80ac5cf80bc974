"""TMeasy: tyre forces from a few points of measured curves at two loads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

from pydantic import model_validator

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.base.registry import register
from vehicledyn.road.tyres.smooth import floored
from vehicledyn.road.tyres.tyre import Tyre, TyreForces, TyreInput
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

SLIP_FLOOR = 1e-8
"""Rounds the magnitude of the slip at zero [1]."""

ROLLING_FLOOR = 0.02
"""Least 1 + κ that slips are referred to [1]."""

LOAD_FLOOR, LOAD_CEILING = 1e-2, 3.0
"""Loads over the nominal load between which the parabolas hold; in proportion beyond [1]."""

ANGLE_LIMIT = 1.5
"""Slip angle beyond which its tangent no longer grows [rad]."""


class Points(ParameterSet):
    """Points of one curve, each at the nominal load and at twice that load."""

    slope: tuple[float, float] = quantity("N", "Slope dF_0 at no slip")
    peak_slip: tuple[float, float] = quantity("1", "Slip s_M at the largest force")
    peak_force: tuple[float, float] = quantity("N", "Largest force F_M")
    sliding_slip: tuple[float, float] = quantity("1", "Slip s_S from which the tyre slides")
    sliding_force: tuple[float, float] = quantity("N", "Force F_S of the sliding tyre")

    @model_validator(mode="after")
    def _check(self) -> Self:
        """Refuse points through which no curve goes, or none at other loads."""
        for name in ("slope", "peak_force", "sliding_force", "peak_slip", "sliding_slip"):
            one, two = getattr(self, name)
            if min(one, two) <= 0.0:
                raise ValueError(f"{name}: must be above zero")
            if not name.endswith("slip") and two <= one:
                raise ValueError(
                    f"{name}: must grow with the load, or the parabola through both values turns "
                    "negative at three times the first load"
                )
            if name.endswith("slip") and not 0.5 * one < two < 2.0 * one:
                raise ValueError(
                    f"{name}: the straight line through both values is negative between no load "
                    "and three times the first load"
                )
        gaps = [_on_line(self.sliding_slip, x) - _on_line(self.peak_slip, x) for x in (0.0, 3.0)]
        if min(gaps) <= 0.0:
            raise ValueError(
                "sliding_slip: must lie beyond peak_slip from no load to three times the first"
            )
        return self


def _on_line(pair: tuple[Scalar, Scalar], load: Scalar) -> Scalar:
    """Return a slip at a load over the nominal load."""
    return pair[0] + (pair[1] - pair[0]) * (load - 1.0)


@dataclass(frozen=True)
class Curve:
    """One curve at a load: dF_0, s_M, F_M, s_S and F_S."""

    slope: Scalar
    peak_slip: Scalar
    peak_force: Scalar
    sliding_slip: Scalar
    sliding_force: Scalar

    def force(self, slip: Scalar) -> Scalar:
        """Return the force at a slip of any size, never negative."""
        x = ops.minimum(slip / self.peak_slip, 1.0)
        steep = self.slope * self.peak_slip
        rising = steep * x / (1.0 + x * (x + steep / self.peak_force - 2.0))
        over = (slip - self.peak_slip) / (self.sliding_slip - self.peak_slip)
        y = ops.minimum(ops.maximum(over, 0.0), 1.0)
        return rising - (self.peak_force - self.sliding_force) * y * y * (3.0 - 2.0 * y)


@register("tyre", "tmeasy")
class TMeasy(Tyre):
    """TMeasy: slope, peak and sliding force along and across the wheel, at two loads.

    F(s) = dF_0 s/(1 + x (x + dF_0 s_M/F_M - 2)), x = s/s_M, up to the peak; from there to the
    sliding force by a cubic, and constant beyond. Forces are parabolas of the load, slips
    straight lines. Slips are (κ, tan α)/(1 + κ); combined slip normalises both and takes the
    curve between the two in the direction of the slip. The trail is n_0 at no slip, zero at
    ``trail_zero_slip``, negative from there and gone at ``trail_end_slip``. Camber adds
    ``camber_slip`` γ to the side slip.

    References
    ----------
    Rill (2006), Vehicle System Dynamics 44 (Suppl.), 795-807, by way of public programs; the
    paper was not at hand.
    """

    nominal_load: float = quantity("N", "Load that the first of two values refers to", gt=0)
    longitudinal: Points
    lateral: Points
    trail: float = quantity("m", "Trail n_0 at no slip", default=0.0, ge=0)
    trail_zero_slip: float = quantity("1", "Side slip where the trail is zero", default=0.2, gt=0)
    trail_end_slip: float = quantity("1", "Side slip beyond which it is none", default=0.5, gt=0)
    camber_slip: float = quantity("1/rad", "Side slip per camber", default=0.0, ge=0)
    friction: float = quantity(
        "1", "Friction of the road over that of the tests", default=1.0, gt=0
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        """Refuse a trail that ends before it is zero."""
        if self.trail_end_slip <= self.trail_zero_slip:
            raise ValueError("trail_end_slip: must lie beyond trail_zero_slip")
        return self

    def forces(self, contact: TyreInput) -> TyreForces:
        """Return the forces at combined slip."""
        relative_load = contact.normal_force / self.nominal_load
        load = ops.minimum(floored(relative_load, LOAD_FLOOR), LOAD_CEILING)
        along, across = (_at_load(p, load) for p in (self.longitudinal, self.lateral))
        angle = ops.minimum(ops.maximum(contact.slip_angle, -ANGLE_LIMIT), ANGLE_LIMIT)
        rolled = floored(1.0 + contact.longitudinal_slip, ROLLING_FLOOR)
        slip = contact.longitudinal_slip / rolled
        side = ops.tan(angle) / rolled + self.camber_slip * contact.camber
        force_x, force_y = _combined(along, across, slip / self.friction, side / self.friction)
        share = self.friction * relative_load / load
        lateral = -share * force_y
        return TyreForces(share * force_x, lateral, -self._trail(side) * lateral)

    def _trail(self, side: Scalar) -> Scalar:
        """Return the pneumatic trail at a side slip [m]."""
        zero, end = self.trail_zero_slip, self.trail_end_slip
        size = ops.smooth_norm(side, 0.0, SLIP_FLOOR)
        s = ops.minimum(size / zero, 1.0)
        w = zero / end
        before = (1.0 - w) * (1.0 - s) + w * (1.0 - (3.0 - 2.0 * s) * s * s)
        over = ops.maximum(size - zero, 0.0) / zero
        left = ops.maximum(end - size, 0.0) / (end - zero)
        return self.trail * (before - (1.0 - w) * over * ops.minimum(left * left, 1.0))


def _at_load(points: Points, load: Scalar) -> Curve:
    """Return a curve at a load over the nominal load."""

    def force(pair: tuple[float, float]) -> Scalar:
        one, two = pair
        return load * (2.0 * one - 0.5 * two - (one - 0.5 * two) * load)

    return Curve(
        force(points.slope),
        _on_line(points.peak_slip, load),
        force(points.peak_force),
        _on_line(points.sliding_slip, load),
        force(points.sliding_force),
    )


def _combined(along: Curve, across: Curve, slip: Scalar, side: Scalar) -> tuple[Scalar, Scalar]:
    """Return the forces by the curve in the direction of the normalised slip."""
    reach = [curve.peak_force / curve.slope for curve in (along, across)]
    peaks = along.peak_slip + across.peak_slip
    norms = [
        curve.peak_slip / peaks + part / (reach[0] + reach[1])
        for curve, part in zip((along, across), reach, strict=True)
    ]
    x, y = slip / norms[0], side / norms[1]
    size = ops.smooth_norm(x, y, SLIP_FLOOR)
    cosine, sine = x / size, y / size

    def between(one: Scalar, other: Scalar) -> Scalar:
        return ops.smooth_norm(one * cosine, other * sine, 1e-9 * (one + other))

    curve = Curve(
        between(along.slope * norms[0], across.slope * norms[1]),
        between(along.peak_slip / norms[0], across.peak_slip / norms[1]),
        between(along.peak_force, across.peak_force),
        between(along.sliding_slip / norms[0], across.sliding_slip / norms[1]),
        between(along.sliding_force, across.sliding_force),
    )
    force = curve.force(size)
    return force * cosine, force * sine
