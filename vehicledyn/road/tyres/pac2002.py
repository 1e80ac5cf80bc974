"""PAC2002 by tyre property file."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

from vehicledyn.base.registry import register
from vehicledyn.road.tyre_files.tyre_file import TURNED
from vehicledyn.road.tyres.file_tyre import OF_CHRONO, FileTyre, convention_of
from vehicledyn.road.tyres.pacejka.coefficient_values import Coefficients
from vehicledyn.road.tyres.pacejka.formula_52 import forces_52
from vehicledyn.road.tyres.pacejka.formula_chrono import (
    forces_chrono,
    lengths_chrono,
    on_a_chrono_vehicle,
)
from vehicledyn.road.tyres.tyre import RelaxationLengths, TyreForces, TyreInput
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


@register("tyre", "pac2002")
class Pac2002(FileTyre):
    """PAC2002; see :mod:`vehicledyn.road.tyres.pacejka.formula_52`.

    Conventions: "standard" takes tan α and sin γ, "angles" takes α and γ, "chrono" follows
    Chrono::Vehicle (:mod:`vehicledyn.road.tyres.pacejka.formula_chrono`), "chrono_vehicle" also
    feeds the formula as that program does on a car: without camber, with slips over the speed
    plus 0.1 m/s, and with the side of the file taken the other way round; its wheels roll without
    resistance.
    """

    versions: ClassVar[tuple[str, ...]] = ("pac2002", "5.2")

    def steady_forces(self, p: Coefficients, contact: TyreInput) -> TyreForces:
        """Return the forces of a tyre that is not mirrored."""
        chosen = convention_of(self, ("standard", "angles", "chrono", "chrono_vehicle"))
        combined = self.combined or self._combined_of_file()
        if chosen in OF_CHRONO and self.content.turned:  # it turns the friction alone
            p = p.changed(**{name: -getattr(p, name) for name in TURNED[2:]})
        if chosen == "chrono_vehicle":
            found = forces_chrono(p, on_a_chrono_vehicle(contact), combined)
            return replace(found, rolling_resistance=0.0)
        if chosen == "chrono":
            return forces_chrono(p, contact, combined)
        return forces_52(p, contact, angles=chosen == "angles", ellipse=self.ellipse)

    def relaxation_lengths(self, contact: TyreInput) -> RelaxationLengths:
        """Return the lengths by the file's coefficients, in the convention of the tyre."""
        if self.convention in OF_CHRONO:
            return lengths_chrono(self.coefficients(), contact)
        return super().relaxation_lengths(contact)

    def rolling_radius(self, radius: Scalar, loaded_radius: Scalar, camber: Scalar) -> Scalar:
        """Return the loaded radius r; by Chrono, unless chosen, (2 R + r)/(3 cos γ) [m].

        Its contact frame, which is not of unit size where wheels lean, brings in the cosine; runs
        of its sedan and HMMWV agree to 1e-7 m.
        """
        loaded = super().rolling_radius(radius, loaded_radius, camber)
        if self.convention not in OF_CHRONO or self.rolling is not None:
            return loaded
        return (2.0 * radius + loaded) / (3.0 * ops.cos(camber))

    def mounted(self, side: str) -> FileTyre:
        """Return the tyre on a side of the car, on the other one where Chrono mounts it so."""
        if self.convention == "chrono_vehicle":
            side = {"left": "right", "right": "left"}.get(side, side)
        return super().mounted(side)

    def _combined_of_file(self) -> str:
        content = self.content
        if self.forces_that_act != "combined":
            return "none"
        return "pacejka" if content.texts.get("FE_METHOD", "").upper() == "NO" else "ellipse"
