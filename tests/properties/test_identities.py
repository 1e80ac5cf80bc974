"""Laws of mechanics that hold at any state of random trees and closed systems."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import pytest
from evaluation import Derived, derived
from random_systems import CLOSED, JOINT_KINDS, Builder, Motor, Wind, each_with_seeds, pull, tree

from vehicledyn.multibody.elements.point_forces import Attachment, PointForce
from vehicledyn.multibody.model.bodies import Body, Joint, Turn
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import BasePart, Output, Situation
from vehicledyn.multibody.model.tree import unfold
from vehicledyn.multibody.recursion import inertia
from vehicledyn.multibody.recursion.mass_matrix import mass_matrix
from vehicledyn.multibody.recursion.newton_euler import inverse_dynamics
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.sparse_rows import rows_of

pytestmark = pytest.mark.xdist_group("random_systems")  # derived once

SEEDS = range(6)
IDENTITY = 1e-10


def all_systems(test):
    return pytest.mark.parametrize(("make", "seed"), each_with_seeds([tree, *CLOSED]))(test)


class Numbers:
    """The tree of a system with symbols for every coordinate, and its numbers at a state."""

    def __init__(self, d):
        q, qd, _ = d.coordinates
        self.names = list(q)
        symbols = [{n: ops.symbol(f"{n}{k}") for n in self.names} for k in range(3)]
        self.kinematics = Kinematics(unfold(d.system.bodies), *symbols)
        self._inputs = [*(ops.column(list(s.values())) for s in symbols), d.equations.parameter]
        self._parameters = d.parameters
        self.q, self.qd = np.array(list(q.values())), np.array(list(qd.values()))

    def value(self, expression, qdd):
        return ops.numeric(self._inputs, expression)(self.q, self.qd, qdd, self._parameters)

    def mass(self):
        entries = mass_matrix(self.kinematics, set(self.names))
        n = len(self.names)
        column = ops.column([entries.get((a, b), 0.0) for a in self.names for b in self.names])
        return self.value(column, np.zeros(n))[:, 0].reshape(n, n)


@lru_cache(maxsize=64)
def mass_of(make, seed):
    numbers = Numbers(derived(make, seed))
    return numbers.mass(), numbers.qd


@all_systems
def test_mass_matrix_gives_the_kinetic_energy(make, seed):
    mass, rates = mass_of(make, seed)
    energy = derived(make, seed).output["energy.kinetic"]
    assert 0.5 * rates @ mass @ rates == pytest.approx(energy, rel=IDENTITY)


@all_systems
def test_mass_matrix_is_symmetric_and_positive_definite(make, seed):
    mass, _ = mass_of(make, seed)
    assert mass == pytest.approx(mass.T, rel=1e-12, abs=1e-12 * np.abs(mass).max())
    assert np.linalg.eigvalsh(mass)[0] > 0.0


@pytest.mark.parametrize("seed", SEEDS)
def test_columns_of_the_mass_matrix_are_unit_accelerations(seed):
    """Composite inertias against the backward recursion, which they do not share."""
    d = derived(tree, seed)
    numbers = Numbers(d)
    weightless = ops.vector(0.0, 0.0, 0.0)
    forces, _ = inverse_dynamics(numbers.kinematics, [], weightless)
    column = ops.column([forces[n] for n in numbers.names])
    rest = numbers.value(column, np.zeros(len(numbers.names)))[:, 0]
    mass, _ = mass_of(tree, seed)
    size = np.abs(rest).max() + np.abs(mass).max()
    for k, unit in enumerate(np.eye(len(numbers.names))):
        needed = numbers.value(column, unit)[:, 0] - rest
        assert needed == pytest.approx(mass[:, k], abs=1e-13 * size)


@all_systems
def test_power_balance(make, seed):
    """d(kinetic + gravity)/dt is the power of all other forces and of the drives."""
    d = derived(make, seed)
    energy = d.expression("energy.kinetic", "energy.gravity")
    power = d.output["power.forces"]
    scale = max(1.0, np.abs(d.along(energy)).max())
    assert d.along(energy).sum() == pytest.approx(power, abs=IDENTITY * scale)


@pytest.mark.parametrize(("make", "seed"), each_with_seeds(CLOSED))
def test_constraints_hold_in_position_velocity_and_acceleration(make, seed):
    d = derived(make, seed)
    residual = d.equations.residual
    first = d.derivative(residual)
    assert np.abs(d.value(residual)).max() < 1e-12
    assert np.abs(d.value(first)).max() < 1e-12
    accelerations = np.abs(list(d.rate.values())).max()
    assert np.abs(d.along(first)).max() < 1e-11 * max(1.0, accelerations)
    # The channels look at all constraints, the redundant ones among them.
    assert d.output["constraints.position_error"] < 1e-12
    assert d.output["constraints.velocity_error"] < 1e-12


@pytest.mark.parametrize("seed", SEEDS)
def test_forward_dynamics_undo_inverse_dynamics(seed):
    """Forces needed for the accelerations found are the forces that act."""
    d = derived(tree, seed)
    q, qd, qdd = d.coordinates
    e = d.equations
    states = {v.name: e.state[k] for k, v in enumerate(e.states)}
    numbers = Numbers(d)
    k = numbers.kinematics
    wrenches = []
    for part in d.system.parts:
        own = {v.name: states[f"{part.name}.{v.name}"] for v in part.states()}
        wrenches += part.loads(Situation(e.time, own, {}, k)).wrenches
    needed, _ = inverse_dynamics(k, wrenches, ops.vector(*d.system.gravity))
    column = ops.column([needed[n] for n in numbers.names])
    inputs = [*numbers._inputs, e.time, e.state]
    found = ops.numeric(inputs, column)(
        list(q.values()), list(qd.values()), list(qdd.values()), d.parameters, *d.point[:2]
    )[:, 0]
    for name, force in zip(numbers.names, found, strict=True):
        if name == "second.q0":
            expected = 2.0 - 0.7 * qd[name]
        else:
            expected = d.output.get(f"{name}_force", 0.0)
        assert force == pytest.approx(expected, abs=IDENTITY * max(1.0, np.abs(found).max())), name


@dataclass(frozen=True)
class Momentum(BasePart):
    """Show momentum and angular momentum about the world's origin of some bodies."""

    bodies: tuple

    def outputs(self, situation):
        k = situation.kinematics
        linear = angular = ops.vector(0.0, 0.0, 0.0)
        for body in self.bodies:
            if body.mass is None:
                continue
            turn = k.rotation(body.name)
            p = body.mass * k.velocity(body.name, body.com)
            spin = inertia.matrix_of(body.inertia) @ k.angular_velocity(body.name)
            linear = linear + p
            angular = angular + turn @ spin + ops.cross(k.position(body.name, body.com), p)
        return tuple(
            Output(Channel(f"{word}_{axis}", unit, word), vector[n])
            for word, unit, vector in (("linear", "N*s", linear), ("angular", "N*m*s", angular))
            for n, axis in enumerate("xyz")
        )


def floating(seed):
    """A free-floating tree with inner links and motors and a wind on one body."""
    b = Builder(seed, gravity=(0.0, 0.0, 0.0))
    b.add("root", GROUND, ("T1", "T2", "T3", "R3", "R2", "R1"))
    b.add("frame", "root", ("R2",), massless=True)
    b.add("one", "frame", (JOINT_KINDS[seed % 3], "R3"))
    b.add("two", "root", ("R1", "T2"))
    b.add("three", "two", ("R3",), driven=True)
    b.add_wheel("wheel", "one", 2)
    parts = (
        PointForce(
            "spring", Attachment("one", b.point()), Attachment("two", (0.8, 0.9, 1.0)), pull
        ),
        PointForce(
            "guide",
            Attachment("root", b.point()),
            Attachment("three", b.point()),
            pull,
            direction=(0.6, 0.8, 0.0),
        ),
        Motor("motor", "one.q1"),
        Wind("wind", "two"),
        Momentum("momentum", tuple(b.bodies)),
    )
    return b.system(f"floating {seed}", parts=parts)


@pytest.mark.parametrize("seed", SEEDS)
def test_momentum_rate_is_the_outer_force(seed):
    """Inner links, motors and drives change neither momentum; the wind changes both."""
    system = floating(seed)
    d = Derived(system, seed)
    names = [f"{word}_{axis}" for word in ("linear", "angular") for axis in "xyz"]
    rates = d.along(d.expression(*names))
    e = d.equations
    wind = next(p for p in system.parts if p.name == "wind")
    numbers = Numbers(d)
    k = numbers.kinematics
    gust = e.state[[s.name for s in e.states].index("wind.gust")]
    wrench = wind.loads(Situation(e.time, {"gust": gust}, {}, k)).wrenches[0]
    force = k.rotation("two") @ wrench.force
    torque = k.rotation("two") @ wrench.torque + ops.cross(k.position("two"), force)
    column = ops.column([*(force[n] for n in range(3)), *(torque[n] for n in range(3))])
    inputs = [*numbers._inputs, e.time, e.state]
    zeros = np.zeros(len(numbers.names))
    expected = ops.numeric(inputs, column)(
        numbers.q, numbers.qd, zeros, d.parameters, *d.point[:2]
    )[:, 0]
    assert np.abs(expected).max() > 0.1
    # Parts of the rate cancel that are as large as the forces between the bodies.
    scale = max(np.abs(expected).max(), np.abs(list(d.rate.values())).max())
    assert rates == pytest.approx(expected, abs=IDENTITY * scale)


@pytest.mark.parametrize("seed", [0, 3])
@pytest.mark.parametrize("make", [tree, *CLOSED])
def test_moving_and_turning_the_world_changes_nothing(make, seed):
    """The whole system on a stage elsewhere, gravity turned with it."""
    system = make(seed)
    turn = Builder(seed + 100).turn().rotation
    stage = Body("stage", GROUND, (3.0, -2.0, 0.7), (Turn(turn),))
    bodies = tuple(replace(b, parent="stage") if b.parent == GROUND else b for b in system.bodies)
    g = turn @ ops.vector(*system.gravity)
    moved = replace(
        system,
        bodies=(stage, *bodies),
        cuts=tuple(_on_stage(c) for c in system.cuts),
        parts=tuple(_on_stage(p) for p in system.parts),
        gravity=(g[0], g[1], g[2]),
    )
    here, there = derived(make, seed), Derived(moved, seed)
    assert here.equations.structure["dependent"] == there.equations.structure["dependent"]
    scale = np.abs(list(here.rate.values())).max()
    for name, rate in here.rate.items():
        assert there.rate[name] == pytest.approx(rate, abs=IDENTITY * max(1.0, scale)), name
    for name in ("energy.kinetic", "power.forces"):
        assert there.output[name] == pytest.approx(here.output[name], rel=1e-9, abs=1e-9)


def _on_stage(item):
    for end in ("body_a", "body_b", "body"):
        if getattr(item, end, None) == GROUND:
            item = replace(item, **{end: "stage"})
    for end in ("a", "b"):
        attachment = getattr(item, end, None)
        if isinstance(attachment, Attachment) and attachment.body == GROUND:
            item = replace(item, **{end: replace(attachment, body="stage")})
    return item


LAWS = {
    "spring": lambda z, v: 20.0 * (z - 0.4) + 0.0 * v,
    "damper": lambda z, v: 3.0 * v + v * v * v,
    "branches": lambda z, v: ops.where(v < 0.0, 5.0 * v, 2.0 * v) + ops.exp(z),
    "constant": lambda z, v: 7.0,
}


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", ["link", "guided"])
def test_power_of_a_link(kind, law, seed):
    """A link's power is minus force times rate, and its pair has no net force or moment."""
    b = Builder(seed, gravity=(0.0, 0.0, 0.0))
    b.add("base", GROUND, ("T1", "R3", "R2"))
    b.add("one", "base", ("R1",))
    b.add("two", "base", ("T3", "R2"))
    ends = Attachment("one", b.point()), Attachment("two", (1.0, 0.8, -0.9))
    part = (
        PointForce("link", *ends, LAWS[law])
        if kind == "link"
        else PointForce("link", *ends, LAWS[law], direction=(0.48, 0.6, 0.64))
    )
    d = Derived(b.system("linked", parts=(part,)), seed)
    values = d.output
    power = -values["link.force"] * values["link.rate"]
    assert values["power.forces"] == pytest.approx(power, rel=IDENTITY, abs=IDENTITY)
    assert d.along(d.expression("link.length"))[0] == pytest.approx(values["link.rate"], rel=1e-12)
    numbers = Numbers(d)
    k = numbers.kinematics
    force = torque = ops.vector(0.0, 0.0, 0.0)
    for wrench in part.loads(Situation(ops.symbol("t"), {}, {}, k)).wrenches:
        turned = k.rotation(wrench.body) @ wrench.force
        force = force + turned
        torque = torque + k.rotation(wrench.body) @ wrench.torque
        torque = torque + ops.cross(k.position(wrench.body), turned)
    net = ops.column([*(force[n] for n in range(3)), *(torque[n] for n in range(3))])
    scale = 1e-13 * max(1.0, abs(values["link.force"]))
    assert numbers.value(net, numbers.qd)[:, 0] == pytest.approx(np.zeros(6), abs=10 * scale)


@pytest.mark.parametrize("axis", [1, 2, 3])
def test_a_body_of_revolution_may_spin_without_its_axes(axis):
    """With ``spins_about`` the equations are those of the wheel whose axes turn."""
    results = []
    for spins in (True, False):
        b = Builder(axis)
        b.add("base", GROUND, ("R1", "R2", "T3"))
        b.add_wheel("wheel", "base", axis)
        if not spins:
            b.bodies[-1] = replace(b.bodies[-1], spins_about=None)
        d = Derived(b.system("wheel"), axis)
        results.append({**d.rate, **d.output})
    for name, value in results[0].items():
        assert value == pytest.approx(results[1][name], rel=1e-11, abs=1e-11), name


def test_every_elementary_joint_was_there():
    kinds = {
        j.kind
        for seed in SEEDS
        for body in tree(seed).bodies
        if body.name == "first"
        for j in body.joints
        if isinstance(j, Joint)
    }
    assert kinds == set(JOINT_KINDS)


@pytest.mark.parametrize("seed", range(2))
def test_numbers_and_parameters_give_the_same_equations(seed):
    """A system of plain numbers has the rates of the one whose numbers are parameters."""
    system = replace(tree(seed), parts=())
    d = Derived(system, seed)
    fixed = replace(
        system,
        table=type(system.table)(),
        bodies=tuple(_plain(b, system.table) for b in system.bodies),
        gravity=_numbers(system.gravity, system.table),
    )
    plain = Derived(fixed, seed)
    assert not plain.equations.parameters
    scale = max(1.0, np.abs(list(d.rate.values())).max())
    for name, rate in d.rate.items():
        assert plain.rate[name] == pytest.approx(rate, abs=IDENTITY * scale)


def _numbers(items, table):
    symbols = ops.column([e.symbol for e in table.entries])
    values = ops.numeric([symbols], ops.column(list(items)))([e.value for e in table.entries])
    return tuple(float(v) for v in values[:, 0])


def _plain(body, table):
    mass = None if body.mass is None else _numbers([body.mass], table)[0]
    return replace(
        body,
        at=_numbers(body.at, table),
        com=_numbers(body.com, table),
        inertia=_numbers(body.inertia, table),
        mass=mass,
    )


def test_the_order_of_the_blocks_is_the_order_of_solution():
    """The residuals of a block depend on its own unknowns and those of earlier blocks."""
    for make in CLOSED:
        for seed in (0, 3):
            e = derived(make, seed).equations
            pattern = rows_of(ops.jacobian(e.residual, e.algebraic))
            for block in e.blocks:
                for row in pattern[block.start : block.stop]:
                    assert max(row) < block.stop


@pytest.mark.parametrize("seed", range(4))
def test_tait_bryan_angles_of_a_body(seed):
    b = Builder(seed)
    b.add("body", GROUND, ("R3", "R2", "R1"), turns=False)
    d = Derived(b.system("gimbal"), seed)
    numbers = Numbers(d)
    found = rotations.yaw_pitch_roll(numbers.kinematics.rotation("body"))
    value = numbers.value(ops.column(list(found)), numbers.qd)[:, 0]
    assert value == pytest.approx(numbers.q, abs=1e-14)
