"""A beam of rigid segments with springs between them: an assembly of ordinary bodies and joints.

Each of n joints stands for the part h = L/n of the length, with the stiffness E I / h, and G J / h
and E A / h, so that rotation and deflection of the end under a constant bending moment are those of
the beam. Pairs of joints stand at the two Gauss points of their 2 h: deflections under end forces
and even loads are exact too, and frequencies converge with the fourth power of n. Joints in the
middles of their parts would leave errors of 1/(4 n²).

Segments do not stretch, but move as steps along a slope: where the beam has the velocity v and the
rate of strain r, a segment has v - r s, s counted from where both agree. With the joints at Gauss
points the integral of v r s cancels over a pair to the fourth order; what remains of the kinetic
energy is a surplus of ½ c q̇² a joint, q̇ = h r, with c = μ ∫ s² ds / h² = μ h (2 - √3)/3. So the
coordinates of stretch have the reflected inertia -c, and those of twist the same of the polar
inertia. It changes neither weights nor forces at rest.

Nor do segments bend: what is beyond a joint of angle q is drawn back by ½ c q² more than the bent
axis would draw it, with the same s² dx in c. No places of the joints avoid it: where deflections
are exact the squared slope of straight segments exceeds that of the axis by the square of their
difference. So the bending joints of a straight beam shift what is beyond them by ½ c q² along the
segment before them; one of each four does so for all, the middle one nearest to the next four.

Where segments bend in both planes and twist, the strains of a place are the rotation vector of its
three joints over h: by it a section turns evenly from one end of its part to the other, whatever
the order of the joints. What remains is how the twist varies over the part that a joint stands for.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from vehicledyn.multibody.bodies.beam_properties import TAPER_POINTS, Properties
from vehicledyn.multibody.bodies.beam_shapes import SPARE, assumed_shapes, quadrature
from vehicledyn.multibody.bodies.curved_axis import CurvedAxis
from vehicledyn.multibody.joints.bend import BEND
from vehicledyn.multibody.model.bodies import Body, Joint, Turn
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

_JOINTS = {
    "stretch": ("T1", "stretch"),
    "twist": ("R1", "twist"),
    "z": ("R2", "z"),
    "y": ("R3", "y"),
}
"""Joint and name of the coordinate by which a segment yields in each direction."""

_TURNS = ("twist", "z", "y")
"""Directions in which segments turn, about their first, second and third axis."""

_BENDS = {"z": 2, "y": 3}
"""Axis about which a segment turns as it bends in each direction."""

_SURPLUS = (2.0 - math.sqrt(3.0)) / 3.0
"""Mean of s² over h², of pairs of joints at Gauss points: (a³ + b³)/24 with a = 2/√3, b = 2 - a."""

_LAST_SURPLUS = 1.0 / 12.0
"""The same of an odd joint in the middle of its part."""

_LAST_KINK = 1.0 / 6.0
"""What such a joint draws back too much: c over h."""

_CARRIED = {"stretch": "mass", "twist": "inertia"}
"""Directions in which segments move in steps, and what of them does so."""

_MOST = 0.24
"""Most of the inertia of a segment that a joint at either end takes, twice that of a half one.

Beams whose sections change so much that this counts keep a positive definite mass matrix: it needs
that both ends of a segment take less than half of it together.
"""

_SHARED = 4
"""Joints of which one shifts for all."""

_FIRST = 3.5160152685
"""ω L² √(μ / E I) of the first mode of a clamped beam."""


@dataclass(frozen=True)
class SegmentedBeam:
    """Segments of a beam; ``yields`` are the directions in which it does.

    Those of a curved beam are rigid arcs of its ``axis``, which is None for a straight one.
    """

    name: str
    length: Scalar
    properties: Properties
    yields: Collection[str]
    count: int
    axis: CurvedAxis | None = None

    @property
    def names(self) -> list[str]:
        """Names of the segments: the clamped half one, whole ones and another half one."""
        return [f"{self.name}.segment_{k + 1}" for k in range(self.count + 1)]

    @property
    def joints(self) -> list[float]:
        """Places of the joints over the length; a last odd one is in the middle of its part."""
        half = 1.0 / self.count
        found = []
        for k in range(self.count // 2):
            middle = (2 * k + 1) * half
            found += [middle - half / math.sqrt(3.0), middle + half / math.sqrt(3.0)]
        return found if self.count % 2 == 0 else [*found, 1.0 - 0.5 * half]

    def _ends(self, index: int) -> tuple[float, float]:
        """Return where a segment starts and ends over the length."""
        edges = [0.0, *self.joints, 1.0]
        return edges[index], edges[index + 1]

    def bodies(
        self,
        body: str,
        at: Sequence[Scalar],
        turns: tuple[Turn, ...],
        frames: Mapping[str, float],
    ) -> tuple[Body, ...]:
        """Return the segments and the frames at places over the length."""
        found = []
        for index, name in enumerate(self.names):
            start, end = self._ends(index)
            shift, turn = self._step(self._ends(index - 1)[0], start) if index else (at, ())
            found.append(
                Body(
                    name,
                    self.names[index - 1] if index else body,
                    shift,
                    (*turn, *self._joints(index)) if index else turns,
                    **self._inertia(start, end),
                    apparent_inertia=True,
                )
            )
        for name, place in frames.items():
            index = sum(joint <= place for joint in self.joints)
            local, turn = self._step(self._ends(index)[0], place)
            found.append(Body(name, self.names[index], local, turn))
        return tuple(found)

    def _step(self, start: float, end: float) -> tuple[Sequence[Scalar], tuple[Turn, ...]]:
        """Return the way along a segment from one place to another, and the turn on it."""
        if self.axis is None:
            return ((end - start) * self.length, 0.0, 0.0), ()
        way, turn = self.axis.between(start, end)
        return tuple(way[k] for k in range(3)), (Turn(turn),)

    def _inertia(self, start: float, end: float) -> dict[str, Any]:
        """Return mass, centre of mass and inertia of a segment."""
        reach, numbers = (end - start) * self.length, self.properties
        if self.axis is not None:
            mass, polar = numbers.start.mass_per_length * reach, numbers.start.polar * reach
            com, inertia = self.axis.inertia(end - start, mass, polar)
            return {"mass": mass, "com": com, "inertia": inertia}
        mass, centre, polar, across = self._straight_inertia(start, end)
        return {"mass": mass, "com": (centre, 0.0, 0.0), "inertia": (polar, across, across)}

    def _straight_inertia(self, start: float, end: float) -> tuple[Scalar, Scalar, Scalar, Scalar]:
        """Return mass, centre of mass, and inertia about the axis and across of a segment."""
        reach, numbers = (end - start) * self.length, self.properties
        if numbers.is_uniform:
            mass = numbers.start.mass_per_length * reach
            across = mass * reach * reach / 12.0
            return mass, 0.5 * reach, numbers.start.polar * reach, across
        moments: list[Scalar] = [0.0, 0.0, 0.0]
        polar: Scalar = 0.0
        for x, weight in zip(*quadrature(1 + TAPER_POINTS), strict=True):
            here, own = float(x) * reach, numbers.at(start + float(x) * (end - start))
            part = float(weight) * reach
            for power in range(3):
                moments[power] = moments[power] + part * own.mass_per_length * here**power
            polar = polar + part * own.polar
        centre = moments[1] / moments[0]
        return moments[0], centre, polar, moments[2] - moments[0] * centre * centre

    def _joints(self, index: int) -> tuple[Joint, ...]:
        """Return the joints at a place, at every other one in the reverse order.

        Where all had the same order each twist would act on its bending or not at all, where half
        of it does: an error of 1/n. Springs that see the rotation vector make it half at each.
        """
        reach = self._given_back(index)
        found = []
        for direction, (kind, word) in _JOINTS.items():
            if direction not in self.yields:
                continue
            shifts = bool(reach) and direction in _BENDS
            settings = {"axis": _BENDS[direction], "reach": reach * self.length} if shifts else {}
            found.append(
                Joint(
                    BEND if shifts else kind,
                    f"{self.name}.{word}_{index}",
                    description=f"Joint {index} of {self.name}, {direction}",
                    reflected_inertia=-self._surplus(direction, index),
                    settings=settings,
                )
            )
        return tuple(reversed(found) if index % 2 else found)

    def _given_back(self, index: int) -> float:
        """Return c over the length by which a joint shifts for itself and others beside it."""
        if self.axis is not None:
            return 0.0
        first = index - (index - 1) % _SHARED
        last = min(first + _SHARED - 1, self.count)
        is_even = (first // _SHARED) % 2 == 0
        if index != min(first + (1 if is_even else 2), last):
            return 0.0
        parts = [_LAST_KINK if self._is_odd(k) else _SURPLUS for k in range(first, last + 1)]
        return sum(parts) / self.count

    def _is_odd(self, index: int) -> bool:
        """Return whether a joint is a last one in the middle of its part."""
        return index == self.count and self.count % 2 == 1

    def _surplus(self, direction: str, index: int) -> Scalar:
        """Return the inertia by which segments that move in steps have too much at a joint."""
        if direction not in _CARRIED:
            return 0.0
        place = self.joints[index - 1]
        share = _LAST_SURPLUS if self._is_odd(index) else _SURPLUS
        here, step = self.properties.at(place), self.length / self.count
        found = share * step * (here.polar if direction == "twist" else here.mass_per_length)
        if self.properties.is_uniform:
            return found
        for segment in (index - 1, index):
            own = self._inertia(*self._ends(segment))
            whole = own["inertia"][0] if direction == "twist" else own["mass"]
            is_half = segment in (0, self.count)
            found = ops.minimum(found, (2.0 if is_half else 1.0) * _MOST * whole)
        return found

    def energy(self, kinematics: Kinematics) -> Scalar:
        """Return the energy of the springs [J]."""
        total = ops.scalar(0.0)
        for index in range(1, self.count + 1):
            places = self._coordinates(index, kinematics.coordinate)
            for direction, strain in self._strains(index, places).items():
                total = total + 0.5 * self._spring(direction, index) * strain * strain
        return total

    def _coordinates(self, index: int, value: Callable[[str], Scalar]) -> dict[str, Scalar]:
        """Return the value of each joint at a place, such as its coordinate, by direction."""
        return {
            d: value(f"{self.name}.{w}_{index}")
            for d, (_, w) in _JOINTS.items()
            if d in self.yields
        }

    def _slopes(self, index: int, places: dict[str, Scalar]) -> dict[tuple[str, str], Scalar]:
        """Return the derivatives of the strains at a place by coordinates that differ from 1 and 0.

        Turns a, b, c one after the other have the rotation vector (a + ½ b c, b - ½ a c, c + ½ a b)
        to the second order, those in the reverse order the same with other signs.
        """
        sign = -0.5 if index % 2 else 0.5
        found = {}
        for k, direction in enumerate(_TURNS):
            one, other = _TURNS[(k + 1) % 3], _TURNS[(k + 2) % 3]
            if {direction, one, other} <= places.keys():
                half = -sign if k == 1 else sign
                found[direction, one] = half * places[other]
                found[direction, other] = half * places[one]
        return found

    def _strains(self, index: int, places: dict[str, Scalar]) -> dict[str, Scalar]:
        """Return the stretch and the components of the rotation vector at a place."""
        found = dict(places)
        for (direction, by), slope in self._slopes(index, places).items():
            found[direction] = found[direction] + 0.5 * slope * places[by]
        return found

    def _spring(self, direction: str, index: int) -> Scalar:
        """Return the stiffness of a joint: that of the section where it stands, over its part."""
        numbers = self.properties.at(self.joints[index - 1])
        return getattr(numbers, direction) * self.count / self.length

    def forces(self, kinematics: Kinematics, damping: Scalar) -> dict[str, Scalar]:
        """Return the forces of the springs and dampers on the coordinates [N or N m].

        The dampers are to the springs as gives the first bending mode its damping ratio.
        """
        bending = [d for d in ("z", "y") if d in self.yields]
        pace = self._pace(bending[-1]) if bending else 1.0
        delay = 2.0 * damping * self.length**2 / pace
        found: dict[str, Scalar] = {}
        for index in range(1, self.count + 1):
            places = self._coordinates(index, kinematics.coordinate)
            rates = self._coordinates(index, kinematics.rate)
            slopes = self._slopes(index, places)
            strains, paces = self._strains(index, places), dict(rates)
            for (direction, by), slope in slopes.items():
                paces[direction] = paces[direction] + slope * rates[by]
            loads = {
                direction: -self._spring(direction, index) * (strain + delay * paces[direction])
                for direction, strain in strains.items()
            }
            total = dict(loads)
            for (direction, by), slope in slopes.items():
                total[by] = total[by] + slope * loads[direction]
            found |= {f"{self.name}.{_JOINTS[d][1]}_{index}": load for d, load in total.items()}
        return found

    def _pace(self, direction: str) -> Scalar:
        """Return ω L² of the first bending mode; of a tapered beam by Rayleigh's quotient."""
        numbers = self.properties
        if numbers.is_uniform:
            modulus = getattr(numbers.start, direction)
            return _FIRST * ops.sqrt(modulus / numbers.start.mass_per_length)
        shape = assumed_shapes(1, 2, SPARE)
        stiff: Scalar = 0.0
        inert: Scalar = 0.0
        for x, weight in numbers.weighted(direction, shape.points):
            stiff = stiff + weight * float(shape.values(x, 2)[0]) ** 2
        for x, weight in numbers.weighted("mass_per_length", shape.points):
            inert = inert + weight * float(shape.values(x)[0]) ** 2
        return ops.sqrt(stiff / inert)
