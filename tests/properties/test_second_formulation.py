"""Relative coordinates against absolute ones: accelerations, reactions, cut and drive forces."""

from functools import lru_cache

import numpy as np
import pytest
from absolute_coordinates import Absolute, rotation
from evaluation import derived
from random_systems import CLOSED, Builder, each_with_seeds, planar_loop, tree

from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import Situation, Wrench
from vehicledyn.multibody.model.tree import unfold
from vehicledyn.multibody.recursion.newton_euler import inverse_dynamics
from vehicledyn.symbolic import ops

pytestmark = pytest.mark.xdist_group("random_systems")  # derived once

# The absolute matrix has a condition number near 1e5, hence 1e-9 and not 1e-12.
AGREE = 1e-9
SEEDS = range(6)


def parts_at(d):
    """Wrenches, joint forces and known accelerations of the parts, as numbers, state by state."""
    e = d.equations
    tree_ = unfold(d.system.bodies)
    q, qd, _ = d.coordinates
    symbols = {n: (ops.symbol(n), ops.symbol(n + "_rate")) for n in q}
    k = Kinematics(tree_, *({n: s[order] for n, s in symbols.items()} for order in (0, 1)))
    time = e.time
    states = {v.name: e.state[i] for i, v in enumerate(e.states)}
    old = ops.column([s for pair in symbols.values() for s in pair])
    new = [x for n in symbols for x in (q[n], qd[n])]
    wrenches, forces = [], {}
    driven = {j.name: 0.0 for j in d.system.joints() if j.role == "driven"}

    def number(expression):
        inputs = [old, e.time, e.state, e.parameter]
        return ops.numeric(inputs, ops.scalar(expression))(new, *d.point[:2], d.point[3])

    for part in d.system.parts:
        own = {v.name: states[f"{part.name}.{v.name}"] for v in part.states()}
        loads = part.loads(Situation(time, own, {}, k))
        wrenches += [
            (w.body, number(w.force)[:, 0], number(w.torque)[:, 0]) for w in loads.wrenches
        ]
        for name, force in loads.joint_forces.items():
            forces[name] = forces.get(name, 0.0) + number(force)[0, 0]
        driven.update({n: number(a)[0, 0] for n, a in loads.accelerations.items()})
    return wrenches, forces, driven


@lru_cache(maxsize=64)
def both(make, seed):
    d = derived(make, seed)
    q, qd, _ = d.coordinates
    wrenches, forces, driven = parts_at(d)

    def values(expression):
        return ops.numeric([d.equations.parameter], expression)(d.parameters)

    absolute = Absolute(
        d.system, values, q, qd, wrenches=wrenches, driven=driven, joint_forces=forces
    )
    return d, absolute.solve()


def close(actual, expected, scale):
    return np.abs(np.asarray(actual) - np.asarray(expected)).max() <= AGREE * scale


@pytest.mark.parametrize(("system", "seed"), each_with_seeds([tree, *CLOSED]))
def test_accelerations(system, seed):
    d, absolute = both(system, seed)
    _, _, qdd = d.coordinates
    scale = max(1.0, *(abs(a) for a in qdd.values()))
    for name, acceleration in qdd.items():
        assert close(acceleration, absolute.acceleration_of(name), scale), name


@pytest.mark.parametrize(("system", "seed"), each_with_seeds(CLOSED))
def test_velocities_fulfil_the_absolute_constraints_of_the_cuts(system, seed):
    _, absolute = both(system, seed)
    opening = absolute.jacobian[absolute.cut_rows :] @ absolute.velocities
    assert np.abs(opening).max() < 1e-12


@pytest.mark.parametrize(("system", "seed"), each_with_seeds(CLOSED))
def test_multipliers_are_the_forces_in_the_cuts(system, seed):
    d, absolute = both(system, seed)
    scale = max(1.0, np.abs(absolute.multipliers).max())
    checked = 0
    frames = {c.name: c.frame for c in d.equations.channels}
    for cut in d.system.cuts:
        for kind in ("force", "torque"):
            world = np.array([absolute.multiplier_of((cut.name, f"{kind}{k}")) for k in range(3)])
            for k, axis in enumerate("xyz"):
                channel = f"{cut.name}.{kind}_{axis}"
                if channel in d.output:
                    turn = absolute.frames[absolute.of_body[frames[channel]]].turn
                    assert close(d.output[channel], (turn.T @ world)[k], scale), channel
                    checked += 1
        if f"{cut.name}.axial_force" in d.output:
            tension = -absolute.multiplier_of((cut.name, "axial"))
            assert close(d.output[f"{cut.name}.axial_force"], tension, scale)
            checked += 1
    redundant = len(d.equations.structure["redundant"])
    assert checked == len(absolute.rows) - absolute.cut_rows - redundant
    assert redundant == (1 if system is planar_loop else 0)


@pytest.mark.parametrize(("system", "seed"), each_with_seeds([tree, CLOSED[0]]))
def test_drive_forces(system, seed):
    d, absolute = both(system, seed)
    driven = [j.name for j in d.system.joints() if j.role == "driven"]
    assert driven
    for name in driven:
        expected = absolute.multiplier_of(("drive", name))
        assert close(d.output[f"{name}_force"], expected, max(1.0, abs(expected)))


@pytest.mark.parametrize("seed", SEEDS)
def test_joint_reactions_of_a_tree(seed):
    """What a joint transmits by the recursion is the reaction of the absolute formulation."""
    d, absolute = both(tree, seed)
    q, qd, qdd = d.coordinates
    wrenches, forces, _ = parts_at(d)
    symbols = [{n: ops.symbol(f"{n}{k}") for n in q} for k in range(3)]
    links = unfold(d.system.bodies)
    loads = [Wrench(body, ops.vector(*f), ops.vector(*t)) for body, f, t in wrenches]
    _, carried = inverse_dynamics(Kinematics(links, *symbols), loads, ops.vector(*d.system.gravity))
    columns = [ops.column(list(s.values())) for s in symbols]
    numbers = [list(x.values()) for x in (q, qd, qdd)]
    for body in d.system.bodies:
        wrench = carried[links.body_link[body.name]]
        six = ops.column([v[k] for v in (wrench.force, wrench.torque) for k in range(3)])
        found = ops.numeric([*columns, d.equations.parameter], six)(*numbers, d.parameters)[:, 0]
        frame = absolute.frames[absolute.of_body[body.name]]
        turn = frame.turn
        if body.spins_about is not None:
            turn = turn @ spin(body, q).T
        reaction = absolute.reaction_on(body.name)
        # The reaction rows do not hold what a motor passes along the joint.
        motor = own_joint_force(absolute, body, forces)
        expected = np.r_[turn.T @ (reaction[:3] + motor[0]), turn.T @ (reaction[3:] + motor[1])]
        assert close(found, expected, max(1.0, np.abs(expected).max())), body.name


def spin(body, q):
    return rotation(body.spins_about, q[body.joints[-1].name])


def own_joint_force(absolute, body, forces):
    """Force and torque that a part passes along the last joint of a body, world axes."""
    force, torque = np.zeros(3), np.zeros(3)
    for name, size in forces.items():
        e, _, above, is_rotation = absolute.axis[name]
        if above == absolute.of_body[body.name]:
            force, torque = (force, size * e) if is_rotation else (size * e, torque)
    return force, torque


def free_body(seed):
    b = Builder(seed)
    b.add("body", "ground", ("T1", "T2", "T3", "R3", "R2", "R1"))
    return b.system("free")


def test_the_second_formulation_falls_freely():
    """A single body with no joint forces: the centre of mass falls, the spin keeps L."""
    _, absolute = both(free_body, 3)
    f = absolute.frames[absolute.of_body["body"]]
    a, alpha = absolute.accelerations[-1][:3], absolute.accelerations[-1][3:]
    c, i = f.turn @ f.com, f.turn @ f.inertia @ f.turn.T
    centre = a + np.cross(alpha, c) + np.cross(f.w, np.cross(f.w, c))
    assert centre == pytest.approx(absolute.gravity, rel=1e-12, abs=1e-12)
    assert i @ alpha + np.cross(f.w, i @ f.w) == pytest.approx(np.zeros(3), abs=1e-12)
