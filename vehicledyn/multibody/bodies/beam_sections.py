"""Sections of beams: area, moments of area and torsion constant of common shapes."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Literal

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.model.declaration import choice, number
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

_NEEDED = {
    "circle": ("radius",),
    "tube": ("radius", "thickness"),
    "rectangle": ("width", "height"),
    "i_section": ("width", "height", "web", "flange"),
}
_TERMS = 7


@dataclass(frozen=True)
class SectionNumbers:
    """Area [m²], moments of area for deflections along y and z, and torsion constant [m⁴]."""

    area: Scalar
    along_y: Scalar
    along_z: Scalar
    torsion: Scalar


@dataclass(frozen=True, kw_only=True)
class Section:
    """Shape of the section; y is across its width, z across its height."""

    shape: Literal["circle", "tube", "rectangle", "i_section"] = choice("Shape of the section")
    radius: Scalar = number("m", "Outer radius of a circle or tube", default=0.0, least=0.0)
    thickness: Scalar = number("m", "Thickness of the wall of a tube", default=0.0, least=0.0)
    width: Scalar = number("m", "Extent along y", default=0.0, least=0.0)
    height: Scalar = number("m", "Extent along z", default=0.0, least=0.0)
    web: Scalar = number("m", "Thickness of the web of an I-section", default=0.0, least=0.0)
    flange: Scalar = number("m", "Thickness of its flanges", default=0.0, least=0.0)

    def __post_init__(self) -> None:
        """Refuse numbers that the shape lacks or does not have."""
        needed = _NEEDED[self.shape]
        for item in fields(self):
            value = getattr(self, item.name)
            if item.name == "shape":
                continue
            given = not (isinstance(value, int | float) and value == 0.0)
            if item.name in needed and not given:
                raise InputError(f"section: a {self.shape} needs its {' and '.join(needed)}")
            if item.name not in needed and given:
                raise InputError(
                    f"section: a {self.shape} has no {item.name}; it has {' and '.join(needed)}"
                )
        if self.shape == "tube":
            _refuse_excess("thickness", self.thickness, "the radius", self.radius)
        if self.shape == "i_section":
            _refuse_excess("web", self.web, "the width", self.width)
            _refuse_excess("flange", self.flange, "half of the height", 0.5 * self.height)

    @property
    def numbers(self) -> SectionNumbers:
        """Area and moments of area."""
        if self.shape == "rectangle":
            b, h = self.width, self.height
            return SectionNumbers(b * h, h * b**3 / 12.0, b * h**3 / 12.0, _rectangle_torsion(b, h))
        if self.shape == "i_section":
            return self._i_section()
        inner = self.radius - self.thickness if self.shape == "tube" else 0.0
        quarter = math.pi / 4.0 * (self.radius**4 - inner**4)
        area = math.pi * (self.radius**2 - inner**2)
        return SectionNumbers(area, quarter, quarter, 2.0 * quarter)

    @property
    def reach(self) -> tuple[Scalar, Scalar]:
        """Distance of the outermost fibre from the axis along y and z [m]."""
        if self.shape in ("circle", "tube"):
            return self.radius, self.radius
        return 0.5 * self.width, 0.5 * self.height

    def shear_factor(self, poisson: Scalar) -> Scalar:
        """Return the part of the area that carries shear (Cowper 1966, J. Appl. Mech. 33) [1]."""
        if self.shape == "rectangle":
            return 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson)
        if self.shape == "circle":
            return 6.0 * (1.0 + poisson) / (7.0 + 6.0 * poisson)
        if self.shape == "tube":
            return 2.0 * (1.0 + poisson) / (4.0 + 3.0 * poisson)
        return self.web * self.height / self.numbers.area

    def _i_section(self) -> SectionNumbers:
        """Return those of two flanges and a web; torsion of thin open walls, Σ l t³/3."""
        b, h, web, flange = self.width, self.height, self.web, self.flange
        clear = h - 2.0 * flange
        return SectionNumbers(
            2.0 * b * flange + clear * web,
            (2.0 * flange * b**3 + clear * web**3) / 12.0,
            (b * h**3 - (b - web) * clear**3) / 12.0,
            (2.0 * b * flange**3 + (h - flange) * web**3) / 3.0,
        )


def _refuse_excess(name: str, size: Scalar, whole: str, most: Scalar) -> None:
    """Refuse a wall that is thicker than the section that it is part of; numbers alone."""
    if isinstance(size, int | float) and isinstance(most, int | float) and size > most:
        raise InputError(
            f"section: its {name} of {size:g} m is more than {whole}, {most:g} m; make it thinner"
        )


def _rectangle_torsion(width: Scalar, height: Scalar) -> Scalar:
    """Return the torsion constant of a rectangle by Saint-Venant's series [m⁴].

    Timoshenko, Goodier, Theory of Elasticity, article 109: with a ≥ b
    J = a b³ (1/3 - 64/π⁵ b/a Σ tanh(n π a / 2 b)/n⁵), n odd.
    """
    a, b = ops.maximum(width, height), ops.minimum(width, height)
    series: Scalar = 0.0
    for n in range(1, 2 * _TERMS, 2):
        series = series + ops.tanh(0.5 * n * math.pi * a / b) / n**5
    return a * b**3 * (1.0 / 3.0 - 64.0 / math.pi**5 * b / a * series)
