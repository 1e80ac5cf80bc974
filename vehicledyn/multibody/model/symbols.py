"""Symbols of everything that is unknown: coordinates, rates, further states, contact unknowns."""

from __future__ import annotations

from dataclasses import dataclass, field

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import Clock, DrivenMotion, Part, Situation, TransmittedForces
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.model.tree import Tree
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Variable
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class Symbols:
    """Symbols of a system before it is known which coordinates are independent.

    ``coordinates`` hold the symbols of all positions and ``rates`` the symbols of all speeds,
    and the rates of positions that are expressions of these, by name. ``states``, ``unknowns`` and
    ``reactions`` hold the parts' symbols by part name and short name. The symbols of reactions
    are forces over ``force_scale``, a number near one for any size of system.
    """

    time: Scalar
    joints: list[Joint]
    coordinates: dict[str, Scalar]
    rates: dict[str, Scalar]
    states: dict[str, dict[str, Scalar]]
    unknowns: dict[str, dict[str, Scalar]]
    reactions: dict[str, dict[str, Scalar]] = field(default_factory=dict)
    force_scale: Scalar = 1.0
    idle: dict[str, Scalar] = field(default_factory=dict)

    @property
    def coordinate_column(self) -> Scalar:
        """All coordinates, shape (n, 1); a symbol that is nowhere else for one without position."""
        return ops.column(
            [
                self.coordinates[j.name] if j.type.has_position else self.idle[j.name]
                for j in self.joints
            ]
        )

    @property
    def rate_column(self) -> Scalar:
        """All speeds, shape (n, 1); a symbol that is nowhere else for a coordinate without one."""
        return ops.column(
            [self.rates[j.name] if j.type.has_speed else self.idle[j.name] for j in self.joints]
        )

    @property
    def velocity_column(self) -> Scalar:
        """Rates of :attr:`coordinate_column`, shape (n, 1); zero without position."""
        return ops.column([self.rates[j.name] if j.type.has_position else 0.0 for j in self.joints])

    def by_speeds(self, slopes: Scalar) -> Scalar:
        """Return derivatives by the coordinates as derivatives by what the speeds turn them by.

        ``slopes`` has a column a coordinate, and so has the result; those of coordinates without
        speed are zero.
        """
        if all(j.type.is_paired for j in self.joints):
            return slopes
        return slopes @ ops.jacobian(self.velocity_column, self.rate_column)

    def kinematics(self, tree: Tree) -> Kinematics:
        """Return the kinematics of a tree at these coordinates and rates."""
        return Kinematics(tree, self.coordinates, self.rates)

    def situation(
        self, part: Part, kinematics: Kinematics, forces: TransmittedForces | None = None
    ) -> Situation:
        """Return what a part sees of a motion."""
        return Situation(
            self.time,
            self.states[part.name],
            self.unknowns[part.name],
            kinematics,
            self.states,
            forces,
            {name: self.force_scale * x for name, x in self.reactions[part.name].items()},
        )


def declare(system: System) -> Symbols:
    """Return fresh symbols for a system."""
    joints = system.joints()
    coordinates = {j.name: ops.symbol(j.name) for j in joints if j.type.has_position}
    return Symbols(
        time=ops.symbol("time"),
        joints=joints,
        coordinates=coordinates,
        rates=_rates(joints, coordinates),
        states={p.name: _named(p.name, p.states()) for p in system.parts},
        unknowns={p.name: _named(p.name, p.unknowns()) for p in system.parts},
        reactions={p.name: _named(p.name, p.reactions()) for p in system.parts},
        force_scale=_weight(system),
        idle={j.name: ops.symbol(f"{j.name}_idle") for j in joints if not j.type.is_paired},
    )


def _rates(joints: list[Joint], coordinates: dict[str, Scalar]) -> dict[str, Scalar]:
    """Return symbols of the speeds, and what they make the rates of other positions."""
    found = {j.name: ops.symbol(j.rate_name) for j in joints if j.type.has_speed}
    for joint in joints:
        if joint.type.element == 0:
            given = [coordinates[name] for name in joint.positions]
            rates = joint.type.rates(given, [found[name] for name in joint.speeds])
            found |= dict(zip(joint.positions, rates, strict=True))
    return {j.name: found[j.name] for j in joints}


def _weight(system: System) -> Scalar:
    """Return the weight of all bodies, at least one newton [N]."""
    mass = sum((body.mass for body in system.bodies if body.mass is not None), 0.0)
    return ops.maximum(mass * ops.norm(ops.vector(*system.gravity)), 1.0)


def _named(part: str, variables: tuple[Variable, ...]) -> dict[str, Scalar]:
    return {v.name: ops.symbol(f"{part}.{v.name}") for v in variables}


def motions(system: System, symbols: Symbols) -> dict[str, DrivenMotion]:
    """Return the motion of every driven coordinate; undriven ones stay at their start.

    Raises
    ------
    InputError
        If two parts drive a coordinate, or one drives a coordinate that is not "driven".
    """
    held = {j.name: j.start for j in symbols.joints if j.role == "driven"}
    driven = {
        name: DrivenMotion(system.starts.get(name, start), 0.0) for name, start in held.items()
    }
    owners: dict[str, Part] = {}
    for part in system.parts:
        for name, motion in part.motions(Clock(symbols.time, symbols.states[part.name])).items():
            if name not in driven:
                words = f"part '{part.name}' drives '{name}', which is not a driven joint"
                raise InputError(words, about=[part.name])
            if name in owners:
                words = f"'{name}' is driven by '{owners[name].name}' and '{part.name}'"
                raise InputError(words, about=[owners[name].name, part.name])
            owners[name] = part
            driven[name] = motion
    return {
        name: DrivenMotion(ops.scalar(m.position), ops.scalar(m.velocity))
        for name, m in driven.items()
    }


def locked(system: System, symbols: Symbols) -> set[str]:
    """Return the driven coordinates that no part moves."""
    moved = {
        name
        for part in system.parts
        for name in part.motions(Clock(symbols.time, symbols.states[part.name]))
    }
    return {j.name for j in symbols.joints if j.role == "driven" and j.name not in moved}
