"""Flexible bars: bending in one plane by assumed modes, clamped to a body at one end.

With ξ = x/L along the bar the deflection is w = Σ φ_k(ξ) η_k, where φ_k are the modes of a clamped
bar and η_k its coordinates [m]. The mass is gathered at the points ξ_j of a Gauss quadrature, which
move across by w and along by u = -½ ∫ (∂w/∂x)² dx, so that axial forces stiffen the bar: the
mass matrix couples η_k with each other and with the motion of the body, to second order in η. The
bar is thin: its sections have no inertia of their own, shear does not deform it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.multibody.model.bodies import Body, Joint
from vehicledyn.multibody.model.constraints import BaseConstraint, Constraint, Geometry
from vehicledyn.multibody.model.cuts import Residual
from vehicledyn.multibody.model.declaration import ORIGIN, body_name, choice, number, vector
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar

_ROOTS = (1.8751040687119611, 4.694091132974174, 7.854757438237612)
"""Roots of cos β cosh β = -1."""
_SPARE = 4
"""Points of the quadrature beyond the number of modes."""


@register("element_type", "flexible_bar")
@dataclass(frozen=True, kw_only=True)
class FlexibleBar(BasePart):
    """A thin bar clamped to a body, that lies along its first axis and bends in one plane.

    Further bodies may hang on its frames ``<name>.frame_1`` and so on. Deflections are small to
    the length; axial forces, as of fast rotation, stiffen it.
    """

    body: str = body_name("Body that it is clamped to, or ground")
    at: Sequence[Scalar] = vector("m", "Clamped end in the axes of the body", default=ORIGIN)
    length: Scalar = number("m", "Length L", above=0.0)
    mass_per_length: Scalar = number("kg/m", "Mass over length μ", above=0.0)
    bending_stiffness: Scalar = number("N*m^2", "Bending stiffness E I", above=0.0)
    damping_ratio: Scalar = number("1", "Damping ratio of each mode", default=0.0, least=0.0)
    bends_along: Literal["y", "z"] = choice("Axis of the deflection", default="z")
    modes: Literal[1, 2, 3] = choice("Number of modes", default=2)
    frames: tuple[float, ...] = choice(
        "Places over the length, 0 to 1, of frames that other bodies hang on", default=(), unit="1"
    )

    def __post_init__(self) -> None:
        """Refuse frames that are not on the bar."""
        outside = [place for place in self.frames if not 0.0 <= place <= 1.0]
        if outside:
            raise InputError(f"frames: {outside[0]:g} is not on the bar, from 0 to 1 of its length")

    def added_bodies(self) -> tuple[Body, ...]:
        """Return the coordinates, the points with the mass and the frames."""
        places, weights = _quadrature(self.modes + _SPARE)
        mass = [self.mass_per_length * self.length * weight for weight in weights]
        carriers = tuple(
            Body(
                f"{self.name}.carrier_{k + 1}",
                self.body,
                self.at,
                (self._joint(self._slide, name, "independent", f"Mode {k + 1} of {self.name}"),),
                is_abstract=True,
            )
            for k, name in enumerate(self._modes)
        )
        points = tuple(
            self._station(f"{self.name}.point_{j + 1}", place, mass[j])
            for j, place in enumerate(places)
        )
        frames = tuple(self._station(name, place, None) for name, place in self._frames)
        return (*carriers, *points, *frames)

    def added_constraints(self) -> tuple[Constraint, ...]:
        """Return what the modes make of the points and frames."""
        places, _ = _quadrature(self.modes + _SPARE)
        points = [(f"{self.name}.point_{j + 1}", place) for j, place in enumerate(places)]
        return (
            *(_OnBar(name, self, place, turns=False) for name, place in points),
            *(_OnBar(name, self, place, turns=True) for name, place in self._frames),
        )

    def loads(self, situation: Situation) -> Loads:
        """Return elastic and damping forces on the coordinates."""
        kinematics, forces = situation.kinematics, {}
        mass = self.mass_per_length * self.length
        for name, root in zip(self._modes, _ROOTS, strict=False):
            stiffness = self.bending_stiffness * root**4 / self.length**3
            damping = 2.0 * self.damping_ratio * ops.sqrt(stiffness * mass)
            place, rate = kinematics.coordinate(name), kinematics.rate(name)
            forces[name] = -stiffness * place - damping * rate
        return Loads(joint_forces=forces)

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the deflection of the end."""
        channel = Channel(f"{self.name}.tip", "m", f"Deflection of the end of {self.name}", "body")
        found = sum(
            shape * situation.kinematics.coordinate(name)
            for name, shape in zip(self._modes, _shapes(1.0, self.modes), strict=True)
        )
        return (Output(channel, found),)

    @property
    def _modes(self) -> list[str]:
        return [f"{self.name}.mode_{k + 1}" for k in range(self.modes)]

    @property
    def _frames(self) -> list[tuple[str, float]]:
        return [(f"{self.name}.frame_{j + 1}", place) for j, place in enumerate(self.frames)]

    @property
    def _slide(self) -> str:
        return "T3" if self.bends_along == "z" else "T2"

    def _station(self, name: str, place: float, mass: Scalar | None) -> Body:
        """Return a point of the bar, or with no mass a frame that turns with it."""
        x, y, z = self.at
        joints = [
            self._joint("T1", f"{name}.along", "dependent", f"Shortening at {name}"),
            self._joint(self._slide, f"{name}.across", "dependent", f"Deflection at {name}"),
        ]
        if mass is None:
            turn = "R2" if self.bends_along == "z" else "R3"
            joints.append(self._joint(turn, f"{name}.slope", "dependent", f"Slope at {name}"))
        at = (x + place * self.length, y, z)
        return Body(name, self.body, at, tuple(joints), mass=mass)

    def _joint(self, kind: str, name: str, role: str, text: str) -> Joint:
        return Joint(kind, name, role=role, description=text)


@dataclass(frozen=True)
class _OnBar(BaseConstraint):
    """A point of the bar moves as its modes say, across and along; a frame turns with it too."""

    bar: FlexibleBar
    place: float
    turns: bool

    def residuals(self, geometry: Geometry) -> list[Residual]:
        """Return deflection, shortening and slope less those of the modes."""
        bar, name = self.bar, self.name
        modes = [geometry.coordinate(mode) for mode in bar._modes]
        across = _weighted(_shapes(self.place, bar.modes), modes)
        metric = _shortening(self.place, bar.modes)
        along = -0.5 / bar.length * _weighted([_weighted(row, modes) for row in metric], modes)
        pairs = [("across", across, "m", "N"), ("along", along, "m", "N")]
        if self.turns:
            slope = _weighted(_slopes(self.place, bar.modes), modes) / bar.length
            sign = -1.0 if bar.bends_along == "z" else 1.0
            pairs.append(("slope", sign * slope, "rad", "N*m"))
        return [
            Residual(
                geometry.coordinate(f"{name}.{word}") - value,
                unit,
                f"{word}_load",
                force,
                f"Load of the bar at {name}, {word}",
            )
            for word, value, unit, force in pairs
        ]


def _weighted(factors: Sequence[Scalar] | NDArray[np.float64], values: Sequence[Scalar]) -> Scalar:
    total: Scalar = 0.0
    for factor, value in zip(factors, values, strict=True):
        total = total + factor * value
    return total


@lru_cache(maxsize=32)
def _quadrature(count: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return places from 0 to 1 and weights of the Gauss quadrature."""
    places, weights = np.polynomial.legendre.leggauss(count)
    return tuple(map(float, 0.5 * (1.0 + places))), tuple(map(float, 0.5 * weights))


def _shapes(place: float, modes: int) -> list[float]:
    """Return φ_k(ξ) with ∫ φ_k² dξ = 1."""
    found = []
    for b in _ROOTS[:modes]:
        x, s = b * place, _sigma(b)
        found.append(math.cosh(x) - math.cos(x) - s * (math.sinh(x) - math.sin(x)))
    return found


def _slopes(place: float, modes: int) -> list[float]:
    """Return dφ_k/dξ."""
    found = []
    for b in _ROOTS[:modes]:
        x, s = b * place, _sigma(b)
        found.append(b * (math.sinh(x) + math.sin(x) - s * (math.cosh(x) - math.cos(x))))
    return found


def _sigma(root: float) -> float:
    return (math.cosh(root) + math.cos(root)) / (math.sinh(root) + math.sin(root))


@lru_cache(maxsize=256)
def _shortening(place: float, modes: int) -> NDArray[np.float64]:
    """Return ∫ φ_i' φ_j' dξ from 0 to a place, shape (modes, modes)."""
    places, weights = _quadrature(24)
    slopes = np.array([_slopes(place * x, modes) for x in places])
    found: NDArray[np.float64] = place * (slopes.T * np.array(weights)) @ slopes
    return found
