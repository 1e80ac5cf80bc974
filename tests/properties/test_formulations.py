"""Formulations that answer the same question agree: articulated, composite, barycentric, plain."""

import casadi
import numpy as np
import pytest
from random_systems import CHAIN, Builder, spatial_loop, tree

from vehicledyn.base.errors import InputError
from vehicledyn.codegen.passes.kernel_functions import count_operations
from vehicledyn.multibody import derive
from vehicledyn.multibody.model.bodies import Body, Joint, Turn
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.tree import unfold
from vehicledyn.multibody.recursion import forward_dynamics as forward
from vehicledyn.multibody.recursion.axis_alignment import align
from vehicledyn.multibody.recursion.barycentric import augmented_inertias
from vehicledyn.multibody.recursion.mass_matrix import mass_matrix
from vehicledyn.multibody.recursion.newton_euler import inverse_dynamics
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.equations import Equations, Variable
from vehicledyn.symbolic.shared_steps import Steps

pytestmark = pytest.mark.long

WAYS = ("auto", "composite", "articulated")
SEEDS = range(16)


def bare(seed):
    """A random tree of nine bodies, some massless between others, one driven, one a wheel."""
    b = Builder(seed)
    names = [b.add("root", GROUND, [("T1", "T2", "T3", "R3", "R2", "R1"), ("R2",)][seed % 2])]
    for k in range(5):
        kinds = CHAIN[b.rng.integers(len(CHAIN))]
        names.append(b.add(f"body{k}", names[b.rng.integers(len(names))], kinds))
    b.add("frame", names[-1], ("R1", "T3"), massless=True)
    names.append(b.add("last", "frame", ("R2",)))
    b.add("driven", "root", ("R2", "T1"), driven=True)
    b.add_wheel("wheel", names[b.rng.integers(len(names))], 1 + seed % 3)
    return b.system(f"bare {seed}")


def rates(equations, seed):
    """Rates at a random state, the same for all equations of a system."""
    rng = np.random.default_rng(seed)
    x = np.array([v.start for v in equations.states])
    x += rng.uniform(-1.0, 1.0, size=x.size)
    values = [p.value for p in equations.parameters]
    inputs = [equations.time, equations.state, equations.parameter]
    return ops.numeric(inputs, equations.rate)(0.4, x, values)[:, 0]


@pytest.mark.parametrize("seed", SEEDS)
def test_articulated_and_composite_inertias_give_the_same_accelerations(seed):
    system = (tree if seed % 4 == 0 else bare)(seed)
    ways = ("composite", "articulated")
    one, two = (rates(derive(system, formulation=way), seed) for way in ways)
    assert two == pytest.approx(one, rel=0.0, abs=1e-10 * max(1.0, np.abs(one).max()))


@pytest.mark.parametrize("large", [1, 1000])
@pytest.mark.parametrize("seed", range(8))
def test_steps_written_once_give_the_same_accelerations(seed, large, monkeypatch):
    """Of any joints on any base, whether alike or not, and with their numbers given or not."""
    system = (tree if seed % 4 == 0 else bare)(seed)
    one = rates(derive(system, formulation="composite"), seed)
    monkeypatch.setattr(forward, "_MANY", 1)
    monkeypatch.setattr(forward, "_LARGE", large)
    monkeypatch.setattr(Steps, "are_alike", True)
    equations = derive(system, formulation="articulated")
    function = casadi.Function(
        "rates", [casadi.vertcat(*casadi.symvar(equations.rate))], [equations.rate]
    )
    assert sum("_outward" in name for name in function.get_function()) > 2
    two = rates(equations, seed)
    assert two == pytest.approx(one, rel=0.0, abs=1e-10 * max(1.0, np.abs(one).max()))


@pytest.mark.parametrize("seed", SEEDS)
def test_barycentric_parameters_give_the_same_forces_and_mass_matrix(seed):
    """To 1e-12 those of the bodies' own masses, driven joints and spinning wheels included."""
    d = Numbered(bare(seed), seed)
    gravity = ops.vector(*d.system.gravity)
    augmented = augmented_inertias(d.kinematics.tree)
    for compute in (
        lambda own: d.column(inverse_dynamics(d.kinematics, [], gravity, own)[0]),
        lambda own: ops.column([*mass_matrix(d.kinematics, set(d.names), own).values()]),
    ):
        plain, less = d.value(compute(None)), d.value(compute(augmented))
        assert less == pytest.approx(plain, rel=0.0, abs=1e-12 * np.abs(plain).max())


def test_barycentric_parameters_spare_operations():
    """What is left for every step of a run after parameters alone are computed apart."""
    b = Builder(1)
    for k in range(8):
        b.add(f"body{k}", f"body{k - 1}" if k else GROUND, (f"R{1 + k % 3}",), turns=False)
    d = Numbered(b.system("chain"), 1)
    gravity = ops.vector(*d.system.gravity)
    augmented = augmented_inertias(d.kinematics.tree)
    forces, masses = (
        [
            d.operations(d.column(inverse_dynamics(d.kinematics, [], gravity, own)[0])),
            d.operations(ops.column([*mass_matrix(d.kinematics, set(d.names), own).values()])),
        ]
        for own in (None, augmented)
    )
    assert forces[1] < 0.95 * forces[0]
    assert masses[1] < masses[0]


class Numbered:
    """Kinematics of a tree with symbols for positions, rates and accelerations, and numbers."""

    def __init__(self, system, seed):
        self.system = system
        self.names = [j.name for j in system.joints()]
        symbols = [{n: ops.symbol(f"{n}{k}") for n in self.names} for k in range(3)]
        self.kinematics = Kinematics(unfold(system.bodies), *symbols)
        self.parameters = [e.symbol for e in system.table.entries]
        self.inputs = [*(self.column(s) for s in symbols), ops.column(self.parameters)]
        rng = np.random.default_rng(seed)
        self.state = [rng.uniform(-1.0, 1.0, size=len(self.names)) for _ in symbols]
        self.values = [e.value for e in system.table.entries]

    def column(self, by_name):
        return ops.column([by_name[n] for n in self.names])

    def value(self, expression):
        return ops.numeric(self.inputs, expression)(*self.state, self.values)[:, 0]

    def operations(self, expression):
        """Operations of an expression that are left when its parameters are prepared."""
        states = [s for column in self.inputs[:3] for s in casadi.vertsplit(column)]
        variables = tuple(Variable(f"x{k}", "1", "x") for k in range(len(states)))
        none = ops.column([])
        equations = Equations(
            "forces", ops.symbol("t"), ops.column(states), none, self.inputs[3],
            rate=expression, residual=none, output=none, event=none,
            states=variables, unknowns=(), parameters=(), channels=(),
        )  # fmt: skip
        return count_operations(equations)["rates"]


def test_the_articulated_recursion_refuses_loops():
    with pytest.raises(InputError, match="'spatial loop 0' has cuts or constraints"):
        derive(spatial_loop(0), formulation="articulated")


@pytest.mark.parametrize("way", ["composite", "articulated"])
def test_the_cheaper_formulation_is_chosen(way):
    """A few joints are cheaper with composite inertias, many in a row with articulated ones."""
    b = Builder(1)
    for k in range({"composite": 4, "articulated": 14}[way]):
        b.add(f"body{k}", f"body{k - 1}" if k else GROUND, (f"R{1 + k % 3}",), turns=False)
    system = b.system(way)
    counts = {f: count_operations(derive(system, formulation=f))["rates"] for f in WAYS}
    assert min(WAYS[1:], key=counts.get) == way
    assert counts["auto"] == counts[way]


def test_long_chains_grow_linearly():
    """Operations a joint of a chain too long for its mass matrix to be built at all."""
    counts = []
    for n in (20, 40):
        b = Builder(2)
        for k in range(n):
            b.add(f"body{k}", f"body{k - 1}" if k else GROUND, ("R2",), turns=False)
        counts.append(count_operations(derive(b.system("chain")))["rates"] / n)
    assert counts[1] < 1.06 * counts[0]


def oblique_chain(n, seed=4):
    """A chain of turning joints about all axes with an oblique turn before each."""
    b = Builder(seed)
    for k in range(n):
        name, parent = f"body{k}", f"body{k - 1}" if k else GROUND
        joint = Joint(f"R{1 + (k * k) % 3}", f"{name}.q", start=b.rng.uniform(-0.6, 0.6))
        b.bodies.append(Body(name, parent, b.at(name), (b.turn(), joint), **b.rigid(name)))
    return b.system("oblique")


def test_aligned_axes_leave_two_turns_a_joint():
    """Every fixed turn but the one on the ground becomes a turn about one axis."""
    system = oblique_chain(9)
    aligned = align(unfold(system.bodies), system.table)
    axes = [rotations.elementary_axis(item.before) for item in aligned.tree.links[1:]]
    assert None not in axes
    ways = ("composite", "articulated")
    one, two = (rates(derive(system, formulation=way), 2) for way in ways)
    assert two == pytest.approx(one, rel=0.0, abs=1e-11 * np.abs(one).max())


def test_parallel_joints_are_not_aligned():
    """Two parallel joints have no common normal; their axes stay as given."""
    b = Builder(3)
    half = Turn(rotations.turn(3, b.table.add("angle", 0.4, "rad", "Angle between bodies")))
    tilt = Turn(rotations.turn(1, b.table.add("tilt", 0.0, "rad", "Angle between joints")))
    for name, parent in (("one", GROUND), ("two", "one")):
        turns = (half, tilt, half)
        joints = (*turns, Joint("R3", f"{name}.q"))
        b.bodies.append(Body(name, parent, b.at(name), joints, **b.rigid(name)))
    system = b.system("parallel")
    assert not align(unfold(system.bodies), system.table).turns
