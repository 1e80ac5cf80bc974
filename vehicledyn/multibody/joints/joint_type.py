"""What the recursions ask of a joint: its rotation, its displacement and its axis of motion."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from typing import Any, ClassVar

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.registry import find, kinds
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

FAMILY = "joint_type"
"""Catalogue of the types."""

DEFORMATIONS = "deformation_type"
"""Catalogue of the coordinates of deformations, which are no joints."""


@dataclass(frozen=True)
class Axes:
    """Motion of a joint at unit rate of its coordinate, in the axes beyond the joint.

    ``angular`` is the relative angular velocity [rad over unit], ``linear`` the relative velocity
    of the origin [m over unit]; None where there is none.
    """

    angular: Vec | None = None
    linear: Vec | None = None

    def seen_by(self, rotation: Mat) -> Axes:
        """Return the axes in a frame beyond a fixed turn, v_before = rotation v_beyond."""
        return self.turned(rotation.T)

    def turned(self, rotation: Mat) -> Axes:
        """Return the axes in a frame with v_frame = rotation v."""
        angular, linear = (
            None if axis is None else rotation @ axis for axis in (self.angular, self.linear)
        )
        return Axes(angular, linear)


@dataclass(frozen=True)
class Element:
    """A coordinate of a joint that has several: its usual name, unit and meaning."""

    name: str
    unit: str
    description: str


class JointType(ABC):
    """A joint, or one of the coordinates of a joint that has several; q is its coordinate.

    Beyond the joint stands a frame that is displaced by d(q) and turned by R(q) from the frame
    before it, and moves relative to that with q̇ times the axes of :meth:`motion`. A new type
    gives these three; the class attributes say where a recursion may take a shorter way.

    A joint whose speeds are not the rates of its positions lists its ``elements``, the
    ``positions`` first, the speeds after them, and gives the rates of the positions by
    :meth:`rates`. Each speed is a link of its own with constant axes, all links of the joint have
    the same origin and, but for the rotation of the first, the same axes.
    """

    family: ClassVar[str]
    kind: ClassVar[str]

    unit: ClassVar[str] = "rad"
    """Unit of the coordinate, "rad" or "m"."""
    usual_name: ClassVar[str] = "angle"
    """Name of the coordinate in system files that give none."""
    turns_about: ClassVar[int | None] = None
    """Axis of a pure turn by the coordinate."""
    slides_along: ClassVar[int | None] = None
    """Axis of a pure slide by the coordinate."""
    elements: ClassVar[tuple[Element, ...]] = ()
    """Positions and speeds of a joint that has several."""
    positions: ClassVar[int] = 0
    """Number of positions among the elements."""
    start: ClassVar[tuple[float, ...]] = ()
    """Positions that it starts from where nothing is said."""
    element: int = -1
    """Place of this coordinate among the elements; -1 where there are none."""

    @property
    def has_position(self) -> bool:
        """Whether the coordinate is a position."""
        return self.element < self.positions or not self.elements

    @property
    def has_speed(self) -> bool:
        """Whether the coordinate has a speed, which a force acts along."""
        return self.element >= self.positions or not self.elements

    @property
    def is_paired(self) -> bool:
        """Whether the coordinate is a position and its rate the speed."""
        return self.has_position and self.has_speed

    @classmethod
    def rates(cls, positions: Sequence[Scalar], speeds: Sequence[Scalar]) -> list[Scalar]:
        """Return the rates of the positions of a joint with several coordinates."""
        raise NotImplementedError

    @classmethod
    def start_problem(cls, positions: Sequence[float]) -> str:
        """Return what is wrong with positions to start from, empty if nothing."""
        return ""

    @property
    def makes_link(self) -> bool:
        """Whether the coordinate has a link of the tree for itself."""
        return self.has_speed

    @property
    def angle_about(self) -> int | None:
        """Axis of the frame about which R is the turn by the angle q; None for any other R."""
        return self.turns_about

    @property
    def turns_otherwise(self) -> bool:
        """Whether R is a rotation that no axis of the frame gives."""
        return False

    @property
    def has_constant_axes(self) -> bool:
        """Whether :meth:`motion` is the same at each value of the coordinate."""
        return True

    @property
    def force_unit(self) -> str:
        """Unit of the force on the coordinate, "N*m" or "N"."""
        return "N*m" if self.unit == "rad" else "N"

    def rotation(self, q: Any) -> Mat | None:
        """Return R with v_before = R v_beyond; None without rotation.

        ``q`` are all positions of a joint that has several.

        It is asked where the type ``turns_otherwise``; a turn about an axis is known by that.
        """
        return None

    def displacement(self, q: Scalar) -> Vec | None:
        """Return d, in the axes before the joint [m]; None without displacement."""
        return None

    @abstractmethod
    def motion(self, q: Scalar) -> Axes:
        """Return the axes of motion at a value of the coordinate."""

    @abstractmethod
    def is_turned_by_mirror(self, axis: int) -> bool:
        """Return whether the mirror image across ``axis`` moves with the opposite sign."""

    def handed_settings(self, axis: int) -> tuple[str, ...]:
        """Return the settings of which the mirror image across ``axis`` has the opposite."""
        if not is_dataclass(self):
            return ()
        return tuple(item.name for item in fields(self) if item.metadata.get("is_handed"))


def setting(unit: str, description: str, *, is_handed: bool = False) -> Any:
    """Declare a number of a joint type, a field of its dataclass that may be a symbol.

    Parameters
    ----------
    unit
        SI unit.
    description
        Meaning, one phrase.
    is_handed
        Whether any mirror image of the joint has the opposite number.
    """
    return field(metadata={"unit": unit, "description": description, "is_handed": is_handed})


def choice(description: str) -> Any:
    """Declare a setting that is one of the values which its annotation, a Literal, lists."""
    return field(metadata={"description": description})


def joint_type(kind: str, settings: dict[str, Any]) -> JointType:
    """Return the type of a joint with its settings.

    Raises
    ------
    InputError
        If the kind is unknown, or a setting is missing or unknown.
    """
    entry = find(DEFORMATIONS if kind in kinds(DEFORMATIONS) else FAMILY, kind)
    known = {f.name: f for f in fields(entry)} if hasattr(entry, "__dataclass_fields__") else {}
    for name in settings:
        if name not in known:
            raise InputError(unknown_name(f"setting of the joint {kind}", name, known))
    missing = [n for n, f in known.items() if n not in settings and f.default is MISSING]
    if missing:
        raise InputError(f"the joint {kind} lacks {', '.join(missing)}; give its settings")
    found: JointType = entry(**settings)
    return found


def brought_kinds() -> tuple[str, ...]:
    """Return the names of the types that only elements bring along."""
    return kinds(DEFORMATIONS)


def joint_kinds() -> tuple[str, ...]:
    """Return the names of all types."""
    return kinds(FAMILY)
