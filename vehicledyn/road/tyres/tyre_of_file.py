"""Tyre of a property file, by the law that the file itself names."""

from __future__ import annotations

from vehicledyn.base.registry import register
from vehicledyn.road.tyres.file_tyre import FileTyre
from vehicledyn.road.tyres.magic_formula_52 import MagicFormula52
from vehicledyn.road.tyres.magic_formula_61 import MagicFormula61
from vehicledyn.road.tyres.magic_formula_62 import MagicFormula62
from vehicledyn.road.tyres.pac2002 import Pac2002
from vehicledyn.road.tyres.pacejka.coefficient_values import Coefficients
from vehicledyn.road.tyres.tyre import RelaxationLengths, TyreForces, TyreInput
from vehicledyn.symbolic.ops import Scalar

_LAWS: dict[str, type[FileTyre]] = {
    "pac2002": Pac2002,
    "5.2": MagicFormula52,
    "6.1": MagicFormula61,
    "6.2": MagicFormula62,
}


@register("tyre", "file")
class TyreOfFile(FileTyre):
    """Tyre of a property file, by FITTYP or PROPERTY_FILE_FORMAT: 5.2, PAC2002, 6.1 or 6.2.

    ``tyres: {file: my.tir}`` is this kind.
    """

    def steady_forces(self, p: Coefficients, contact: TyreInput) -> TyreForces:
        """Return the forces of a tyre that is not mirrored."""
        return self.law.steady_forces(p, contact)

    def relaxation_lengths(self, contact: TyreInput) -> RelaxationLengths:
        """Return the lengths by the law of the file."""
        return self.law.relaxation_lengths(contact)

    def rolling_radius(self, radius: Scalar, loaded_radius: Scalar, camber: Scalar) -> Scalar:
        """Return the rolling radius by the law of the file."""
        return self.law.rolling_radius(radius, loaded_radius, camber)

    def mounted(self, side: str) -> FileTyre:
        """Return the tyre on a side of the car, by the law of the file."""
        mirror = self.law.mounted(side).mirror
        return self.model_copy(update={"mirror": mirror})

    @property
    def has_turn_slip(self) -> bool:
        """Whether the law of the file has turn slip and the file coefficients of it."""
        return self.law.has_turn_slip

    @property
    def law(self) -> FileTyre:
        """The law that the file names, with the settings of this tyre."""
        settings = {name: getattr(self, name) for name in type(self).model_fields}
        return _LAWS[self.content.version].model_construct(**settings)
