"""Forces that joints transmit and constraints exert: derived only for those who ask.

The backward recursion of inverse dynamics gives what each joint transmits, once the forces of
the cuts and constraints act on the bodies like any other (book, chapter 3.3.3).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.multibody.loops.constraint_wrenches import UnitAction, unit_actions
from vehicledyn.multibody.loops.loop_closure import Loops
from vehicledyn.multibody.loops.redundancy import NEGLIGIBLE
from vehicledyn.multibody.model.ground import GROUND, body_axes
from vehicledyn.multibody.model.joint_wrench import JointWrench
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import Wrench
from vehicledyn.multibody.model.symbols import Symbols
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.recursion.newton_euler import inverse_dynamics
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.frames import WORLD
from vehicledyn.symbolic.labels import in_axes, unlabelled
from vehicledyn.symbolic.ops import Scalar, Vec


class SolvedForces:
    """What joints transmit and constraints exert in a solved system.

    Results hold symbols in place of the multipliers until :meth:`settled` replaces them, so
    that it can be reported which of them are unique.
    """

    def __init__(
        self,
        system: System,
        symbols: Symbols,
        loops: Loops,
        *,
        kinematics: Kinematics,
        wrenches: Sequence[Wrench],
        multipliers: Mapping[int, Scalar],
    ) -> None:
        """Keep what is needed; nothing is derived yet.

        Parameters
        ----------
        system, symbols, loops
            The system and its closed loops.
        kinematics
            Kinematics that knows the accelerations.
        wrenches
            What the parts do to the bodies.
        multipliers
            Multiplier of each kept row of the constraints.
        """
        self._system, self._symbols, self._loops = system, symbols, loops
        self._kinematics, self._wrenches = kinematics, list(wrenches)
        count = len(loops.constraints)
        self._unknown = ops.symbols("multiplier", count)
        self._values = ops.column([multipliers.get(k, 0.0) for k in range(count)])

    def reaction(self, body: str) -> JointWrench:
        """Return what the parent exerts on a body through its chain of joints.

        Springs, drives and transmissions on the coordinates of the chain are part of it.

        Returns
        -------
        JointWrench
            Force [N] at the body's origin and torque [N m] about it, in the axes of the body.

        Raises
        ------
        InputError
            If there is no such body, or it is the ground.
        """
        if body == GROUND:
            raise InputError("no joint carries the ground; name another body")
        return _in_axes_of(body, self._carried[self._link(body)])

    def exerted(self, constraint: str, body: str) -> JointWrench:
        """Return the force and torque that a cut or constraint exerts on a body.

        Returns
        -------
        JointWrench
            Force [N] at the body's origin and torque [N m] about it, in the axes of the body.

        Raises
        ------
        InputError
            If there is no such constraint, or it does not act on this body.
        """
        self._link(body)
        rows = [k for k, row in enumerate(self._loops.constraints) if row.cut == constraint]
        if not rows:
            known = [cut.name for cut in self._system.cuts]
            known += [other.name for other in self._system.constraints]
            raise InputError(unknown_name("constraint", constraint, known))
        force = torque = ops.vector(0.0, 0.0, 0.0)
        touched: set[str] = set()
        for row in rows:
            for wrench in self._actions[row].wrenches:
                touched.add(wrench.body)
                if wrench.body == body:
                    force = force + self._unknown[row] * wrench.force
                    torque = torque + self._unknown[row] * wrench.torque
        if body not in touched:
            raise InputError(_acts_elsewhere(constraint, body, touched))
        return _in_axes_of(body, JointWrench(force, torque))

    def multiplier(self, constraint: str, channel: str) -> Scalar:
        """Return the multiplier of one row of a cut or constraint, as solved [N or N m].

        Parameters
        ----------
        constraint
            Name of the cut or constraint.
        channel
            ``force_channel`` of the row.

        Raises
        ------
        InputError
            If there is no such row, or redundant constraints leave its multiplier undetermined.
        """
        label = f"{constraint}.{channel}"
        labels = [row.label for row in self._loops.constraints]
        if label not in labels:
            raise InputError(unknown_name("force of a constraint", label, labels))
        row = labels.index(label)
        if row in self._loops.undetermined:
            raise InputError(
                f"the force '{label}' is not unique, as redundant constraints share their load; "
                "take away a constraint, or let a body move that they hold",
                about=[constraint],
            )
        return self._values[row]

    @property
    def redundant(self) -> list[str]:
        """Names of the forces of constraints that are not unique."""
        return [self._loops.constraints[k].label for k in sorted(self._loops.undetermined)]

    def settled(self, column: Vec) -> tuple[list[Scalar], list[bool]]:
        """Return the entries of a column with the multipliers replaced, and which are unique.

        An entry that is not unique, because redundant constraints share their load, is not a
        number.
        """
        unique = self._unique(column)
        values = column
        if self._unknown.shape[0]:
            values = ops.substitute(column, self._unknown, self._values)
        return [values[k] if u else ops.scalar(np.nan) for k, u in enumerate(unique)], unique

    def _unique(self, column: Vec) -> list[bool]:
        found = np.ones(column.shape[0], dtype=bool)
        if not self._loops.stresses:
            return list(found)
        entries = self._system.table.entries
        q = self._symbols.coordinate_column
        inputs = [self._symbols.time, q, ops.column([e.symbol for e in entries])]
        slopes = ops.numeric(inputs, ops.jacobian(column, self._unknown))
        for stress in self._loops.stresses:
            at = slopes(stress.time, stress.coordinates, [e.value for e in entries])
            changes = at @ stress.multipliers.T
            limit = NEGLIGIBLE * max(1.0, float(np.abs(at).max(initial=0.0)))
            found &= (np.abs(changes) <= limit).all(axis=1)
        return [bool(item) for item in found]

    @cached_property
    def _actions(self) -> list[UnitAction]:
        rows = self._loops.constraints
        return unit_actions(self._system, rows, self._kinematics, self._symbols.time)

    @cached_property
    def _carried(self) -> dict[int, JointWrench]:
        acting = list(self._wrenches)
        for row, action in enumerate(self._actions):
            multiplier = self._unknown[row]
            acting += [
                Wrench(w.body, multiplier * w.force, multiplier * w.torque) for w in action.wrenches
            ]
        return inverse_dynamics(self._kinematics, acting, unlabelled(self.gravity))[1]

    @property
    def gravity(self) -> Vec:
        """Acceleration of free fall, world axes [m/s²]."""
        return in_axes(ops.vector(*self._system.gravity), WORLD)

    def _link(self, body: str) -> int:
        known = self._kinematics.tree.body_link
        if body not in known:
            raise InputError(unknown_name("body", body, known))
        return known[body]


def _acts_elsewhere(constraint: str, body: str, touched: set[str]) -> str:
    if not touched:
        return f"'{constraint}' acts on coordinates, not on bodies; its own channels show its force"
    listed = ", ".join(f"'{name}'" for name in sorted(touched))
    return f"'{constraint}' does not act on body '{body}'; it acts on {listed}"


def _in_axes_of(body: str, wrench: JointWrench) -> JointWrench:
    """Return a wrench labelled with the axes of the body that it is given in."""
    axes = body_axes(body)
    return JointWrench(
        in_axes(unlabelled(wrench.force), axes), in_axes(unlabelled(wrench.torque), axes)
    )
