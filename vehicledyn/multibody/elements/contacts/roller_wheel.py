"""Universal wheels with their rollers as bodies, each in contact with the ground z = 0.

A roller is the envelope of balls with their centres along its axis u. The centre at s is
d(s) = √((R - r)² + s² sin² γ) from the axle, and its ball touches from inside the cylinder of
radius R about the axle: so the rollers make this cylinder exactly, at any angle γ. The roller is
lowest on the ball where u_z + s sin² γ / d(s) = 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.base.shapes import Anchor, Plane, Shape, Wheel
from vehicledyn.multibody.elements.contacts.touch import Touch, pair_of_forces, sliding
from vehicledyn.multibody.elements.universal_wheel import FEWEST_ROLLERS
from vehicledyn.multibody.model.bodies import Body, Joint, Turn
from vehicledyn.multibody.model.declaration import ORIGIN, body_name, choice, number, vector
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation, Wrench
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.labels import unlabelled
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

_MOST_ROLLERS = 100


@register("element_type", "roller_wheel")
@dataclass(frozen=True, kw_only=True)
class RollerWheel(BasePart):
    """The rollers of an omni or mecanum wheel as bodies on a hub, that touch the plane z = 0.

    Each has the force of Hunt and Crossley and friction, whose sliding falls off below a speed.
    """

    hub: str = body_name("The hub, which turns about its axis", may_be_ground=False)
    axis: Literal[1, 2, 3] = choice("Axis of the wheel in its body")
    radius: float = choice("Radius R over the rollers, in m", unit="m")
    rollers: int = choice("Number of rollers, at least 3")
    roller_angle: float = choice(
        "Angle γ from the axle to the roller's axis at the ground, in degrees",
        unit="deg",
        nature="handed",
    )
    roller_radius: float = choice("Radius r of the rollers at their middle, in m", unit="m")
    roller_mass: Scalar = number("kg", "Mass of a roller", above=0.0)
    centre: Sequence[Scalar] = vector(
        "m", "Centre of the wheel in the axes of the hub", default=ORIGIN
    )
    stiffness: Scalar = number("N/m", "Stiffness k of the contact of a roller", above=0.0)
    dissipation: Scalar = number("s/m", "Dissipation α", default=0.0, least=0.0)
    friction: Scalar = number("1", "Coefficient of friction μ", least=0.0)
    creep_speed: Scalar = number(
        "m/s", "Sliding speed below which friction falls off", default=1e-2, above=0.0
    )
    bearing: Scalar = number(
        "N*m*s/rad", "Damping of the bearing of a roller", default=0.0, least=0.0
    )

    def __post_init__(self) -> None:
        """Refuse rollers that cannot be.

        Raises
        ------
        InputError
            If there are too few, or their ends have no radius.
        """
        if self.rollers < FEWEST_ROLLERS:
            raise InputError(
                f"rollers: {self.rollers} are too few; a wheel has at least {FEWEST_ROLLERS}"
            )
        if self.rollers > _MOST_ROLLERS:
            raise InputError(f"rollers: {self.rollers:g} are too many; at most {_MOST_ROLLERS}")
        if abs(math.sin(self._angle)) < 0.1:
            raise InputError("roller_angle: the rollers must not turn about the axle itself")
        if not 0.0 < self.roller_radius < self.radius:
            raise InputError("roller_radius: must be between zero and the radius of the wheel")
        if self._end_ball <= 0.0:
            raise InputError(
                f"rollers: {self.rollers} rollers of radius {1e3 * self.roller_radius:g} mm leave "
                "gaps between them, as they end in points; take more or thicker ones"
            )

    def added_bodies(self) -> tuple[Body, ...]:
        """Return the rollers; axis 1 of each is its own."""
        r, length = self.roller_radius, self._length
        across = self.roller_mass * (3.0 * r * r + length * length) / 12.0
        inertia = (0.5 * self.roller_mass * r * r, across, across)
        found = []
        for k, name in enumerate(self._names):
            outwards, axis = self._directions(k)
            at = [c + (self.radius - r) * p for c, p in zip(self.centre, outwards, strict=True)]
            spin = Joint("R1", f"{name}.spin", role="independent", description=f"Spin of {name}")
            joints = (Turn(_axes(axis, outwards)), spin)
            found.append(
                Body(
                    name,
                    self.hub,
                    tuple(at),
                    joints,
                    mass=self.roller_mass,
                    inertia=inertia,
                    spins_about=1,
                )
            )
        return tuple(found)

    def loads(self, situation: Situation) -> Loads:
        """Return the forces of the ground on the rollers, and the drag of their bearings."""
        wrenches: list[Wrench] = []
        torques: dict[str, Scalar] = {}
        for name in self._names:
            touch, force = self._contact(situation.kinematics, name)
            slip = sliding(situation.kinematics, (GROUND, name), touch)
            speed = ops.sqrt(ops.dot(slip, slip) + self.creep_speed * self.creep_speed)
            total = force * touch.normal - (self.friction * force / speed) * slip
            wrenches += pair_of_forces(situation.kinematics, (GROUND, name), touch, total)
            torques[f"{name}.spin"] = -self.bearing * situation.kinematics.rate(f"{name}.spin")
        return Loads(wrenches=tuple(wrenches), joint_forces=torques)

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the normal force of all rollers."""
        forces = [self._contact(situation.kinematics, name)[1] for name in self._names]
        words = f"Normal force of the ground on {self.name}"
        total: Scalar = sum(forces, start=ops.scalar(0.0))
        return (Output(Channel(f"{self.name}.normal_force", "N", words), total),)

    def shapes(self) -> tuple[Shape, ...]:
        """Return the rollers as short barrels, and the ground."""
        drawn: list[Shape] = [
            Wheel(
                n, Anchor(n), (1.0, 0.0, 0.0), self.roller_radius, 0.8 * self._length, style="disc"
            )
            for n in self._names
        ]
        return (*drawn, Plane("ground", (0.0, 0.0, 0.0)))

    @property
    def _names(self) -> list[str]:
        return [f"{self.name}.roller_{k + 1}" for k in range(self.rollers)]

    @property
    def _angle(self) -> float:
        return math.radians(self.roller_angle)

    @property
    def _half(self) -> float:
        """Place along the axis of the ball that touches where neighbours meet [m]."""
        part = math.tan(math.pi / self.rollers) / abs(math.sin(self._angle))
        return (self.radius - self.roller_radius) * part

    @property
    def _end_ball(self) -> float:
        """Radius of that ball [m]."""
        return self.radius - (self.radius - self.roller_radius) / math.cos(math.pi / self.rollers)

    @property
    def _length(self) -> float:
        """Length of a roller between the circles on which it meets its neighbours [m]."""
        lean = abs(math.sin(self._angle)) * math.sin(math.pi / self.rollers)
        return 2.0 * (self._half + self._end_ball * lean)

    def _directions(self, k: int) -> tuple[list[float], list[float]]:
        """Return outward direction and axis of a roller in the axes of the hub."""
        turn = 2.0 * math.pi * k / self.rollers
        c, s = math.cos(turn), math.sin(turn)
        first, second = self.axis % 3, (self.axis + 1) % 3
        outwards, around, axle = [0.0] * 3, [0.0] * 3, [0.0] * 3
        outwards[first], outwards[second] = c, s
        around[first], around[second] = -s, c
        axle[self.axis - 1] = 1.0
        # At the ground d = e × z is opposite to the sense of the spin there.
        cosine, sine = math.cos(self._angle), math.sin(self._angle)
        return outwards, [cosine * e - sine * t for e, t in zip(axle, around, strict=True)]

    def _contact(self, kinematics: Kinematics, name: str) -> tuple[Touch, Scalar]:
        """Return where a roller is lowest, and its normal force [N]."""
        centre = unlabelled(kinematics.position(name))
        axis = unlabelled(kinematics.rotation(name))[:, 0]
        upwards, sine = axis[2], math.sin(self._angle)
        middle = self.radius - self.roller_radius
        lean = upwards / sine
        cosine = ops.sqrt(ops.maximum(1.0 - lean * lean, 1e-12))
        along = -middle * lean / (sine * cosine)
        along = ops.minimum(ops.maximum(along, -self._half), self._half)
        ball = self.radius - ops.sqrt(middle * middle + (along * sine) ** 2)
        point: Vec = centre + along * axis - ops.vector(0.0, 0.0, ball)
        gap = point[2]
        rate = -kinematics.time_derivative(gap)
        force = self.stiffness * ops.maximum(-gap, 0.0)
        force = force * ops.maximum(1.0 + 1.5 * self.dissipation * rate, 0.0)
        return Touch(gap, ops.vector(0.0, 0.0, 1.0), point), force


def _axes(axis: Sequence[float], outwards: Sequence[float]) -> Mat:
    """Return the rotation whose columns are the axis, the third one across, and outwards."""
    x, z = list(axis), list(outwards)
    y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]]
    return ops.filled(3, 3, (*x, *y, *z))
