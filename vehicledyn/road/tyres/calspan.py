"""Calspan tyre law of the IAVSD Iltis benchmark: lateral force and aligning moment."""

from __future__ import annotations

from typing import ClassVar

from pydantic import ConfigDict

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.tyres.coefficients import read_coefficients
from vehicledyn.road.tyres.smooth import floored
from vehicledyn.road.tyres.tyre import Tyre, TyreForces, TyreInput
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

FORCE_FLOOR = 1.0
"""Least friction force that the side force is ever referred to [N]."""

FRICTION_FLOOR = 0.05
"""Least friction coefficient; the benchmark's fit reaches zero near 26 kN [1]."""

_ILTIS = read_coefficients("calspan_iltis")


@register("tyre", "calspan")
class Calspan(Tyre):
    """Calspan law: side force bent by a cubic towards friction; no longitudinal force.

    μ = (B1 F_z + B3 + B4 F_z²) SN,    C_α = A0 + A1 F_z - A1/A2 F_z²,

    α_γ = A3 F_z (1 - F_z/A4) γ / C_α,    ā = -C_α (α + α_γ) / (μ F_z),

    F_y = μ F_z (ā - ā|ā|/3 + ā³/27) for |ā| < 3, else ± μ F_z,

    M_z = (AF1 F_z + AF2 |F_y|) F_y.

    Beyond F_z = Ω_t A2 the stiffnesses C_α and C_γ keep their values there. The law has no
    longitudinal force: it is for free-rolling wheels, and the longitudinal slip has no effect.
    The published terms B2 and AF3 are zero and left out. Without other values the coefficients
    are those of the Iltis, file ``calspan_iltis.yaml``.

    References
    ----------
    Frik, Leister, Schwartz (1993), Vehicle System Dynamics 22 (Suppl.), 215-253, by way of
    a public model of the benchmark; the primary paper was not at hand.
    """

    friction_field: ClassVar[str] = "skid_number"

    model_config = ConfigDict(validate_default=True)

    a0: float = quantity("N/rad", "Cornering stiffness at no load", default=_ILTIS["a0"], gt=0)
    a1: float = quantity("1/rad", "Growth of it with load", default=_ILTIS["a1"], ge=0)
    a2: float = quantity("N", "Load where it is back at A0", default=_ILTIS["a2"], gt=0)
    a3: float = quantity("1/rad", "Camber stiffness per load", default=_ILTIS["a3"])
    a4: float = quantity("N", "Load where camber has no effect", default=_ILTIS["a4"], gt=0)
    load_limit: float = quantity(
        "1",
        "Ω_t, part of A2 from which the stiffnesses stay constant",
        default=_ILTIS["load_limit"],
        gt=0,
        le=1,
    )
    b1: float = quantity("1/N", "Change of friction with load", default=_ILTIS["b1"])
    b3: float = quantity("1", "Friction at no load", default=_ILTIS["b3"], gt=0)
    b4: float = quantity("1/N^2", "Change with load squared", default=_ILTIS["b4"])
    skid_number: float = quantity(
        "1", "SN, friction of the road over that of the test", default=_ILTIS["skid_number"], gt=0
    )
    af1: float = quantity("m/N", "Trail per load, negative", default=_ILTIS["af1"])
    af2: float = quantity("m/N", "Trail lost per side force", default=_ILTIS["af2"])

    def forces(self, contact: TyreInput) -> TyreForces:
        """Return side force and aligning moment; the longitudinal force is zero."""
        lateral = self._lateral_force(contact.normal_force, contact.slip_angle, contact.camber)
        arm = self.af1 * contact.normal_force + self.af2 * ops.absolute(lateral)
        return TyreForces(0.0, lateral, arm * lateral)

    def _lateral_force(self, load: Scalar, slip_angle: Scalar, camber: Scalar) -> Scalar:
        stiffness, camber_stiffness = self._stiffnesses(load)
        friction_force = self._friction(load) * load
        linear = -(stiffness * slip_angle + camber_stiffness * camber)
        ratio = linear / floored(friction_force, FORCE_FLOOR)
        a = ops.minimum(ops.maximum(ratio, -3.0), 3.0)
        return friction_force * (a - a * ops.absolute(a) / 3.0 + a * a * a / 27.0)

    def _stiffnesses(self, load: Scalar) -> tuple[Scalar, Scalar]:
        """Return C_α and C_γ = C_α α_γ/γ [N/rad]."""
        used = ops.minimum(load, self.load_limit * self.a2)
        cornering = self.a0 + self.a1 * used * (1.0 - used / self.a2)
        return cornering, self.a3 * used * (1.0 - used / self.a4)

    def _friction(self, load: Scalar) -> Scalar:
        fit = self.b1 * load + self.b3 + self.b4 * load * load
        return floored(fit * self.skid_number, FRICTION_FLOOR)
