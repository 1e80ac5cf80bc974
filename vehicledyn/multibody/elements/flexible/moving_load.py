"""A force that travels along a beam, as of a vehicle on a bridge."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.multibody.bodies.modal_beam import ModalBeam
from vehicledyn.multibody.model.declaration import body_name, function
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation, Wrench
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar, Vec


@register("element_type", "moving_load")
@dataclass(frozen=True)
class MovingLoad(BasePart):
    """A force at a point of a beam that travels along it; none before its start and past its end.

    The beam is one of assumed modes, and the force acts where its deflection is to first order.
    """

    body: str = body_name("The beam", may_be_ground=False)
    place: Callable[[Scalar], Scalar] = function(
        "m", "Distance of the force from the start of the beam", of="time"
    )
    force: Callable[[Scalar], Sequence[Scalar]] = function(
        "N", "The force in world axes", of="time", nature="polar"
    )

    def loads(self, situation: Situation) -> Loads:
        """Return the force on the beam and on the coordinates of its deformation."""
        beam = self._beam(situation.kinematics)
        position, linear, push = self._acting(situation, beam)
        forces = {beam.coordinates[k]: ops.dot(column, push) for k, column in linear.items()}
        wrench = Wrench(self.body, push, ops.cross(position, push))
        return Loads(wrenches=(wrench,), joint_forces=forces)

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the deflection of the beam under the force, in the axes of its start."""
        beam = self._beam(situation.kinematics)
        position, _, _ = self._acting(situation, beam)
        return tuple(
            Output(
                Channel(f"{self.name}.deflection_{axis}", "m", f"Deflection there, {axis}", "body"),
                position[k],
            )
            for k, axis in ((1, "y"), (2, "z"))
        )

    def _acting(self, situation: Situation, beam: ModalBeam) -> tuple[Vec, dict[int, Vec], Vec]:
        """Return the loaded point, its derivatives and the force in the axes of the beam."""
        kinematics, time = situation.kinematics, situation.time
        along = self.place(time) / beam.length
        inside = ops.logic_and(along >= 0.0, along <= 1.0)
        held = ops.minimum(ops.maximum(along, 0.0), 1.0)
        q = [kinematics.coordinate(name) for name in beam.coordinates]
        position, linear = beam.carried(held, q)
        push = kinematics.rotation(self.body).T @ ops.vector(*self.force(time))
        return position, linear, push * ops.where(inside, 1.0, 0.0)

    def _beam(self, kinematics: Kinematics) -> ModalBeam:
        tree = kinematics.tree
        found = tree.links[tree.body_link[self.body]].flexibility
        if isinstance(found, ModalBeam):
            return found
        raise InputError(
            f"moving_load '{self.name}': body: '{self.body}' is no beam of 'model: modes'; "
            "name one",
            about=[self.name],
        )
