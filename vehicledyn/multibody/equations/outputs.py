"""Outputs of a solved system: coordinates, cut forces, drive forces, energies, parts' channels."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.base.validation_messages import lower_first
from vehicledyn.multibody.equations.multipliers import Projection
from vehicledyn.multibody.loops.closure import Closure, MultiplierClosure
from vehicledyn.multibody.loops.loop_closure import Loops
from vehicledyn.multibody.loops.reactions import SolvedForces
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import Loads, Output, Wrench, outputs_of
from vehicledyn.multibody.model.symbols import Symbols, locked
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.recursion import inertia
from vehicledyn.multibody.recursion.flexible_inertia import deformable_energies
from vehicledyn.multibody.recursion.newton_euler import inverse_dynamics
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar, Vec

_BEFORE = "before they are projected onto them"
DRIFT_CHANNELS = (
    Channel("constraints.position_drift", "m", f"Largest gap of the states, {_BEFORE}"),
    Channel("constraints.velocity_drift", "m/s", f"Largest opening speed of the states, {_BEFORE}"),
)
"""What systems with multipliers show besides."""


@dataclass(frozen=True)
class Solved:
    """Everything that is known once the accelerations are."""

    kinematics: Kinematics
    accelerations: dict[str, Scalar]
    wrenches: list[Wrench]
    joint_forces: dict[str, Scalar]
    rates: dict[str, Scalar]
    loads: dict[str, Loads]
    gravity: Vec


@dataclass(frozen=True)
class Exerted:
    """Forces that the solved motion takes, from inverse dynamics.

    ``needed`` is what each coordinate needs beyond the parts, by name [N or N m],
    ``multipliers`` that of each kept row of the constraints.
    """

    needed: dict[str, Scalar]
    multipliers: dict[int, Scalar]
    transmitted: SolvedForces


def exerted(system: System, symbols: Symbols, loops: Loops, solved: Solved) -> Exerted:
    """Return the forces of drives and constraints."""
    closure = loops.closure
    needed, _ = inverse_dynamics(solved.kinematics, solved.wrenches, solved.gravity)
    needed = {n: f - solved.joint_forces.get(n, 0.0) for n, f in needed.items()}
    names = [j.name for j in symbols.joints]
    multipliers = closure.multipliers({k: needed[names[k]] for k in closure.partition.columns})
    forces = SolvedForces(
        system,
        symbols,
        loops,
        kinematics=solved.kinematics,
        wrenches=solved.wrenches,
        multipliers=multipliers,
    )
    return Exerted(needed, multipliers, forces)


def observe(
    system: System,
    symbols: Symbols,
    loops: Loops,
    solved: Solved,
    forces: Exerted,
) -> list[Output]:
    """Return all channels of a system; they cost nothing while nobody samples them."""
    multipliers = forces.multipliers
    drive = _drive_forces(symbols, loops.closure, forces.needed, multipliers)
    outputs = [
        *_coordinates(system, symbols, solved),
        *_part_states(system, symbols),
        *_cut_forces(loops, multipliers),
        *_drives(system, symbols, drive),
        *_constraint_errors(symbols, loops, solved),
        *_energies(system, solved, drive, _driven_power(loops, multipliers)),
    ]
    for part in system.parts:
        situation = symbols.situation(part, solved.kinematics, forces.transmitted)
        outputs.extend(outputs_of(part, situation))
    return [Output(o.channel, ops.scalar(o.expression)) for o in outputs]


def _coordinates(system: System, symbols: Symbols, solved: Solved) -> list[Output]:
    fixed = locked(system, symbols)
    outputs = []
    for joint in symbols.joints:
        if joint.name in fixed:
            continue
        text = joint.description or joint.name
        frame = "joint"
        if not joint.type.is_paired:
            value = solved.kinematics.coordinate(joint.name)
            outputs.append(Output(Channel(joint.name, joint.unit, text, frame), value))
            continue
        position = solved.kinematics.coordinate(joint.name)
        rate = solved.kinematics.rate(joint.name)
        outputs.append(Output(Channel(joint.name, joint.unit, text, frame), position))
        name = f"{joint.name}_rate"
        outputs.append(
            Output(Channel(name, f"{joint.unit}/s", f"Rate of {lower_first(text)}", frame), rate)
        )
    return outputs


def _part_states(system: System, symbols: Symbols) -> list[Output]:
    return [
        Output(
            Channel(f"{part.name}.{v.name}", v.unit, v.description),
            symbols.states[part.name][v.name],
        )
        for part in system.parts
        for v in part.states()
    ]


def _cut_forces(loops: Loops, multipliers: dict[int, Scalar]) -> list[Output]:
    """Return the multipliers as forces, but those that redundant constraints leave undetermined."""
    outputs = []
    vague = loops.undetermined
    for row, constraint in enumerate(loops.constraints):
        r = constraint.residual
        if row not in multipliers or row in vague or not r.force_channel:
            continue
        channel = Channel(constraint.label, r.force_unit, r.force_description, constraint.frame)
        outputs.append(Output(channel, r.sign * multipliers[row]))
        for other in r.more:
            name = f"{constraint.cut}.{other.channel}"
            channel = Channel(name, other.unit, other.description, constraint.frame)
            outputs.append(Output(channel, other.factor * multipliers[row]))
    return outputs


def _drive_forces(
    symbols: Symbols,
    closure: Closure | MultiplierClosure,
    needed: dict[str, Scalar],
    multipliers: dict[int, Scalar],
) -> dict[str, Scalar]:
    """Return the force that each driven coordinate's drive supplies."""
    forces: dict[str, Scalar] = {}
    for k, joint in enumerate(symbols.joints):
        if joint.role != "driven":
            continue
        force = needed[joint.name]
        for row, multiplier in multipliers.items():
            force = force - closure.jacobian[row].get(k, 0.0) * multiplier
        forces[joint.name] = force
    return forces


def _drives(system: System, symbols: Symbols, forces: dict[str, Scalar]) -> list[Output]:
    fixed = locked(system, symbols)
    outputs = []
    for joint in symbols.joints:
        if joint.name in forces and joint.name not in fixed:
            text = f"Drive force on {lower_first(joint.description or joint.name)}"
            channel = Channel(f"{joint.name}_force", joint.force_unit, text, "joint")
            outputs.append(Output(channel, forces[joint.name]))
    return outputs


def _constraint_errors(symbols: Symbols, loops: Loops, solved: Solved) -> list[Output]:
    """Return the largest position and velocity error of all loop constraints."""
    if not loops.constraints:
        return []
    closure = loops.closure
    names = [j.name for j in symbols.joints]
    position: Scalar = 0.0
    velocity: Scalar = 0.0
    for row, constraint in enumerate(loops.constraints):
        if constraint.is_holonomic:
            position = ops.maximum(position, ops.absolute(constraint.residual.expression))
        speed = closure.rate[row]
        for k, entry in closure.jacobian[row].items():
            speed = speed + entry * solved.rates[names[k]]
        velocity = ops.maximum(velocity, ops.absolute(speed))
    return [
        Output(Channel("constraints.position_error", "m", "Largest gap of a loop cut"), position),
        Output(
            Channel("constraints.velocity_error", "m/s", "Largest opening speed of a loop cut"),
            velocity,
        ),
    ]


def drifts(projection: Projection | None) -> list[Output]:
    """Return how far the states have drifted off the constraints that they are put onto."""
    if projection is None:
        return []
    values = (projection.gap, projection.opening)
    pairs = zip(DRIFT_CHANNELS, values, strict=True)
    return [Output(channel, ops.scalar(value)) for channel, value in pairs]


def _driven_power(loops: Loops, multipliers: dict[int, Scalar]) -> Scalar:
    """Return the power of the constraints that depend on time, -λᵀ (∂h/∂t, b) [W]."""
    power = ops.scalar(0.0)
    for row, multiplier in multipliers.items():
        power = power - multiplier * loops.closure.rate[row]
    return power


def _energies(
    system: System, solved: Solved, drive: dict[str, Scalar], constraint_power: Scalar
) -> list[Output]:
    """Return kinetic and gravity energy, and the power of all other forces and drives."""
    kinematics = solved.kinematics
    kinetic: Scalar = 0.0
    height: Scalar = 0.0
    for body in system.bodies:
        if body.mass is None:
            continue
        if body.flexibility is not None:
            moving, weight = deformable_energies(kinematics, body, solved.gravity)
            kinetic, height = kinetic + moving, height + weight
            continue
        link = kinematics.tree.body_link[body.name]
        omega = kinematics.link_angular_velocity(link)
        com = ops.vector(*body.com)
        velocity = kinematics.link_velocity(link) + ops.cross(omega, com)
        turning = ops.dot(omega, inertia.matrix_of(body.inertia) @ omega)
        kinetic = kinetic + 0.5 * (body.mass * ops.dot(velocity, velocity) + turning)
        where = kinematics.position_in(-1, link, com)
        height = height - body.mass * ops.dot(solved.gravity, where)
    for name, reflected in kinematics.tree.reflected_inertias.items():
        kinetic = kinetic + 0.5 * reflected * solved.rates[name] ** 2
    power = constraint_power
    for wrench in solved.wrenches:
        link = kinematics.tree.body_link[wrench.body]
        power = power + ops.dot(wrench.force, kinematics.link_velocity(link))
        power = power + ops.dot(wrench.torque, kinematics.link_angular_velocity(link))
    for name, force in (*solved.joint_forces.items(), *drive.items()):
        power = power + force * solved.rates[name]
    return [
        Output(Channel("energy.kinetic", "J", "Kinetic energy of all bodies"), kinetic),
        Output(Channel("energy.gravity", "J", "Potential energy in the gravity field"), height),
        Output(Channel("power.forces", "W", "Power of all forces and drives but gravity"), power),
    ]
