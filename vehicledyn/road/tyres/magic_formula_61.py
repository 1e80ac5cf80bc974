"""Magic Formula 6.1 by tyre property file."""

from __future__ import annotations

from typing import ClassVar

from vehicledyn.base.registry import register
from vehicledyn.road.tyres.file_tyre import FileTyre, convention_of
from vehicledyn.road.tyres.pacejka.coefficient_values import Coefficients
from vehicledyn.road.tyres.pacejka.formula_61 import RULES, forces_61
from vehicledyn.road.tyres.tyre import TyreForces, TyreInput


@register("tyre", "magic_formula_61")
class MagicFormula61(FileTyre):
    """Magic Formula 6.1; see :mod:`vehicledyn.road.tyres.pacejka.formula_61`.

    Conventions: "standard" takes α in pure side slip and in the moment, tan α in the weights of
    combined slip; "tangent" takes tan α throughout, "angles" α and γ; "mf_tyre_library" follows
    the moment and the rolling resistance of that program; "mf_eval" follows the public program
    MFeval, which was compared with MF-Tyre.
    """

    knows_turn_slip: ClassVar[bool] = True
    versions: ClassVar[tuple[str, ...]] = ("6.1",)

    def steady_forces(self, p: Coefficients, contact: TyreInput) -> TyreForces:
        """Return the forces of a tyre that is not mirrored."""
        rules = RULES[convention_of(self, tuple(RULES))]
        return forces_61(p, contact, rules, ellipse=self.ellipse)
