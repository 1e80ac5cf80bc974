"""Bodies and the chains of joints that carry them, as data."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from vehicledyn.base.registry import find
from vehicledyn.multibody.joints.joint_type import FAMILY, JointType, joint_type

if TYPE_CHECKING:
    from vehicledyn.multibody.model.deformation import Flexibility
    from vehicledyn.symbolic.ops import Mat, Scalar

ROLES = ("auto", "independent", "dependent", "driven")


@dataclass(frozen=True)
class Joint:
    """A joint with one coordinate.

    ``kind`` is its type in the catalogue: sliding along (T) or turning about (R) axis 1, 2 or 3,
    "T1" to "R3", or another one, such as "screw", whose numbers are the ``settings`` by name.
    ``name`` is the dotted name of its coordinate, ``start`` and ``start_rate`` the values it
    starts from [m, rad; m/s, rad/s]. ``role`` says whether the coordinate is a state, solved
    from the loops, prescribed in time, or left to the automatic partition ("auto").
    ``siblings`` are the names of all coordinates of a joint that has several, such as one of
    :func:`quaternion_joint`. ``reflected_inertia`` is an inertia I that only this coordinate
    feels, such as that of a motor's rotor through its gear: it adds I to the diagonal of the mass
    matrix, -I q̈ to the force along the coordinate and ½ I q̇² to the kinetic energy
    [kg, kg m²]. It is constant, and may be negative as long as the mass matrix is positive
    definite.
    """

    kind: str
    name: str
    start: float = 0.0
    role: str = "auto"
    start_rate: float = 0.0
    description: str = ""
    settings: dict[str, Any] = field(default_factory=dict, compare=False)
    siblings: tuple[str, ...] = ()
    reflected_inertia: Scalar = field(default=0.0, compare=False)

    @cached_property
    def type(self) -> JointType:
        """What the joint lets move."""
        return joint_type(self.kind, self.settings)

    @property
    def unit(self) -> str:
        """Unit of the coordinate; that of the speed where it is no position."""
        return self.type.elements[self.type.element].unit if self.siblings else self.type.unit

    @property
    def positions(self) -> tuple[str, ...]:
        """Names of the positions that the rotation of the joint depends on."""
        return self.siblings[: self.type.positions] if self.siblings else (self.name,)

    @property
    def leads(self) -> bool:
        """Whether it is the only or first coordinate of its joint."""
        return self.type.element <= 0

    @property
    def speeds(self) -> tuple[str, ...]:
        """Names of the coordinates whose speeds the rates of the positions depend on."""
        return self.siblings[self.type.positions :]

    @property
    def rate_name(self) -> str:
        """Name of the speed of the coordinate, as a state and as a channel."""
        return f"{self.name}_rate" if self.type.is_paired else self.name

    @property
    def force_unit(self) -> str:
        """Unit of the force on the coordinate."""
        return self.type.force_unit


def quaternion_joint(
    body: str,
    start: Sequence[float] = (1.0, 0.0, 0.0, 0.0),
    start_rate: Sequence[float] = (0.0, 0.0, 0.0),
) -> tuple[Joint, ...]:
    """Return the coordinates of a ball joint whose attitude is a quaternion.

    Parameters
    ----------
    body
        Name that the coordinates begin with.
    start
        Quaternion (w, x, y, z) to start with, v_before = R v_beyond; it is made a unit one.
    start_rate
        Angular velocity to start with, in the axes beyond the joint [rad/s].
    """
    kind = "spherical_quaternion"
    elements = find(FAMILY, kind).elements
    names = tuple(f"{body}.{element.name}" for element in elements)
    size = math.sqrt(sum(value * value for value in start)) or 1.0
    values = [*((value / size, 0.0) for value in start), *((0.0, rate) for rate in start_rate)]
    return tuple(
        Joint(
            kind,
            name,
            start=value,
            role="independent",
            start_rate=rate,
            description=f"{body}, {element.description}",
            settings={"element": k},
            siblings=names,
        )
        for k, (name, element, (value, rate)) in enumerate(
            zip(names, elements, values, strict=True)
        )
    )


@dataclass(frozen=True)
class Turn:
    """A fixed rotation between joints of a chain: v_before = rotation v_after."""

    rotation: Mat


@dataclass(frozen=True)
class Body:
    """A body and the chain of joints that carries it.

    A body is rigid unless it has a ``flexibility``.

    Parameters
    ----------
    name, parent
        Names of the body and of the body (or "ground") that carries it.
    at
        Where the chain starts, in the axes of the parent from its origin, 3 scalars [m].
    joints
        Joints and fixed turns, from the parent outwards.
    mass
        Mass [kg]; None for a massless body, which then has no inertia either.
    com
        Centre of mass in the axes of the body, 3 scalars [m].
    inertia
        Ixx, Iyy, Izz, Ixy, Ixz, Iyz about the centre of mass in the axes of the body; the
        last three are elements of the matrix, not products with the opposite sign [kg m²].
    spins_about
        Axis (1, 2 or 3) of a body of revolution whose last joint turns about that axis: the
        axes of the body then do not spin with it, which is cheaper and exact. Its centre of
        mass must lie on the axis and the two inertias across it be equal; nothing hangs on
        such a body, and points of it off the axis stay where they are.
    apparent_inertia
        Whether the inertia was identified on a machine or holds motors and gears, so that it may
        break the triangle inequality.
    is_abstract
        Whether it only carries coordinates of constraints, so that there is nothing to be seen.
    flexibility
        How it deforms; ``joints`` then hold the coordinates of the deformation too, and mass,
        centre of mass and inertia are those of the undeformed body.
    place
        Point of a deformable parent that it hangs on, such as 0 to 1 along a beam; ``at`` then
        counts from this point, in its axes.
    """

    name: str
    parent: str
    at: Sequence[Scalar] = (0.0, 0.0, 0.0)
    joints: tuple[Joint | Turn, ...] = ()
    mass: Scalar | None = None
    com: Sequence[Scalar] = (0.0, 0.0, 0.0)
    inertia: Sequence[Scalar] = (0.0,) * 6
    spins_about: int | None = None
    apparent_inertia: bool = False
    is_abstract: bool = False
    flexibility: Flexibility | None = None
    place: float | None = None
