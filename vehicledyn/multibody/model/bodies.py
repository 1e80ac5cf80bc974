"""Bodies and the chains of joints that carry them, as data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from vehicledyn.multibody.joints.joint_type import JointType, joint_type
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
    """

    kind: str
    name: str
    start: float = 0.0
    role: str = "auto"
    start_rate: float = 0.0
    description: str = ""
    settings: dict[str, Any] = field(default_factory=dict, compare=False)

    @cached_property
    def type(self) -> JointType:
        """What the joint lets move."""
        return joint_type(self.kind, self.settings)

    @property
    def unit(self) -> str:
        """Unit of the coordinate."""
        return self.type.unit

    @property
    def force_unit(self) -> str:
        """Unit of the force on the coordinate."""
        return self.type.force_unit


@dataclass(frozen=True)
class Turn:
    """A fixed rotation between joints of a chain: v_before = rotation v_after."""

    rotation: Mat


@dataclass(frozen=True)
class Body:
    """A rigid body and the chain of joints that carries it.

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
