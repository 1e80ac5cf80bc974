"""Joint reactions and constraint forces balance the momentum of every body, in any state."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import pytest
from evaluation import Derived
from random_systems import CLOSED, Motor, each_with_seeds, tree

from vehicledyn.codegen.passes.kernel_functions import count_operations
from vehicledyn.codegen.toolchain.compiler import CompilationError, find_compiler
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody.elements.force_sensors import ConstraintForceSensor, ReactionSensor
from vehicledyn.multibody.elements.transmissions import Gears
from vehicledyn.multibody.equations.derivation import derive
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.constraints import Geometry, RateConstraint, UserConstraint
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import BasePart, Output, Situation
from vehicledyn.multibody.model.tree import unfold
from vehicledyn.multibody.recursion import inertia
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel

IDENTITY = 1e-10
AXES = "xyz"


@dataclass(frozen=True)
class Momentum(BasePart):
    """Momentum and angular momentum about the centre of mass, and where that is, world axes."""

    body: object = None

    def outputs(self, situation):
        k, b = situation.kinematics, self.body
        turn, com = k.rotation(b.name), tuple(b.com)
        spin = turn @ (inertia.matrix_of(b.inertia) @ k.angular_velocity(b.name))
        rows = {
            "p": (0.0 if b.mass is None else b.mass) * k.velocity(b.name, com),
            "h": spin,
            "com": k.position(b.name, com),
            "origin": k.position(b.name),
        }
        return tuple(
            Output(Channel(f"{self.name}.{word}_{axis}", "1", word), value[i])
            for word, value in rows.items()
            for i, axis in enumerate(AXES)
        )


def edge(movement):
    """A point of a body does not move in a direction of the body."""
    across = movement.rotation("second")[:, 1]
    return ops.dot(across, movement.velocity("second", (0.2, 0.1, 0.3)))


def height(geometry):
    """Height of a point of one body over a curved surface that another carries."""
    local = geometry.rotation("first").T @ (
        geometry.position("second", (0.1, 0.3, 0.2)) - geometry.position("first")
    )
    return local[0] * local[0] + ops.sin(local[1]) + local[2]


def constrained_tree(seed):
    """A random tree whose coordinates, points and rates are tied by constraints."""
    system = tree(seed)
    start = {j.name: j.start for j in system.joints()}
    q = {name: ops.scalar(value) for name, value in start.items()}
    kinematics = Kinematics(unfold(system.bodies), q, q)
    entries = system.table.entries
    first = ops.numeric(
        [ops.column([e.symbol for e in entries])], height(Geometry(ops.scalar(0.0), kinematics))
    )([e.value for e in entries])[0, 0]
    turned = start["first.q0"] + 0.7 * start["root.q0"]
    constraints = (
        Gears("gears", "first.q0", "root.q0", 0.7, offset=turned),
        UserConstraint("surface", lambda g: height(g) - first),
        RateConstraint("edge", edge),
    )
    return replace(system, constraints=constraints)


SYSTEMS = [tree, constrained_tree, *CLOSED]


def acting(system):
    """Bodies that each cut or constraint acts on."""
    found = {c.name: {c.body_a, c.body_b} for c in system.cuts}
    for constraint in system.constraints:
        found[constraint.name] = {
            "surface": {"first", "second"}, "edge": {"second"}, "gears": set(),
        }[constraint.name]  # fmt: skip
    return found


def equipped(make, seed):
    """The system with sensors of all momenta, reactions and constraint forces."""
    system = make(seed)
    sensors = []
    for body in system.bodies:
        sensors.append(Momentum(f"{body.name}.motion", body))
        sensors.append(ReactionSensor(f"{body.name}.reaction", body.name))
    for name, bodies in acting(system).items():
        for body in bodies - {GROUND}:
            sensors.append(ConstraintForceSensor(f"{name}.on.{body}", name, body))
    return system.with_parts(*sensors)


@lru_cache(maxsize=64)
def derived(make, seed):
    return Derived(equipped(make, seed), seed)


def all_systems(test):
    return pytest.mark.parametrize(("make", "seed"), each_with_seeds(SYSTEMS))(test)


def triple(d, name):
    values = d.output
    return np.array([values[f"{name}_{axis}"] for axis in AXES])


def change(d, name):
    return d.along(d.expression(*(f"{name}_{axis}" for axis in AXES)))


def loads_of(d):
    """Force and torque about its origin that the parts put on each body, world axes."""
    system = d.system
    q, qd, _ = d.coordinates
    symbols = [{n: ops.symbol(n) for n in q} for _ in range(2)]
    kinematics, time = Kinematics(unfold(system.bodies), *symbols), ops.symbol("time")
    states = dict(zip((s.name for s in d.equations.states), d.point[1], strict=True))
    total = {b.name: [ops.vector(0.0, 0.0, 0.0)] * 2 for b in system.bodies}
    for part in system.parts:
        own = {v.name: states[f"{part.name}.{v.name}"] for v in part.states()}
        for w in part.loads(Situation(time, own, {}, kinematics)).wrenches:
            if w.body in total:
                turn = kinematics.rotation(w.body)
                force, torque = total[w.body]
                total[w.body] = [force + turn @ w.force, torque + turn @ w.torque]
    inputs = [time, *(ops.column(list(s.values())) for s in symbols), d.equations.parameter]
    columns = ops.column([t[i] for pair in total.values() for t in pair for i in range(3)])
    numbers = ops.numeric(inputs, columns)(
        d.time, list(q.values()), list(qd.values()), d.parameters
    )
    return dict(zip(total, numbers.reshape(-1, 2, 3), strict=True))


@all_systems
def test_every_body_is_in_balance(make, seed):
    """Newton's and Euler's laws with momenta differentiated along the motion."""
    d = derived(make, seed)
    system, loads = d.system, loads_of(d)
    gravity = d.value(ops.vector(*system.gravity))[:, 0]
    touched = acting(make(seed))
    scale = np.nanmax(np.abs([triple(d, f"{b.name}.reaction.force") for b in system.bodies]))
    unique = 0
    for body in system.bodies:
        name = body.name
        com, origin = triple(d, f"{name}.motion.com"), triple(d, f"{name}.motion.origin")
        mass = 0.0 if body.mass is None else d.value(ops.scalar(body.mass))[0, 0]
        pairs = [(origin, *loads[name]), (com, mass * gravity, np.zeros(3))]
        pairs.append((origin, *wrench(d, f"{name}.reaction")))
        for child in system.bodies:
            if child.parent == name:
                place = triple(d, f"{child.name}.motion.origin")
                force, torque = wrench(d, f"{child.name}.reaction")
                pairs.append((place, -force, -torque))
        for constraint, bodies in touched.items():
            if name in bodies:
                pairs.append((origin, *wrench(d, f"{constraint}.on.{name}")))
        force = sum(f for _, f, _ in pairs)
        torque = sum(t + np.cross(at - com, f) for at, f, t in pairs)
        told = np.isfinite(force)
        assert (force - change(d, f"{name}.motion.p"))[told] == pytest.approx(
            0.0, abs=IDENTITY * scale
        )
        told_torque = np.isfinite(torque)
        assert (torque - change(d, f"{name}.motion.h"))[told_torque] == pytest.approx(
            0.0, abs=IDENTITY * scale
        )
        unique += told.sum() + told_torque.sum()
    assert unique == (6 if "planar" not in system.name else 3) * len(system.bodies)


def wrench(d, name):
    return triple(d, f"{name}.force"), triple(d, f"{name}.torque")


@dataclass(frozen=True)
class Slip(BasePart):
    """Velocity of a body's origin and spin relative to its parent, in the axes of the body."""

    body: object = None

    def outputs(self, situation):
        k, b = situation.kinematics, self.body
        turn, arm = k.rotation(b.name).T, k.position(b.name) - k.position(b.parent)
        spin = k.rotation(b.parent) @ k.angular_velocity(b.parent)
        moving = k.velocity(b.name) - k.velocity(b.parent) - ops.cross(spin, arm)
        turning = k.angular_velocity(b.name) - turn @ spin
        return tuple(
            Output(Channel(f"{self.name}.{word}_{axis}", "1", word), value[i])
            for word, value in (("v", turn @ moving), ("w", turning))
            for i, axis in enumerate(AXES)
        )


@all_systems
def test_what_joints_transmit_has_no_power_but_that_of_the_forces_on_coordinates(make, seed):
    """Reaction times relative motion = Σ force on the coordinates times rate, of each chain.

    Where a constraint force is put on a wrong body or point, its part along the free directions
    is no longer balanced.
    """
    system = make(seed)
    sensors = []
    for body in system.bodies:
        sensors.append(Slip(f"{body.name}.slip", body))
        sensors.append(ReactionSensor(f"{body.name}.reaction", body.name, axes="body"))
    d = Derived(system.with_parts(*sensors), seed)
    values = d.output
    motors = {part.coordinate for part in system.parts if isinstance(part, Motor)}
    for body in system.bodies:
        pairs = zip(("force", "torque"), ("v", "w"), strict=True)
        triples = [
            (triple(d, f"{body.name}.reaction.{f}"), triple(d, f"{body.name}.slip.{v}"))
            for f, v in pairs
        ]
        power = sum(np.nansum(load * motion) for load, motion in triples)
        terms = []
        for joint in (j for j in body.joints if isinstance(j, Joint)):
            rate = values.get(f"{joint.name}_rate", 0.0)
            terms.append(values.get(f"{joint.name}_force", 0.0) * rate)
            terms.append((2.0 - 0.7 * rate) * rate if joint.name in motors else 0.0)
            if "gears.torque" in values:
                gears_force = {"first.q0": "gears.torque", "root.q0": "gears.driving_torque"}
                terms.append(values.get(gears_force.get(joint.name, ""), 0.0) * rate)
        size = 1.0 + max(np.nanmax(np.abs(load), initial=0.0) for load, _ in triples)
        assert power == pytest.approx(sum(terms), abs=IDENTITY * size)


@pytest.mark.parametrize("axes", ["world", "body", "parent"])
def test_named_frames_and_points_tell_the_same_wrench(axes):
    system = tree(3)
    point = (0.2, -0.1, 0.4)
    d = Derived(
        system.with_parts(
            ReactionSensor("plain", "fourth"),
            ReactionSensor("moved", "fourth", point, axes=axes),
            ReactionSensor("start", "fourth", of="parent", axes=axes),
            ReactionSensor("fixed", "fourth", point, of="parent", axes=axes),
        ),
        3,
    )
    body = next(b for b in system.bodies if b.name == "fourth")
    q, qd, _ = d.coordinates
    symbols = [{n: ops.symbol(n) for n in q} for _ in range(2)]
    kinematics = Kinematics(unfold(system.bodies), *symbols)
    inputs = [ops.column(list(s.values())) for s in symbols]

    def numbers(expression):
        known = [*inputs, d.equations.parameter]
        return ops.numeric(known, expression)(list(q.values()), list(qd.values()), d.parameters)

    frame = {"world": GROUND, "body": "fourth", "parent": body.parent}[axes]
    turn = numbers(kinematics.rotation(frame)).T
    origin = numbers(kinematics.position("fourth"))[:, 0]
    force, torque = wrench(d, "plain")
    places = {
        "moved": kinematics.position("fourth", point),
        "start": kinematics.position(body.parent, tuple(body.at)),
        "fixed": kinematics.position(body.parent, point),
    }
    for name, place in places.items():
        arm = numbers(place)[:, 0] - origin
        told = wrench(d, name)
        assert told[0] == pytest.approx(turn @ force, rel=1e-11, abs=1e-11)
        assert told[1] == pytest.approx(
            turn @ (torque - np.cross(arm, force)), rel=1e-10, abs=1e-10
        )


@pytest.mark.parametrize("seed", [0, 1])
def test_formulations_give_the_same_reactions(seed):
    system = equipped(tree, seed)
    outputs = []
    for formulation in ("composite", "articulated"):
        e = derive(system, formulation=formulation)
        f = ops.numeric([e.time, e.state, e.algebraic, e.parameter], e.output)
        state = np.random.default_rng(seed).uniform(-0.5, 0.5, size=len(e.states))
        found = f(0.3, state, [], [p.value for p in e.parameters])[:, 0]
        outputs.append({c.name: v for c, v in zip(e.channels, found, strict=True)})
    for name, value in outputs[0].items():
        assert outputs[1][name] == pytest.approx(value, rel=IDENTITY, abs=IDENTITY), name


def test_reactions_cost_nothing_in_the_right_hand_side():
    plain, full = count_operations(derive(tree(1))), count_operations(derive(equipped(tree, 1)))
    assert full["rates"] == plain["rates"]
    assert full["outputs"] > plain["outputs"]


@pytest.mark.parametrize("make", [CLOSED[0], CLOSED[3]])
@pytest.mark.long
def test_compiled_and_interpreted_reactions_agree(make):
    d = derived(make, 0)
    kernel = compile_kernel(d.equations, backend="interpreted")
    told = kernel.outputs(0.0, d.point[1], d.point[2])
    assert told == pytest.approx(list(d.output.values()), rel=1e-12, abs=1e-11, nan_ok=True)
    if find_compiler_or_none() is None:
        pytest.skip("no C compiler")
    compiled = compile_kernel(d.equations, backend="compiled")
    assert compiled.outputs(0.0, d.point[1], d.point[2]) == pytest.approx(
        told, rel=1e-12, abs=1e-11, nan_ok=True
    )


def find_compiler_or_none():
    try:
        return find_compiler()
    except CompilationError:
        return None
