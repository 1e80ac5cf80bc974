"""Inertias that only coordinates feel: all formulations, and the geared rotors they stand for."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
import test_identities as identities
import test_motion_residuals as residuals
from evaluation import Derived
from random_systems import body_loop, planar_loop, rod_loops, spatial_loop, tree
from test_formulations import Numbered, bare
from test_segmentation import car, rates, segmented

from vehicledyn.multibody import derive
from vehicledyn.multibody.elements.transmissions import Gears, Rack
from vehicledyn.multibody.model.bodies import Body, Joint
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.recursion import forward_dynamics as forward
from vehicledyn.multibody.recursion.barycentric import augmented_inertias
from vehicledyn.multibody.recursion.mass_matrix import mass_matrix
from vehicledyn.multibody.recursion.newton_euler import inverse_dynamics
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.shared_steps import Steps

pytestmark = pytest.mark.long

RATIO, RADIUS = 3.0, 0.2
"""Of the gears of explicit rotors on turns, and of their pinions on slides."""


def geared_bodies(system, seed):
    """The bodies of a system, two thirds of its joints with an inertia, a parameter each."""
    rng = np.random.default_rng(seed)

    def own(item):
        if not isinstance(item, Joint) or rng.random() > 0.67:
            return item
        size = system.table.add(f"{item.name}.rotor", rng.uniform(0.1, 2.0), "1", "rotor")
        return replace(item, reflected_inertia=size)

    return tuple(replace(body, joints=tuple(map(own, body.joints))) for body in system.bodies)


def geared(make):
    """A random system with reflected inertias."""

    @lru_cache(maxsize=1)
    def made():
        def build(seed):
            system = make(seed)
            return replace(system, bodies=geared_bodies(system, seed))

        build.__name__ = f"geared_{make.__name__}"
        return build

    return made()


GEARED = {make: geared(make) for make in (tree, bare, spatial_loop, body_loop, rod_loops, car)}


def without(item):
    """A joint without reflected inertia."""
    return replace(item, reflected_inertia=0.0) if isinstance(item, Joint) else item


def rotor_of(joint):
    """The body and the gear of a rotor that turns on the ground."""
    name, own = f"{joint.name.replace('.', '_')}_rotor", joint.reflected_inertia
    slides = joint.kind.startswith("T")
    start = joint.start / RADIUS if slides else -RATIO * joint.start
    spin = Joint("R1", f"{name}.spin", start=start, role="dependent")
    moment = own * RADIUS**2 if slides else own / RATIO**2
    body = Body(name, GROUND, joints=(spin,), mass=1.0, inertia=(moment,) * 3 + (0.0,) * 3)
    if slides:
        return body, Rack(f"{name}_gear", sliding=joint.name, turning=spin.name, radius=RADIUS)
    return body, Gears(f"{name}_gear", driven=spin.name, driving=joint.name, ratio=RATIO)


def with_rotors(system):
    """The same system with each reflected inertia as a geared body."""
    pairs = [
        rotor_of(item) for item in system.joints()
        if not ops.is_structurally_zero(item.reflected_inertia)
    ]  # fmt: skip
    plain = (replace(b, joints=tuple(map(without, b.joints))) for b in system.bodies)
    rotors, gears = zip(*pairs, strict=True)
    bodies, constraints = (*plain, *rotors), (*system.constraints, *gears)
    return replace(system, bodies=bodies, constraints=constraints)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("make", [tree, spatial_loop, body_loop, rod_loops])
def test_rotors_on_the_ground_do_the_same(make, seed):
    """Accelerations, kinetic energy, and the forces of drives and in cuts."""
    system = GEARED[make](seed)
    one, two = Derived(system, seed), Derived(with_rotors(system), seed)
    known = dict(zip([s.name for s in one.equations.states], one.point[1], strict=True))
    x = np.array([known[s.name] for s in two.equations.states])
    two.point = (0.0, x, two.closed(0.0, x), two.parameters)
    scale = max(1.0, *map(abs, one.rate.values()))
    for name, rate in one.rate.items():
        assert two.rate[name] == pytest.approx(rate, abs=1e-10 * scale), name
    first, second = one.output, two.output
    assert first["energy.kinetic"] == pytest.approx(second["energy.kinetic"], rel=1e-12)
    compared = [n for n in first if n.endswith("_force") or n.split(".")[0] in ("ball", "section")]
    assert compared or make is rod_loops
    size = max([1.0, *(abs(first[n]) for n in compared)])
    for name in compared:
        assert second[name] == pytest.approx(first[name], abs=1e-9 * size), name


@pytest.mark.parametrize("seed", range(8))
def test_all_mass_matrices_are_the_same(seed):
    """Composite and barycentric inertias, unit accelerations, and the articulated recursions."""
    d = Numbered(GEARED[bare](seed), seed)
    plain_system = Numbered(bare(seed), seed)
    names, n = d.names, len(d.names)
    reflected = d.kinematics.tree.reflected_inertias
    assert 3 < len(reflected) < n

    def matrix(numbers, inertias=None):
        entries = mass_matrix(numbers.kinematics, set(names), inertias)
        column = ops.column([entries.get((a, b), 0.0) for a in names for b in names])
        return numbers.value(column).reshape(n, n)

    mass = matrix(d)
    size = np.abs(mass).max()
    own = d.value(ops.column([reflected.get(name, 0.0) for name in names]))
    assert mass - np.diag(own) == pytest.approx(matrix(plain_system), abs=1e-12 * size)
    tree_ = d.kinematics.tree
    assert matrix(d, augmented_inertias(tree_)) == pytest.approx(mass, abs=1e-12 * size)

    weightless = ops.vector(0.0, 0.0, 0.0)
    forces, _ = inverse_dynamics(d.kinematics, [], weightless, augmented_inertias(tree_))
    needed, given = d.column(forces), d.inputs[2]
    columns = d.value(ops.flat(ops.jacobian(needed, given))).reshape(n, n).T
    assert columns == pytest.approx(mass, abs=1e-12 * size)

    pushes = {name: ops.symbol(f"{name}_push") for name in names}
    rest = d.kinematics.with_accelerations({name: ops.scalar(0.0) for name in names})
    problem = forward.TreeProblem(rest, augmented_inertias(tree_), [], pushes, weightless, names)
    for write in (forward.written_out, Steps()):
        found = forward.by_articulated(problem, write=write)
        yielded = ops.jacobian(d.column(found), d.column(pushes))
        inverse = ops.flat(yielded)
        inputs = [*d.inputs, d.column(pushes)]
        values = ops.numeric(inputs, inverse)(*d.state, d.values, np.zeros(n))[:, 0]
        product = values.reshape(n, n) @ mass
        assert product == pytest.approx(np.eye(n), abs=1e-10)


@pytest.mark.parametrize("seed", range(4))
def test_formulations_give_the_same_accelerations(seed):
    """With loads and drives, and where a free body feels its coordinates."""
    system = GEARED[(tree, bare)[seed % 2]](seed)
    ways = ("composite", "articulated")
    one, two = (rates(derive(system, formulation=way), seed) for way in ways)
    assert two == pytest.approx(one, rel=0.0, abs=1e-10 * max(1.0, np.abs(one).max()))


@pytest.mark.parametrize("seed", range(4))
def test_segments_give_the_same_accelerations(seed, monkeypatch):
    system = GEARED[(car, spatial_loop)[seed % 2]](seed)
    one = rates(derive(system, formulation="composite"), seed)
    two = rates(segmented(monkeypatch, system), seed)
    assert two == pytest.approx(one, rel=0.0, abs=1e-10 * max(1.0, np.abs(one).max()))


@pytest.mark.parametrize("make", [tree, spatial_loop, body_loop])
def test_identities_hold(make):
    """Energy of the mass matrix, power balance, and residuals of the accelerations."""
    own = GEARED[make]
    identities.test_mass_matrix_gives_the_kinetic_energy(own, 3)
    identities.test_power_balance(own, 3)
    residuals.test_nothing_is_missing_at_the_accelerations_of_the_equations(own)


def test_multipliers_give_the_same_accelerations():
    """The loop of a four-bar with its crank, rod and rocker on rotors."""
    own = geared(planar_loop)
    system = own(3)
    one = Derived(system, 3)
    two = Derived(replace(system, constraint_method="multipliers"), 3)
    q, qd, qdd = one.coordinates
    known = q | {f"{name}_rate": rate for name, rate in qd.items()}
    x = np.array([known[s.name] for s in two.equations.states])
    two.point = (0.0, x, np.zeros(0), two.parameters)
    scale = max(1.0, *map(abs, qdd.values()))
    for name, acceleration in qdd.items():
        assert two.rate[f"{name}_rate"] == pytest.approx(acceleration, abs=1e-9 * scale)
