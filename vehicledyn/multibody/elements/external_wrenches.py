"""External wrenches: forces and torques on a body that depend on time alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from vehicledyn.base.shapes import Anchor, Force, Shape
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation, Wrench
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar, Vec

TimeVector = Callable[[Scalar], Sequence[Scalar]]
"""Three components from the time [s]."""

_AXES = ("x", "y", "z")


def _nothing(_: Scalar) -> Sequence[Scalar]:
    return (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class ExternalWrench(BasePart):
    """A force at a point of a body and a torque on it, such as wind or a test rig.

    Parameters
    ----------
    body, point
        The body and the point the force acts at, in body axes [m].
    force, torque
        Components as functions of time, in world axes or, with ``follows``, in the axes of the
        body [N, N m].
    follows
        Whether the wrench turns with the body.
    """

    body: str
    point: Sequence[Scalar] = (0.0, 0.0, 0.0)
    force: TimeVector = _nothing
    torque: TimeVector = _nothing
    follows: bool = False

    def loads(self, situation: Situation) -> Loads:
        """Return the wrench in the axes of the body, about its origin."""
        force, torque = self._components(situation)
        if not self.follows:
            to_body = situation.kinematics.rotation(self.body).T
            force, torque = to_body @ force, to_body @ torque
        moment = torque + ops.cross(ops.vector(*self.point), force)
        return Loads(wrenches=(Wrench(self.body, force, moment),))

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return force and torque in the axes they are given in."""
        frame = self.body if self.follows else "world"
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
        frame = "body" if self.follows else "world"
        return (Force(self.name, Anchor(self.body, tuple(self.point)), forces, axes=frame),)

    def _components(self, situation: Situation) -> tuple[Vec, Vec]:
        return (
            ops.vector(*self.force(situation.time)),
            ops.vector(*self.torque(situation.time)),
        )
