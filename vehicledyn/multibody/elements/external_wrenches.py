"""External wrenches: forces and torques on a body that depend on time alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

from vehicledyn.base.registry import register
from vehicledyn.base.shapes import Anchor, Force, Shape
from vehicledyn.multibody.model.declaration import ORIGIN, body_name, choice, function, vector
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation, Wrench
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar, Vec

TimeVector = Callable[[Scalar], Sequence[Scalar]]
"""Three components from the time [s]."""

_AXES = ("x", "y", "z")


def _nothing(_: Scalar) -> Sequence[Scalar]:
    return (0.0, 0.0, 0.0)


@register("element_type", "wrench")
@dataclass(frozen=True)
class ExternalWrench(BasePart):
    """A force at a point of a body and a torque on it, as functions of time."""

    body: str = body_name("The body")
    point: Sequence[Scalar] = vector(
        "m", "Where the force acts, in the axes of the body", default=ORIGIN
    )
    force: TimeVector = function(
        "N", "The force", of="time", nature="polar", default=_nothing, written=ORIGIN
    )
    torque: TimeVector = function(
        "N*m", "The torque", of="time", nature="axial", default=_nothing, written=ORIGIN
    )
    axes: Literal["world", "body"] = choice(
        "Axes in which force and torque are given", default="world"
    )

    def loads(self, situation: Situation) -> Loads:
        """Return the wrench in the axes of the body, about its origin."""
        force, torque = self._components(situation)
        if self.axes == "world":
            to_body = situation.kinematics.rotation(self.body).T
            force, torque = to_body @ force, to_body @ torque
        moment = torque + ops.cross(ops.vector(*self.point), force)
        return Loads(wrenches=(Wrench(self.body, force, moment),))

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return force and torque in the axes they are given in."""
        frame = self.body if self.axes == "body" else "world"
        pairs = zip(("force", "torque"), ("N", "N*m"), self._components(situation), strict=True)
        return tuple(
            Output(
                Channel(f"{self.name}.{word}_{axis}", unit, f"External {word}, {axis}", frame),
                vector[k],
            )
            for word, unit, vector in pairs
            for k, axis in enumerate(_AXES)
        )

    def shapes(self) -> tuple[Shape, ...]:
        """Return the force."""
        forces = tuple(f"{self.name}.force_{axis}" for axis in _AXES)
        return (Force(self.name, Anchor(self.body, tuple(self.point)), forces, axes=self.axes),)

    def _components(self, situation: Situation) -> tuple[Vec, Vec]:
        return (
            ops.vector(*self.force(situation.time)),
            ops.vector(*self.torque(situation.time)),
        )
