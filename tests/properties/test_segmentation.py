"""Sub-systems condensed to the body that carries them against one mass matrix for all."""

import numpy as np
import pytest
from random_systems import CLOSED, Builder, Wind, ball_cut, rod_cut, spatial_loop

from vehicledyn.base.errors import InputError
from vehicledyn.codegen.passes.kernel_functions import count_operations
from vehicledyn.multibody import derive
from vehicledyn.multibody.equations import derivation
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.recursion.substructuring import find_carrier, segmented_accelerations
from vehicledyn.symbolic import ops
from vehicledyn.vehicles.iltis import Iltis

pytestmark = pytest.mark.long

SEEDS = range(4)
AGREE = 1e-10


def car(seed):
    """Three looped sub-systems on a floating base; a rod ties two of them together."""
    b = Builder(seed)
    b.add("base", GROUND, ("T1", "T2", "T3", "R3", "R2", "R1"), role="independent")
    cuts = []
    for side in "abc":
        b.add(f"arm_{side}", "base", ("R1", "R2"))
        b.add(f"hub_{side}", f"arm_{side}", ("R3", "R2"), massless=seed % 2 == 0)
        b.add_wheel(f"wheel_{side}", f"hub_{side}", 2)
        b.add(f"link_{side}", "base", ("R2", "R1"))
        cuts.append(rod_cut(b, f"link_{side}", f"hub_{side}", f"rod_{side}"))
    cuts.append(rod_cut(b, "arm_a", "arm_b", "tie"))
    cuts.append(ball_cut(b, "link_c", "hub_c"))
    return b.system(f"car {seed}", tuple(cuts), (Wind("wind", "hub_b"), Wind("draught", "base")))


def rates(equations, seed):
    rng = np.random.default_rng(seed)
    x = np.array([v.start for v in equations.states])
    x += rng.uniform(-0.05, 0.05, size=x.size)
    z = np.array([v.start for v in equations.unknowns])
    values = [p.value for p in equations.parameters]
    inputs = [equations.time, equations.state, equations.algebraic, equations.parameter]
    return ops.numeric(inputs, equations.rate)(0.2, x, z, values)[:, 0]


def segmented(monkeypatch, system, carrier=None):
    """Equations by segments beyond a body, or beyond the one that carries all loops."""

    def solve(problem, independent, influence, formulation):
        tree = problem.kinematics.tree
        link = find_carrier(tree, influence) if carrier is None else tree.body_link[carrier]
        return segmented_accelerations(problem, link, independent, influence)

    monkeypatch.setattr(derivation, "solve_loops", solve)
    return derive(system)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("make", [car, *CLOSED])
def test_segments_give_the_accelerations_of_the_whole(make, seed, monkeypatch):
    system = make(seed)
    whole = rates(derive(system, formulation="composite"), seed)
    parts = rates(segmented(monkeypatch, system), seed)
    assert parts == pytest.approx(whole, rel=0.0, abs=AGREE * np.abs(whole).max())


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("make", [car, spatial_loop])
def test_any_body_below_the_loops_may_carry(make, seed, monkeypatch):
    """On the ground the whole system is one segment, with the same result."""
    system = make(seed)
    whole = rates(derive(system, formulation="composite"), seed)
    parts = rates(segmented(monkeypatch, system, GROUND), seed)
    assert parts == pytest.approx(whole, rel=0.0, abs=AGREE * np.abs(whole).max())


def test_a_loop_must_be_beyond_its_carrier(monkeypatch):
    with pytest.raises(InputError, match="which is not beyond 'left'; choose another carrier"):
        segmented(monkeypatch, spatial_loop(1), "left")


def iltis():
    parameters = Iltis.parameter_class.model_validate(Iltis.default_parameters())
    return Iltis.build(parameters, Iltis.standard_options()).system


def test_the_corners_of_the_iltis_are_segments():
    """The same accelerations with fewer operations, four sub-systems on the chassis."""
    whole, parts = derive(iltis(), formulation="composite"), derive(iltis())
    expected = rates(whole, 0)
    assert rates(parts, 0) == pytest.approx(expected, rel=0.0, abs=AGREE * np.abs(expected).max())
    counts = [count_operations(e)["rates"] for e in (whole, parts)]
    assert counts[1] < 0.975 * counts[0]
