"""Inverse dynamics: the forces that a prescribed motion needs, of trees and of closed systems.

Every independent coordinate becomes a driven one whose position, rate and acceleration are
given. The drive forces of such a system are what its actuators must supply (book, chapters
3.3 and 3.4.2); loops are solved as ever, so that multipliers and cut forces come with them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.multibody.equations.assemble_equations import roles_of
from vehicledyn.multibody.equations.derivation import derive
from vehicledyn.multibody.loops.loop_closure import close
from vehicledyn.multibody.model.bodies import Body, Joint
from vehicledyn.multibody.model.parts import BasePart, Clock, DrivenMotion, Loads, Situation
from vehicledyn.multibody.model.symbols import declare, motions
from vehicledyn.multibody.model.system import System, refuse_quaternions
from vehicledyn.multibody.model.tree import unfold
from vehicledyn.symbolic.equations import Equations, Variable

_PART = "prescribed"
PRESCRIBED = f"{_PART}."
"""What the names of the channels of given positions, rates and accelerations begin with."""


@dataclass(frozen=True)
class PrescribedMotion(BasePart):
    """Drive coordinates along a motion whose numbers are given from outside, as states.

    The states of each coordinate are its position, rate and acceleration; in a simulation the
    acceleration would stay as it is.
    """

    joints: tuple[Joint, ...]

    def states(self) -> tuple[Variable, ...]:
        """Return position, rate and acceleration of each coordinate."""
        found = []
        for j in self.joints:
            text = j.description or j.name
            found += [
                Variable(j.name, j.unit, f"Prescribed {text}", j.start),
                Variable(f"{j.name}_rate", f"{j.unit}/s", f"Rate of {text}", j.start_rate),
                Variable(f"{j.name}_acceleration", f"{j.unit}/s^2", f"Acceleration of {text}"),
            ]
        return tuple(found)

    def motions(self, clock: Clock) -> dict[str, DrivenMotion]:
        """Return the given positions and rates."""
        given = clock.states
        return {j.name: DrivenMotion(given[j.name], given[f"{j.name}_rate"]) for j in self.joints}

    def loads(self, situation: Situation) -> Loads:
        """Return the given accelerations."""
        given = situation.states
        rates = {}
        for j in self.joints:
            rates[j.name] = given[f"{j.name}_rate"]
            rates[f"{j.name}_rate"] = given[f"{j.name}_acceleration"]
            rates[f"{j.name}_acceleration"] = 0.0
        accelerations = {j.name: given[f"{j.name}_acceleration"] for j in self.joints}
        return Loads(rates=rates, accelerations=accelerations)


@dataclass(frozen=True)
class InverseDynamics:
    """Equations of a prescribed motion and the coordinates that are prescribed, in order.

    ``equations`` have no rates worth integrating; their channels hold the result. The force on
    a prescribed coordinate is the channel "<coordinate>_force", what must be supplied beyond
    all parts of the system.
    """

    equations: Equations
    coordinates: tuple[str, ...]

    @property
    def force_channels(self) -> tuple[str, ...]:
        """Names of the channels of the forces on the prescribed coordinates [N or N m]."""
        return tuple(f"{name}_force" for name in self.coordinates)

    def state(
        self, position: ArrayLike, rate: ArrayLike, acceleration: ArrayLike
    ) -> NDArray[np.float64]:
        """Return the state vector of a motion at one time.

        Parameters
        ----------
        position, rate, acceleration
            Of the prescribed coordinates, each of shape (n_coordinates,) in SI.

        Raises
        ------
        InputError
            If one of them has not as many entries as coordinates are prescribed.
        """
        given = dict(
            zip(("", "_rate", "_acceleration"), (position, rate, acceleration), strict=True)
        )
        index = {variable.name: k for k, variable in enumerate(self.equations.states)}
        state = np.array([variable.start for variable in self.equations.states])
        for suffix, values in given.items():
            array = np.asarray(values, dtype=float)
            if array.shape != (len(self.coordinates),):
                raise InputError(
                    f"{len(self.coordinates)} coordinates are prescribed, {array.size} values of "
                    f"their {suffix.strip('_') or 'position'} were given"
                )
            for name, value in zip(self.coordinates, array, strict=True):
                state[index[f"{_PART}.{name}{suffix}"]] = value
        return state

    def state_tangents(
        self, position: ArrayLike, rate: ArrayLike, acceleration: ArrayLike
    ) -> NDArray[np.float64]:
        """Return derivatives of the state vector, shape (n_states, n_directions).

        Parameters
        ----------
        position, rate, acceleration
            Derivatives of the prescribed motion, each of shape (n_coordinates, n_directions).
        """
        index = {variable.name: k for k, variable in enumerate(self.equations.states)}
        tables = [np.asarray(item, dtype=float) for item in (position, rate, acceleration)]
        tangents = np.zeros((len(index), tables[0].shape[1]))
        for suffix, table in zip(("", "_rate", "_acceleration"), tables, strict=True):
            tangents[[index[f"{_PART}.{name}{suffix}"] for name in self.coordinates]] = table
        return tangents


def derive_inverse(system: System, coordinates: Sequence[str] | None = None) -> InverseDynamics:
    """Return the inverse dynamics of a system.

    Parameters
    ----------
    system
        Bodies, cuts and parts. Parts that drive other coordinates stay as they are.
    coordinates
        Names of the coordinates whose motion is prescribed; the independent ones if None.

    Raises
    ------
    InputError
        If a name is unknown, or the coordinates do not determine the motion, or are too many.
    """
    system.check()
    refuse_quaternions(
        system,
        "inverse dynamics",
        "each coordinate is prescribed by itself, and the four components are bound to each other",
    )
    independent, start = _assembled(system)
    # Held at the given start, coordinates that the assembly has moved could not close the loops.
    system = system.with_starts(start)
    chosen = tuple(coordinates or independent)
    joints = {joint.name: joint for joint in system.joints()}
    for name in chosen:
        if name not in joints:
            raise InputError(unknown_name("coordinate", name, joints))
    if len(set(chosen)) != len(independent):
        raise InputError(
            f"system '{system.name}' has {len(independent)} independent coordinate(s), the "
            f"motion of {len(set(chosen))} is prescribed; give one for each"
        )
    part = PrescribedMotion(_PART, tuple(joints[name] for name in chosen))
    driven = replace(
        system,
        bodies=tuple(_driven(body, set(chosen)) for body in system.bodies),
        parts=(*system.parts, part),
    )
    equations = derive(driven)
    left = equations.structure["independent"]
    if left:
        listed = ", ".join(f"'{name}'" for name in left)
        raise InputError(
            f"the prescribed coordinates leave {listed} free; prescribe other coordinates"
        )
    return InverseDynamics(equations, chosen)


def _assembled(system: System) -> tuple[list[str], dict[str, float]]:
    """Return the coordinates that the partition leaves independent, and all as assembled."""
    symbols = declare(system)
    loops = close(system, unfold(system.bodies), symbols, motions(system, symbols))
    return [symbols.joints[k].name for k in roles_of(symbols, loops).independent], loops.start


def _driven(body: Body, names: set[str]) -> Body:
    """Return a body whose named joints are driven; the others may become dependent."""
    joints = tuple(
        replace(j, role=_role(j, names)) if isinstance(j, Joint) else j for j in body.joints
    )
    return replace(body, joints=joints)


def _role(joint: Joint, driven: set[str]) -> str:
    """Return the role of a joint; none stays independent, since the drives leave no freedom."""
    if joint.name in driven:
        return "driven"
    return "auto" if joint.role == "independent" else joint.role
