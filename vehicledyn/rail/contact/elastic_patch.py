"""What an elastic contact of a wheel with its rail is, as expressions."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.rail.geometry.hertz import ContactEllipse, Hertz
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class ElasticPatch:
    """One elastic contact.

    Attributes
    ----------
    place, along
        Lateral coordinate on the wheel's profile, and length along it [m].
    x, y, z
        The point of the wheel; y counts from the middle of the track, on a curve square to the
        rail there [m].
    radius
        Rolling radius there [m].
    heading
        Angle by which the rail turns outwards up to there [rad].
    tangent, normal
        Unit vectors (y, z) across the rail outwards and out of the rail.
    approach
        δ, never negative [m].
    spread
        δ/B, half of which is the square of the semi-axis across of the overlap's parabola [m²].
    contact
        Hertz's contact of the curvatures.
    """

    place: Scalar
    along: Scalar
    x: Scalar
    y: Scalar
    z: Scalar
    radius: Scalar
    heading: Scalar
    tangent: tuple[Scalar, Scalar]
    normal: tuple[Scalar, Scalar]
    approach: Scalar
    spread: Scalar
    contact: Hertz

    @property
    def force(self) -> Scalar:
        """Elastic normal force, zero where nothing touches [N]."""
        return self.contact.force(self.approach)

    @property
    def ellipse(self) -> ContactEllipse:
        """Semi-axes of the contact."""
        return self.contact.ellipse_at(self.approach)

    @property
    def angle(self) -> Scalar:
        """Contact angle, positive where the rail rises outwards [rad]."""
        return ops.atan2(self.tangent[1], self.tangent[0])
