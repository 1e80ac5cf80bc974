"""What the recursions ask of a joint: its rotation, its displacement and its axis of motion."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import MISSING, dataclass, field, fields
from typing import Any, ClassVar

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.registry import find, kinds
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

FAMILY = "joint_type"
"""Catalogue of the types."""


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

    @property
    def pure(self) -> Vec | None:
        """The only axis; None where the motion turns and slides."""
        if self.angular is None:
            return self.linear
        return self.angular if self.linear is None else None


class JointType(ABC):
    """A joint with one coordinate q.

    Beyond the joint stands a frame that is displaced by d(q) and turned by R(q) from the frame
    before it, and moves relative to that with q̇ times the axes of :meth:`motion`. A new type
    gives these three; the class attributes say where a recursion may take a shorter way.
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

    @property
    def angle_about(self) -> int | None:
        """Axis of the frame about which R is the turn by the angle q; None for any other R."""
        return self.turns_about

    @property
    def turns_otherwise(self) -> bool:
        """Whether R is a rotation that no axis of the frame tells."""
        return False

    @property
    def has_constant_axes(self) -> bool:
        """Whether :meth:`motion` is the same at each value of the coordinate."""
        return True

    @property
    def force_unit(self) -> str:
        """Unit of the force on the coordinate, "N*m" or "N"."""
        return "N*m" if self.unit == "rad" else "N"

    def rotation(self, q: Scalar) -> Mat | None:
        """Return R with v_before = R v_beyond; None without rotation.

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


def setting(unit: str, description: str, *, is_handed: bool = False) -> Any:
    """Declare a number of a joint type, a field of its dataclass that may be a symbol.

    Parameters
    ----------
    unit
        SI unit.
    description
        Meaning, one phrase.
    is_handed
        Whether the mirror image of the joint has the opposite number.
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
    entry = find(FAMILY, kind)
    known = {f.name: f for f in fields(entry)} if hasattr(entry, "__dataclass_fields__") else {}
    for name in settings:
        if name not in known:
            raise InputError(unknown_name(f"setting of the joint {kind}", name, known))
    missing = [n for n, f in known.items() if n not in settings and f.default is MISSING]
    if missing:
        raise InputError(f"the joint {kind} lacks {', '.join(missing)}; give its settings")
    found: JointType = entry(**settings)
    return found


def joint_kinds() -> tuple[str, ...]:
    """Return the names of all types."""
    return kinds(FAMILY)
