"""An axle on a suspension rig: body held, wheels at given heights, loads at the contact points.

The rig takes the system as it is and changes what holds it: the body from which the wheel sensors
look stands still, wheels do not spin, tyres and drives are left out, a pad under each wheel keeps
the height of its lowest point over the body, and loads act where a tyre's would. What is left
free, as a carrier in bushings, comes to rest where all forces balance. Gravity acts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.model_hash import model_facts
from vehicledyn.analyses.preparation.prepare import BALANCE_TOLERANCE
from vehicledyn.analyses.preparation.runnable import start_values
from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.files.scenario.target import Target
from vehicledyn.multibody.elements.drives import ConstantRate, TimeLaw
from vehicledyn.multibody.elements.wheel_angles import WheelAngles
from vehicledyn.multibody.model.bodies import Body, Joint
from vehicledyn.multibody.model.constraints import Geometry, UserConstraint
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Part, Situation, Wrench
from vehicledyn.multibody.model.system import System
from vehicledyn.road.wheel.road_wheel import RoadWheel
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar

Array = NDArray[np.float64]

LOADS = (
    ("force_x", "N", "Force at the contact point, forward"),
    ("force_y", "N", "Force at the contact point, to the left"),
    ("drive", "N", "Force at the wheel centre, forward"),
    ("moment", "N*m", "Moment about the vertical axis, to the left"),
)
"""What a rig puts on a wheel."""

_LOADING = ("links", "springs", "bushings", "elements", "forces", "wrenches")
"""Sections whose parts belong to the file's own test rig where it lists them there."""


@dataclass(frozen=True)
class _PadLoad(BasePart):
    """Loads on a wheel carrier, in the axes of the body that the wheel is seen from."""

    sensor: WheelAngles
    given: Mapping[str, Scalar]

    def loads(self, situation: Situation) -> Loads:
        """Return the wrench on the carrier."""
        sensor = self.sensor
        turn = self._turn(situation)
        seen = {o.channel.name: o.expression for o in sensor.outputs(situation)}
        centre, contact = (
            ops.vector(*(seen[f"{sensor.name}.{head}{axis}"] for axis in "xyz"))
            for head in ("", "contact_")
        )
        g = self.given
        at_contact = ops.vector(g["force_x"], g["force_y"], 0.0)
        moment = ops.cross(contact - centre, at_contact) + ops.vector(0.0, 0.0, g["moment"])
        force = turn.T @ (at_contact + ops.vector(g["drive"], 0.0, 0.0))
        arm = ops.vector(*sensor.centre)
        return Loads(
            wrenches=(Wrench(sensor.body, force, turn.T @ moment + ops.cross(arm, force)),)
        )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the elements of the rotation from the carrier to the reference body."""
        turn = self._turn(situation)
        return tuple(
            Output(Channel(f"{self.name}.turn_{i}{j}", "1", "Rotation of the carrier"), turn[i, j])
            for i in range(3)
            for j in range(3)
        )

    def _turn(self, situation: Situation) -> ops.Mat:
        k, sensor = situation.kinematics, self.sensor
        turn = k.rotation(sensor.body)
        return turn if sensor.seen_from == GROUND else k.rotation(sensor.seen_from).T @ turn


class Bench:
    """An axle on the rig: parameters in, channels at rest out.

    Attributes
    ----------
    corners
        The wheel sensors.
    steering
        Coordinate that steers, empty where nothing does.
    channels
        All channels of the system by name.
    held
        Coordinates that stand still where expressions of parameters say.
    heights
        Heights of the contact points in the design position [m].
    design_tracks
        y of the contact points in the design position [m].
    lengths
        Channels of the lengths of springs and dampers.
    design
        The axle in the design position.
    equations
        Those of the axle on the rig.
    controls
        Names of the rig's parameters.
    pairs
        States that are free at rest, and the rates that vanish.
    place
        States and unknowns at the place asked for last.
    """

    def __init__(self, target: Target, steering: str | None) -> None:
        """Put an axle on the rig.

        Raises
        ------
        InputError
            If the system has no wheel sensors, a wheel cannot rise, or the steering is not one of
            its coordinates.
        NumericalError
            If its loops cannot be assembled.
        """
        from vehicledyn.kernel.derivatives import Derivatives
        from vehicledyn.kernel.make_kernel import compile_kernel
        from vehicledyn.multibody.equations.derivation import derive
        from vehicledyn.multibody.loops.position_level import Positions

        system = build_subject(target).system
        self.corners = _corners(system, target)
        self.steering = _steering(system, steering)
        system = _stripped(system, target, self.corners, self.steering)
        standing = [f"{corner.name}.contact_{axis}" for corner in self.corners for axis in "yz"]
        self.design = Positions(system, kept=standing)
        values = self.design.values(self.design.start)
        place = dict(zip((c.name for c in self.design.channels), values, strict=True))
        self.heights = tuple(place[f"{corner.name}.contact_z"] for corner in self.corners)
        self.design_tracks = tuple(place[f"{corner.name}.contact_y"] for corner in self.corners)
        held = {c.name for c in self.design.coordinates if c.role == "driven"} - {self.steering}
        self.held = sorted(held & {*system.starts})
        system = self._mounted(system)
        system = replace(system, constraint_method="partitioning")
        e = self.equations = derive(system)
        self._kernel = compile_kernel(e, backend="interpreted")
        self._names = [p.name for p in e.parameters]
        self.controls = tuple(name for name in self._names if name.startswith("rig."))
        self._derivatives = Derivatives(e, self.controls)
        self.channels = {c.name: c for c in e.channels}
        for k, corner in enumerate(self.corners):
            if self.pad(k) not in self.channels:
                raise InputError(
                    f"{target.origin}: nothing lets the wheel of '{corner.name}' rise from the "
                    "body; give its carrier a joint that does"
                )
        state = start_values(e)
        state[list(e.velocities)] = 0.0
        moving = {*e.positions, *e.velocities}
        further = [k for k in range(len(e.states)) if k not in moving]
        self.pairs = [*e.positions, *further], [*e.velocities, *further]
        self.place = state, np.array([u.start for u in e.unknowns])
        self._lift = 0.0
        self.lengths = tuple(
            c.name for c in e.channels if c.unit == "m" and c.name.endswith(".length")
        )
        self._begin = self.place

    @property
    def facts(self) -> tuple[Any, ...]:
        """What distinguishes this axle from others."""
        return model_facts(self.equations, [p.value for p in self.equations.parameters])

    @property
    def parameters(self) -> Array:
        """Parameters at the place asked for last, those of the rig among them."""
        return self._kernel.parameters.copy()

    def restart(self) -> None:
        """Follow the next place from the design position."""
        self.place = self._begin

    def lift(self, travel: float) -> None:
        """Lift all wheels at every place beside what is asked for [m]."""
        self._lift = travel

    @property
    def lifted(self) -> float:
        """Travel of all wheels beside what is asked for [m]."""
        return self._lift

    def pad(self, corner: int) -> str:
        """Return the channel of the load of a wheel, positive upwards [N]."""
        return f"rig.pad_{corner}.multiplier"

    def turn(self, corner: int, seen: Mapping[str, complex]) -> NDArray[Any]:
        """Return the rotation of a carrier among the channels of a place, shape (3, 3)."""
        return np.array([[seen[f"rig.{corner}.turn_{i}{j}"] for j in range(3)] for i in range(3)])

    def at(self, values: Mapping[str, float]) -> dict[str, float]:
        """Return all channels at rest, followed from the place asked for before.

        Parameters
        ----------
        values
            Parameters of the rig by name, see ``controls``; the others are zero.

        Raises
        ------
        NumericalError
            If loops do not close, or nothing balances there.
        """
        from vehicledyn.analyse.equilibrium import find_equilibrium

        numbers = self._kernel.parameters.copy()
        for k, name in enumerate(self._names):
            if name.startswith("rig."):
                lift = self._lift if name.startswith("rig.travel_") else 0.0
                numbers[k] = values.get(name, 0.0) + lift
        self._kernel.set_parameters(numbers)
        found = find_equilibrium(
            self.equations,
            self._kernel,
            time=0.0,
            state=self.place[0].copy(),
            unknowns=self.place[1].copy(),
            free=self.pairs[0],
            balanced=self.pairs[1],
            tolerance=BALANCE_TOLERANCE,
            derivatives=self._derivatives,
        )
        self.place = found.state, found.unknowns
        outputs = self._kernel.outputs(0.0, found.state, found.unknowns)
        return dict(zip(self.channels, map(float, outputs), strict=True))

    def slopes(self, *ways: Mapping[str, float]) -> list[dict[str, float]]:
        """Return how all channels at rest follow the rig's parameters, at the place asked for last.

        Parameters
        ----------
        ways
            Directions: changes of the rig's parameters by name; the others stay.

        Raises
        ------
        NumericalError
            If the loops are singular there.
        """
        total = self._derivatives.total(0.0, *self.place, self._kernel.parameters)
        free, balanced = self.pairs
        along = np.array([[way.get(name, 0.0) for way in ways] for name in self.controls])
        pushed = total.rates_by_parameter[balanced] @ along
        moved = np.linalg.lstsq(total.rates[np.ix_(balanced, free)], -pushed, rcond=1e-12)[0]
        rows = total.outputs[:, free] @ moved + total.outputs_by_parameter @ along
        return [dict(zip(self.channels, map(float, row), strict=True)) for row in rows.T]

    def _mounted(self, system: System) -> System:
        """Return the system with pads, loads and a steering that is set."""
        table, pads = system.table, []
        parts: list[Part] = []
        for k, corner in enumerate(self.corners):
            travel = table.add(f"rig.travel_{k}", 0.0, "m", "Travel of the contact point")
            given = {
                name: table.add(f"rig.{name}_{k}", 0.0, unit, text) for name, unit, text in LOADS
            }
            parts.append(_PadLoad(f"rig.{k}", corner, given))
            pads.append(_pad(k, corner, self.heights[k] + travel))
        if self.steering:
            parts.append(_set(system, "rig.steering", self.steering))
        parts += [_set(system, f"rig.held.{name}", name) for name in self.held]
        mounted = system.with_parts(*parts)
        return replace(mounted, constraints=(*mounted.constraints, *pads))


def _set(system: System, name: str, coordinate: str) -> TimeLaw:
    """Return what keeps a coordinate at its start and the value of a new parameter."""
    joint = next(j for j in system.joints() if j.name == coordinate)
    beyond = system.table.add(name, 0.0, joint.unit, f"{coordinate} from its start")
    return TimeLaw(name, coordinate, lambda _: joint.start + beyond)


def _pad(number: int, corner: WheelAngles, height: Scalar) -> UserConstraint:
    """Return the pad that keeps the height of a wheel's lowest point over the body.

    Its multiplier is the vertical force there.
    """

    def law(geometry: Geometry) -> Scalar:
        place = geometry.position(corner.body, corner.centre)
        out = geometry.rotation(corner.body) @ ops.unit(ops.vector(*corner.axis))
        if corner.seen_from != GROUND:
            turn = geometry.rotation(corner.seen_from).T
            place, out = turn @ (place - geometry.position(corner.seen_from)), turn @ out
        drop = corner.radius * ops.sqrt(out[0] * out[0] + out[1] * out[1])
        return place[2] - drop - height

    return UserConstraint(f"rig.pad_{number}", law)


def _corners(system: System, target: Target) -> tuple[WheelAngles, ...]:
    found = tuple(part for part in system.parts if isinstance(part, WheelAngles))
    if not found:
        raise InputError(
            f"{target.origin}: the system has no sensor 'wheel_angles'; give each wheel carrier "
            "one, which says where its wheel is"
        )
    return found


def _steering(system: System, asked: str | None) -> str:
    """Return the coordinate that steers: the one asked for, or the one of a rack."""
    names = [joint.name for joint in system.joints()]
    if asked is not None:
        if asked not in names:
            words = unknown_name("coordinate", asked, names)
            raise InputError(f"{argument('steering')}: {words}")
        return asked
    racks = [n for n in names if "rack" in n.split(".")]
    return racks[0] if len(racks) == 1 else ""


def _stripped(
    system: System, target: Target, corners: Sequence[WheelAngles], steering: str
) -> System:
    """Return the system without what the rig takes the place of, its body held."""
    file = target.written.file
    rig = set() if file is None else {n for s in _LOADING for n in file.rig.get(s, ())}
    parts = tuple(part for part in system.parts if _stays(part, rig))
    wheels = {part.body for part in system.parts if isinstance(part, RoadWheel)}
    driven = {p.coordinate for p in system.parts if isinstance(p, TimeLaw | ConstantRate)}
    spins = {part.spin for part in system.parts if isinstance(part, RoadWheel)}
    held = {corner.seen_from for corner in corners} | _standing(system, corners, wheels)
    bodies = tuple(_held(b, held, spins | driven | {steering}) for b in system.bodies)
    return replace(system, parts=parts, bodies=bodies)


def _stays(part: Part, rig: set[str]) -> bool:
    if isinstance(part, RoadWheel | TimeLaw | ConstantRate):
        return False
    return part.name not in rig


def _standing(system: System, corners: Sequence[WheelAngles], wheels: set[str]) -> set[str]:
    """Return bodies beside the axle, such as a rig's road: on the ground, and of no corner."""
    parents = {body.name: body.parent for body in system.bodies}
    carried = {corner.seen_from for corner in corners} | {corner.body for corner in corners}
    carried |= wheels
    return {
        name
        for name, parent in parents.items()
        if parent == GROUND and name not in carried and name not in parents.values()
    }


def _held(body: Body, held: set[str], coordinates: set[str]) -> Body:
    joints = tuple(
        replace(joint, role="driven")
        if isinstance(joint, Joint) and (body.name in held or joint.name in coordinates)
        else joint
        for joint in body.joints
    )
    return replace(body, joints=joints)
