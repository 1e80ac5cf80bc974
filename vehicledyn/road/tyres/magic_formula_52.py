"""Magic Formula 5.2 by tyre property file."""

from __future__ import annotations

from typing import ClassVar

from vehicledyn.base.registry import register
from vehicledyn.road.tyres.file_tyre import FileTyre, convention_of
from vehicledyn.road.tyres.pacejka.coefficient_values import Coefficients
from vehicledyn.road.tyres.pacejka.formula_52 import forces_52
from vehicledyn.road.tyres.tyre import TyreForces, TyreInput


@register("tyre", "magic_formula_52")
class MagicFormula52(FileTyre):
    """Magic Formula 5.2; see :mod:`vehicledyn.road.tyres.pacejka.formula_52`.

    Conventions: "standard" takes tan α and sin γ, "angles" takes α and γ.
    """

    versions: ClassVar[tuple[str, ...]] = ("5.2",)

    def steady_forces(self, p: Coefficients, contact: TyreInput) -> TyreForces:
        """Return the forces of a tyre that is not mirrored."""
        chosen = convention_of(self, ("standard", "angles"))
        return forces_52(p, contact, angles=chosen == "angles", ellipse=self.ellipse)
