"""Bushings: springs and dampers in three directions and three turns between two bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from vehicledyn.base.registry import register
from vehicledyn.base.shapes import Anchor, Ball, Coil, Shape
from vehicledyn.multibody.elements.point_forces import Attachment
from vehicledyn.multibody.model.declaration import ORIGIN, attachment, vector
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation, Wrench
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Mat, Scalar, Vec


def _diagonal(unit: str, description: str) -> Any:
    return vector(unit, description, default=ORIGIN, nature="diagonal")


@register("element_type", "bushing")
@dataclass(frozen=True)
class Bushing(BasePart):
    """Springs and dampers in three directions and three turns between two bodies.

    In the axes of body A, with d the place of B's point from A's less ``offset`` and θ the turn
    of B over A,

        F = F_0 - K d - C ḋ,    M = -K_θ θ - C_θ θ̇

    act on B at its point, and their opposites on A at the same point in space, so that the pair
    has no moment. θ is the axis of the turn times its sine; the two agree for small turns.
    """

    a: Attachment = attachment("Where it is fixed to the one body, whose axes it has")
    b: Attachment = attachment("Where it is fixed to the other body")
    stiffness: Sequence[Scalar] = _diagonal("N/m", "Stiffness along x, y, z")
    damping: Sequence[Scalar] = _diagonal("N*s/m", "Damping along x, y, z")
    turning_stiffness: Sequence[Scalar] = _diagonal(
        "N*m/rad", "Stiffness against turns about x, y, z"
    )
    turning_damping: Sequence[Scalar] = _diagonal("N*m*s/rad", "Damping of turns about x, y, z")
    preload: Sequence[Scalar] = vector(
        "N", "Force on body b where the deflection is zero", default=ORIGIN
    )
    offset: Sequence[Scalar] = vector(
        "m", "Place of b from a where the deflection is zero", default=ORIGIN
    )

    def shapes(self) -> tuple[Shape, ...]:
        """Return a block on A, and a coil to B where that is away from it."""
        a, b = (Anchor(end.body, tuple(end.point)) for end in (self.a, self.b))
        return Ball(self.name, a, style="rubber"), Coil(self.name, a, b)

    def loads(self, situation: Situation) -> Loads:
        """Return the pair of opposite forces and torques."""
        state = _State.of(self, situation)
        force_b = state.turn.T @ state.force
        torque_b = state.turn.T @ state.torque
        moment_a = ops.cross(state.foot, -state.force) - state.torque
        moment_b = ops.cross(ops.vector(*self.b.point), force_b) + torque_b
        return Loads(
            wrenches=(
                *_wrench(self.a.body, -state.force, moment_a),
                *_wrench(self.b.body, force_b, moment_b),
            )
        )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return deflection and force on B, and turn and torque where something resists turns."""
        state = _State.of(self, situation)
        found = self._channels("deflection", "m", "Deflection", state.deflection)
        found += self._channels("force", "N", f"Force on {self.b.body}", state.force)
        if _is_given(self.turning_stiffness) or _is_given(self.turning_damping):
            found += self._channels("turn", "rad", "Turn", state.angles)
            found += self._channels("torque", "N*m", f"Torque on {self.b.body}", state.torque)
        return found

    def _channels(self, what: str, unit: str, text: str, values: Vec) -> tuple[Output, ...]:
        return tuple(
            Output(
                Channel(f"{self.name}.{what}_{axis}", unit, f"{text}, {axis}", self.a.body),
                values[k],
            )
            for k, axis in enumerate("xyz")
        )


@dataclass(frozen=True)
class _State:
    """Deflection, turn, force and torque in the axes of A; ``turn`` has v_a = turn v_b.

    ``foot`` is B's point from the origin of A.
    """

    foot: Vec
    turn: Mat
    deflection: Vec
    angles: Vec
    force: Vec
    torque: Vec

    @classmethod
    def of(cls, bushing: Bushing, situation: Situation) -> _State:
        kinematics = situation.kinematics
        body_a, body_b = bushing.a.body, bushing.b.body
        pair = kinematics.between(body_a, body_b)
        rotation_a = pair.rotation(body_a)
        foot = rotation_a.T @ (pair.position(body_b, bushing.b.point) - pair.position(body_a))
        turn = rotation_a.T @ pair.rotation(body_b)
        deflection = foot - ops.vector(*bushing.a.point) - ops.vector(*bushing.offset)
        angles = 0.5 * ops.vector(
            turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]
        )

        def resisted(amount: Vec, stiffness: Sequence[Scalar], damping: Sequence[Scalar]) -> Vec:
            rows = []
            for k in range(3):
                row = stiffness[k] * amount[k]
                if _is_given(damping[k : k + 1]):
                    row = row + damping[k] * kinematics.time_derivative(amount[k])
                rows.append(row)
            return ops.vector(*rows)

        force = ops.vector(*bushing.preload) - resisted(
            deflection, bushing.stiffness, bushing.damping
        )
        torque = -resisted(angles, bushing.turning_stiffness, bushing.turning_damping)
        return cls(foot, turn, deflection, angles, force, torque)


def _wrench(body: str, force: Vec, torque: Vec) -> tuple[Wrench, ...]:
    return () if body == "ground" else (Wrench(body, force, torque),)


def _is_given(values: Sequence[Scalar]) -> bool:
    """Return whether any of the values is a symbol or a number other than zero."""
    return any(not ops.is_structurally_zero(ops.scalar(value)) for value in values)
