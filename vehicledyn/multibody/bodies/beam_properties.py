"""Mass and stiffness of the sections of a beam, the same everywhere or changing over its length."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodies.beam_sections import Section
from vehicledyn.multibody.bodies.beam_shapes import quadrature
from vehicledyn.multibody.model.declaration import choice, number
from vehicledyn.symbolic.ops import Scalar

_MOST_POISSON = 0.5

TAPER_POINTS = 4
"""Further points of a quadrature that numbers of the fourth degree in the place need."""


@dataclass(frozen=True, kw_only=True)
class Modes:
    """Number of modes in each direction; none lets the beam be rigid in it."""

    y: int = choice("Modes of bending along y", default=0, least=0)
    z: int = choice("Modes of bending along z", default=0, least=0)
    twist: int = choice("Modes of twist", default=0, least=0)
    stretch: int = choice("Modes of stretch", default=0, least=0)
    shear_y: int = choice("Modes of shear along y, of an exact beam", default=0, least=0)
    shear_z: int = choice("Modes of shear along z, of an exact beam", default=0, least=0)


@dataclass(frozen=True, kw_only=True)
class Material:
    """An isotropic, linearly elastic material."""

    density: Scalar = number("kg/m^3", "Density", above=0.0)
    young: Scalar = number("Pa", "Young's modulus E", above=0.0)
    poisson: Scalar = number("1", "Poisson's ratio", default=0.3, least=0.0)

    def __post_init__(self) -> None:
        """Refuse a ratio at which a pressed body would grow."""
        if isinstance(self.poisson, int | float) and not -1.0 < self.poisson <= _MOST_POISSON:
            raise InputError(
                f"material.poisson: {self.poisson:g} is of no material; it is at most "
                f"{_MOST_POISSON:g}, as of rubber, and 0.3 of steel"
            )


@dataclass(frozen=True, kw_only=True)
class Stiffness:
    """Stiffness and mass of a beam whose section is given by them."""

    mass_per_length: Scalar = number("kg/m", "Mass over length", above=0.0)
    y: Scalar = number("N*m^2", "E I for deflections along y", default=0.0, least=0.0)
    z: Scalar = number("N*m^2", "E I for deflections along z", default=0.0, least=0.0)
    twist: Scalar = number("N*m^2", "Torsion stiffness G J", default=0.0, least=0.0)
    stretch: Scalar = number("N", "Axial stiffness E A", default=0.0, least=0.0)
    shear_y: Scalar = number("N", "Shear stiffness along y", default=0.0, least=0.0)
    shear_z: Scalar = number("N", "Shear stiffness along z", default=0.0, least=0.0)
    polar: Scalar = number(
        "kg*m", "Inertia of the sections about the axis, over length", default=0.0, least=0.0
    )
    rotary_y: Scalar = number(
        "kg*m", "The same for the turns of bending along y", default=0.0, least=0.0
    )
    rotary_z: Scalar = number(
        "kg*m", "The same for the turns of bending along z", default=0.0, least=0.0
    )


@dataclass(frozen=True)
class Properties:
    """Stiffness and mass at the start of a beam and, where they change, at any place.

    ``along`` takes a place over the length, 0 to 1; it may be asked a little beyond the ends.
    """

    start: Stiffness
    along: Callable[[float], Stiffness] | None = None

    @property
    def is_uniform(self) -> bool:
        """Whether all sections are alike."""
        return self.along is None

    def at(self, place: float) -> Stiffness:
        """Return the numbers of the section at a place."""
        return self.start if self.along is None else self.along(place)

    def weighted(self, name: str, points: int = 0) -> list[tuple[float, Scalar]]:
        """Return places and weights whose sum Σ weight f(place) is ∫ number(ξ) f(ξ) dξ.

        Parameters
        ----------
        name
            Which number.
        points
            Points of a Gauss quadrature that integrate f alone.
        """
        places, weights = quadrature(points + TAPER_POINTS)
        return [
            (float(x), float(weight) * getattr(self.at(float(x)), name))
            for x, weight in zip(places, weights, strict=True)
        ]

    def mean(self, name: str) -> Scalar:
        """Return the mean of a number over the length."""
        if self.is_uniform:
            return getattr(self.start, name)
        total: Scalar = 0.0
        for _, weight in self.weighted(name):
            total = total + weight
        return total

    def slope(self, name: str, place: float) -> Scalar:
        """Return the derivative of a number by the place.

        Differences of five points are exact for numbers up to the fourth degree, such as the
        moments of area of sections whose sizes change linearly.
        """
        if self.is_uniform:
            return 0.0
        h = _APART
        far, near = (
            getattr(self.at(place + k * h), name) - getattr(self.at(place - k * h), name)
            for k in (2, 1)
        )
        return (8.0 * near - far) / (12.0 * h)


_APART = 0.125


def section_stiffness(section: Section, material: Material) -> Stiffness:
    """Return stiffness and mass of a section of a material."""
    s, m = section.numbers, material
    shear = m.young / (2.0 * (1.0 + m.poisson))
    carried = shear * section.shear_factor(m.poisson) * s.area
    return Stiffness(
        mass_per_length=m.density * s.area,
        y=m.young * s.along_y,
        z=m.young * s.along_z,
        twist=shear * s.torsion,
        stretch=m.young * s.area,
        shear_y=carried,
        shear_z=carried,
        polar=m.density * (s.along_y + s.along_z),
        rotary_y=m.density * s.along_y,
        rotary_z=m.density * s.along_z,
    )


def tapered_section(start: Section, end: Section, place: float) -> Section:
    """Return the section at a place between two whose sizes change linearly."""
    sizes = {
        item.name: getattr(start, item.name)
        + place * (getattr(end, item.name) - getattr(start, item.name))
        for item in fields(start)
        if item.name != "shape"
    }
    return Section(shape=start.shape, **sizes)


def tapered_stiffness(start: Stiffness, end: Stiffness, place: float) -> Stiffness:
    """Return numbers at a place between two sections, each changing linearly."""
    return Stiffness(
        **{
            item.name: getattr(start, item.name)
            + place * (getattr(end, item.name) - getattr(start, item.name))
            for item in fields(start)
        }
    )
