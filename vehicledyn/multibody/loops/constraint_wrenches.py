"""Bodies displaced one by one: which force and torque a constraint puts on each of them.

A constraint acts on the coordinates with λ ∂h/∂q. That does not say how it acts on the bodies,
because joints carry a part. By virtual work it does: with every body b displaced by d_b and turned
by θ_b, free of its joints, the force on it is λ ∂h/∂d_b and the torque λ ∂h/∂θ_b.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.loops.constraint_equations import ConstraintRow
from vehicledyn.multibody.model.constraints import Geometry, Movement
from vehicledyn.multibody.model.cuts import Residual
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import Wrench
from vehicledyn.multibody.model.system import System
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

_ORIGIN = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class UnitAction:
    """What one row of a constraint does with a multiplier of one.

    ``wrenches`` act on bodies, the ground among them, ``joint_forces`` on coordinates by name
    [N or N m a unit of the multiplier].
    """

    wrenches: tuple[Wrench, ...]
    joint_forces: dict[str, Scalar]


def unit_actions(
    system: System, rows: Sequence[ConstraintRow], kinematics: Kinematics, time: Scalar
) -> list[UnitAction]:
    """Return what each row of the cuts and constraints of a system does.

    Parameters
    ----------
    system
        The system.
    rows
        Its rows, in the order of
        :func:`~vehicledyn.multibody.loops.constraint_equations.rows_of_system`.
    kinematics
        Kinematics of its bodies at position and velocity level.
    time
        Symbol of time.

    Raises
    ------
    InputError
        If a constraint written in Python looks at anything but coordinates and bodies.
    """
    found: list[UnitAction] = []
    for cut in system.cuts:
        ancestor = kinematics.tree.common_ancestor(cut.body_a, cut.body_b)
        bodies = Displaced(cut.name, kinematics, frame=ancestor)
        found += [bodies.action(residual) for residual in cut.residuals(bodies)]
    for constraint in system.constraints:
        bodies = Displaced(constraint.name, kinematics)
        geometry = Geometry(time, cast(Kinematics, bodies))
        found += [bodies.action(residual) for residual in constraint.residuals(geometry)]
    for constraint in system.constraints:
        bodies = Displaced(constraint.name, kinematics, in_rates=True)
        movement = Movement(time, cast(Kinematics, bodies))
        found += [bodies.action(residual) for residual in constraint.speeds(movement)]
    if len(found) != len(rows):
        raise InputError(f"a constraint of '{system.name}' gives another number of rows each time")
    return found


class Displaced:
    """The bodies of a system, each displaced and turned a little by itself.

    ``frame`` is the link in whose axes they are seen. With ``in_rates`` not the places of the
    bodies vary but their velocities, as non-holonomic constraints need.
    """

    def __init__(
        self, constraint: str, kinematics: Kinematics, *, frame: int = -1, in_rates: bool = False
    ) -> None:
        self._constraint, self._kinematics, self._frame = constraint, kinematics, frame
        self._in_rates = in_rates
        self._bodies: dict[str, tuple[Vec, Vec]] = {}
        self._coordinates: dict[str, Scalar] = {}

    def coordinate(self, name: str) -> Scalar:
        """Return a joint coordinate [m or rad]."""
        value = self._kinematics.coordinate(name)
        return value if self._in_rates else value + self._varied(name)

    def rate(self, name: str) -> Scalar:
        """Return the rate of a joint coordinate [m/s or rad/s]."""
        value = self._kinematics.rate(name)
        return value + self._varied(name) if self._in_rates else value

    def position(self, body: str, point: Sequence[Scalar] = _ORIGIN) -> Vec:
        """Return the position of a point of a body in the axes of the frame [m]."""
        arm = self._arm(body, point)
        where = self._kinematics.origin_in(self._frame, self._link(body)) + arm
        if self._in_rates:
            return where
        shift, turn = self._moved(body)
        return where + shift + ops.cross(turn, arm)

    def rotation(self, body: str) -> Mat:
        """Return R with v_frame = R v_body."""
        rotation = self._kinematics.rotation_in(self._frame, self._link(body))
        if self._in_rates:
            return rotation
        return rotation + ops.tilde(self._moved(body)[1]) @ rotation

    def velocity(self, body: str, point: Sequence[Scalar] = _ORIGIN) -> Vec:
        """Return the velocity of a point of a body in world axes [m/s]."""
        shift, turn = self._moved(body)
        carried = shift + ops.cross(turn, self._arm(body, point))
        return self._kinematics.velocity(body, point) + carried

    def angular_velocity(self, body: str) -> Vec:
        """Return the angular velocity of a body in its own axes [rad/s]."""
        turn = self._moved(body)[1]
        return self._kinematics.angular_velocity(body) + self._kinematics.rotation(body).T @ turn

    def __getattr__(self, name: str) -> Any:
        raise InputError(
            f"constraint '{self._constraint}' uses '{name}' of the kinematics; reactions can be "
            "known only for constraints that use coordinates, positions, rotations and velocities"
        )

    def action(self, residual: Residual) -> UnitAction:
        """Return what the row of a residual does."""
        wrenches = []
        expression = ops.scalar(residual.expression)
        for body, (shift, turn) in self._bodies.items():
            slope = self._slope(expression, ops.stacked(shift, turn))
            if ops.is_structurally_zero(slope):
                continue
            to_body = self._kinematics.rotation_in(self._frame, self._link(body)).T
            wrenches.append(Wrench(body, to_body @ slope[:3], to_body @ slope[3:]))
        forces = {n: self._slope(expression, s) for n, s in self._coordinates.items()}
        kept = {n: f for n, f in forces.items() if not ops.is_structurally_zero(f)}
        return UnitAction(tuple(wrenches), kept)

    def _slope(self, expression: Scalar, variables: Scalar) -> Scalar:
        slope = ops.jacobian(expression, variables).T
        moved = [*self._coordinates.values(), *(v for pair in self._bodies.values() for v in pair)]
        column = ops.stacked(*moved)
        return ops.substitute(slope, column, ops.column([0.0] * column.shape[0]))

    def _link(self, body: str) -> int:
        return self._kinematics.tree.body_link[body]

    def _arm(self, body: str, point: Sequence[Scalar]) -> Vec:
        rotation = self._kinematics.rotation_in(self._frame, self._link(body))
        return rotation @ ops.vector(point[0], point[1], point[2])

    def _moved(self, body: str) -> tuple[Vec, Vec]:
        if body not in self._bodies:
            self._bodies[body] = (ops.symbols(f"{body}_shift", 3), ops.symbols(f"{body}_turn", 3))
        return self._bodies[body]

    def _varied(self, name: str) -> Scalar:
        return self._coordinates.setdefault(name, ops.symbol(f"{name}_varied"))
