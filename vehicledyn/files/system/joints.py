"""Joints of system files: those of the catalogue, fixed turns and named compositions."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import Field as SettingField
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any, Literal, Self

from pydantic import Field, ValidationInfo, field_validator, model_validator

from vehicledyn import multibody
from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import find, register
from vehicledyn.files.expressions.expressions import Expression, read_expression, zero
from vehicledyn.files.expressions.fields import Scalar, Scalars, SystemSet, measured
from vehicledyn.multibody.joints.joint_type import FAMILY, JointType, joint_type
from vehicledyn.symbolic import rotations

Role = Literal["auto", "independent", "dependent", "driven"]
_ROLE = "Whether it is a state, solved from the loops, or held where no drive moves it"


@dataclass(frozen=True)
class Coordinate:
    """A coordinate: its dotted name, the type of its joint with settings, and how it starts."""

    name: str
    joint: str
    role: Role
    start: Expression
    start_rate: Expression
    description: str
    settings: dict[str, Any] = field(default_factory=dict, compare=False)
    siblings: tuple[str, ...] = ()
    reflected_inertia: Expression | None = None

    @property
    def type(self) -> JointType:
        """What the joint lets move; settings that are expressions stay so."""
        return joint_type(self.joint, self.settings)

    @property
    def unit(self) -> str:
        """SI unit of the coordinate; that of the speed where it is no position."""
        return self.type.elements[self.type.element].unit if self.siblings else self.type.unit

    @property
    def force_unit(self) -> str:
        """SI unit of the force on it."""
        return self.type.force_unit

    def is_turned_by_mirror(self, axis: int) -> bool:
        """Whether the mirror image of a motion has the opposite sign."""
        return self.type.is_turned_by_mirror(axis)


class JointSet(SystemSet):
    """Base of the joints: what one adds to the chain that carries a body."""

    @abstractmethod
    def coordinates(self, body: str) -> list[Coordinate]:
        """Return its coordinates, from the parent outwards."""

    def turn(self, value: Callable[[Expression], Any]) -> multibody.Turn | None:
        """Return the fixed turn that stands in place of coordinates, if it is one.

        ``value`` returns what an expression is worth, a number or symbol.
        """
        return None

    def mirrored(self, axis: int) -> Self:
        """Return the joint of the mirror image; the caller renames."""
        return self


def full_name(body: str, name: str) -> str:
    """Return the dotted name of a coordinate; a name with a dot is complete already."""
    return name if "." in name else f"{body}.{name}"


class TypedJointSet(JointSet):
    """A joint of a type of the catalogue, with one coordinate."""

    name: str = Field(
        default="",
        description="Name of the coordinate; for the elementary joints x y z or roll pitch yaw, "
        "else angle, if left out",
    )
    start: Scalar = measured("{length}", "Where it starts", default=zero())
    start_rate: Scalar = measured("{length}/s", "Its rate at the start", default=zero())
    reflected_inertia: Scalar | None = measured(
        "{inertia}",
        "Inertia that the coordinate alone feels, such as that of a rotor through its gear",
        default=None,
        above=0.0,
    )
    role: Role = Field(default="auto", description=_ROLE)
    description: str = Field(default="", description="What the coordinate is, for people")

    @model_validator(mode="after")
    def _settings_go_together(self) -> Self:
        try:
            joint_type(self.kind, {name: getattr(self, name) for name in settings_of(self.kind)})
        except InputError as error:
            raise ValueError(str(error)) from None
        return self

    def coordinates(self, body: str) -> list[Coordinate]:
        """Return the one coordinate."""
        own = {name: getattr(self, name) for name in settings_of(self.kind)}
        usual = find(FAMILY, self.kind).usual_name
        name = full_name(body, self.name or usual)
        start = (self.start, self.start_rate)
        return [
            Coordinate(
                name, self.kind, self.role, *start, self.description, own,
                reflected_inertia=self.reflected_inertia,
            )
        ]  # fmt: skip

    def mirrored(self, axis: int) -> Self:
        """Return the joint with its start turned round where the motion is, handed settings too."""
        (coordinate,) = self.coordinates("")
        names = list(coordinate.type.handed_settings(axis))
        if coordinate.is_turned_by_mirror(axis):
            names += ["start", "start_rate"]
        return self.model_copy(update={name: getattr(self, name).negated() for name in names})


class ElementsJointSet(JointSet):
    """A joint of a type of the catalogue whose speeds are not the rates of its positions."""

    start: Scalars | None = None
    start_rate: Scalars | None = None
    description: str = Field(default="", description="What the joint is, for people")

    def coordinates(self, body: str) -> list[Coordinate]:
        """Return its positions, then its speeds."""
        of = find(FAMILY, self.kind)
        names = tuple(full_name(body, element.name) for element in of.elements)
        positions = self.start or tuple(map(read_expression, of.start))
        speeds = self.start_rate or (zero(),) * (len(names) - of.positions)
        starts = [*((p, zero()) for p in positions), *((zero(), v) for v in speeds)]
        return [
            Coordinate(
                name, self.kind, "independent", *given,
                f"{self.description or body}, {element.description}", {"element": k}, names,
            )
            for k, (name, element, given) in enumerate(
                zip(names, of.elements, starts, strict=True)
            )
        ]  # fmt: skip

    @field_validator("start", "start_rate")
    @classmethod
    def _as_many_as_it_has(
        cls, value: tuple[Expression, ...] | None, info: ValidationInfo
    ) -> tuple[Expression, ...] | None:
        of = find(FAMILY, cls.kind)
        speeds = len(of.elements) - of.positions
        count = speeds if info.field_name == "start_rate" else of.positions
        if value is not None and len(value) != count:
            raise ValueError(f"it has {count} numbers, not {len(value)}")
        return value

    def mirrored(self, axis: int) -> Self:
        """Return the joint with its starts turned round where the motion is."""
        of = find(FAMILY, self.kind)
        turned = [c.is_turned_by_mirror(axis) for c in self.coordinates("")]
        signs = {"start": turned[: of.positions], "start_rate": turned[of.positions :]}
        given = {name: getattr(self, name) for name in signs}
        update = {
            name: tuple(e.negated() if t else e for e, t in zip(values, signs[name], strict=True))
            for name, values in given.items()
            if values is not None
        }
        return self.model_copy(update=update)


def settings_of(kind: str) -> dict[str, SettingField[Any]]:
    """Return the settings of a type of joint by name."""
    entry = find(FAMILY, kind)
    return {f.name: f for f in fields(entry)} if is_dataclass(entry) else {}


@register("joint", "turn")
class FixedTurn(JointSet):
    """A fixed turn between joints whose axes are oblique; it has no coordinate."""

    axis: Literal[1, 2, 3] = Field(description="Axis of the turn")
    angle: Scalar = measured("rad", "Angle of what follows, positive about the axis")

    def coordinates(self, body: str) -> list[Coordinate]:
        """Return none."""
        return []

    def turn(self, value: Callable[[Expression], Any]) -> multibody.Turn:
        """Return the turn."""
        return multibody.Turn(rotations.turn(self.axis, value(self.angle)))

    def mirrored(self, axis: int) -> Self:
        """Return the turn, the other way round unless it is about the normal of the mirror."""
        if self.axis == axis:
            return self
        return self.model_copy(update={"angle": self.angle.negated()})


class _Composition(JointSet):
    """Several elementary joints at one place, with the usual names of their coordinates."""

    role: Role = Field(default="auto", description=_ROLE)

    @abstractmethod
    def joints(self) -> tuple[str, ...]:
        """Return the kinds of its elementary joints."""

    def coordinates(self, body: str) -> list[Coordinate]:
        """Return the coordinates x, y, z, roll, pitch, yaw that it has."""
        names = {kind: full_name(body, find(FAMILY, kind).usual_name) for kind in self.joints()}
        return [
            Coordinate(name, kind, self.role, zero(), zero(), "") for kind, name in names.items()
        ]


def _turns(sequence: tuple[int, ...]) -> tuple[str, ...]:
    return tuple(f"R{axis}" for axis in sequence)


Sequence = tuple[Literal[1, 2, 3], Literal[1, 2, 3], Literal[1, 2, 3]]


class _WithSequence(_Composition):
    sequence: Sequence = Field(
        default=(3, 2, 1), description="Axes of the three turns; 3 2 1 is yaw, pitch, roll"
    )

    @field_validator("sequence")
    @classmethod
    def _different(cls, value: Sequence) -> Sequence:
        if len(set(value)) != len(value):
            raise ValueError("the three axes must differ")
        return value


@register("joint", "spherical")
class Spherical(_WithSequence):
    """Ball joint as three turns; singular where the second one is a quarter turn."""

    def joints(self) -> tuple[str, ...]:
        """Return three turns."""
        return _turns(self.sequence)


@register("joint", "free")
class Free(_WithSequence):
    """Six coordinates: x, y, z and three turns."""

    def joints(self) -> tuple[str, ...]:
        """Return three slides and three turns."""
        return ("T1", "T2", "T3", *_turns(self.sequence))


@register("joint", "universal")
class Universal(_Composition):
    """Two turns about axes that cross at right angles."""

    axes: tuple[Literal[1, 2, 3], Literal[1, 2, 3]] = Field(description="First and second axis")

    @field_validator("axes")
    @classmethod
    def _different(cls, value: tuple[int, int]) -> tuple[int, int]:
        if value[0] == value[1]:
            raise ValueError("the two axes must differ")
        return value

    def joints(self) -> tuple[str, ...]:
        """Return two turns."""
        return _turns(self.axes)


@register("joint", "cylindrical")
class Cylindrical(_Composition):
    """A slide along and a turn about one axis."""

    axis: Literal[1, 2, 3] = Field(description="The axis")

    def joints(self) -> tuple[str, ...]:
        """Return a slide and a turn."""
        return (f"T{self.axis}", f"R{self.axis}")


@register("joint", "planar")
class Planar(_Composition):
    """Two slides in a plane and a turn about its normal."""

    normal: Literal[1, 2, 3] = Field(description="Axis across the plane")

    def joints(self) -> tuple[str, ...]:
        """Return two slides and a turn."""
        slides = tuple(f"T{axis}" for axis in (1, 2, 3) if axis != self.normal)
        return (*slides, f"R{self.normal}")
