"""Inverse dynamics undo the equations of motion, of trees and of closed systems."""

from functools import lru_cache

import numpy as np
import pytest
from evaluation import Derived
from random_systems import CLOSED, tree

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.equations.inverse_dynamics import derive_inverse
from vehicledyn.symbolic import ops

pytestmark = pytest.mark.long

SEEDS = range(4)


@lru_cache(maxsize=64)
def both(make, seed):
    """A system at a random state, and the channels of its inverse dynamics along that motion."""
    d = Derived(make(seed), seed)
    inverse = derive_inverse(make(seed))
    q, qd, qdd = d.coordinates
    return d, inverse, channels(inverse, d, q, qd, qdd)


def channels(inverse, d, q, qd, qdd, push=0.0):
    e = inverse.equations
    rows = [[by_name[n] for n in inverse.coordinates] for by_name in (q, qd, qdd)]
    state = inverse.state(rows[0], rows[1], np.array(rows[2]) + push)
    states = {v.name: value for v, value in zip(d.equations.states, d.point[1], strict=True)}
    for k, variable in enumerate(e.states):
        state[k] = states.get(variable.name, state[k])
    unknowns = [q[v.name] for v in e.unknowns]
    inputs = [e.time, e.state, e.algebraic, e.parameter]
    values = ops.numeric(inputs, e.output)(d.point[0], state, unknowns, d.parameters)[:, 0]
    gaps = ops.numeric(inputs, e.residual)(d.point[0], state, unknowns, d.parameters)
    assert np.abs(gaps).max(initial=0.0) < 1e-12
    return dict(zip([c.name for c in e.channels], values, strict=True))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("make", [tree, *CLOSED])
def test_a_free_motion_needs_no_forces(make, seed):
    """Along the motion that the equations give, no coordinate lacks a force."""
    d, inverse, found = both(make, seed)
    assert inverse.coordinates == tuple(d.equations.structure["independent"])
    q, qd, qdd = d.coordinates
    pushed = channels(inverse, d, q, qd, qdd, push=1.0)
    free, moved = (np.array([c[n] for n in inverse.force_channels]) for c in (found, pushed))
    size = max(np.abs(moved).max(), *(abs(v) for n, v in found.items() if "force" in n))
    assert np.abs(free).max() < 1e-10 * size
    assert np.abs(moved).max() > 1e-3


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("make", [tree, *CLOSED])
def test_multipliers_drive_forces_and_energies_are_those_of_the_motion(make, seed):
    d, _, found = both(make, seed)
    expected = d.output
    scale = max(1.0, *(abs(v) for n, v in expected.items() if "force" in n or "torque" in n))
    compared = 0
    for name, value in expected.items():
        if name in found and "error" not in name:
            assert found[name] == pytest.approx(value, abs=1e-9 * scale), name
            compared += "force" in name or "torque" in name
    assert compared > 0


def test_the_motion_must_be_determined():
    with pytest.raises(InputError, match=r"has 1 independent coordinate.*motion of 2 is"):
        derive_inverse(CLOSED[3](0), ["crank.angle", "rod.angle"])
    with pytest.raises(InputError, match=r"no coordinate named 'crank.angel'"):
        derive_inverse(CLOSED[3](0), ["crank.angel"])
    inverse = derive_inverse(CLOSED[3](0), ["rocker.angle"])
    assert inverse.force_channels == ("rocker.angle_force",)
    with pytest.raises(InputError, match="1 coordinates are prescribed, 2 values of their rate"):
        inverse.state([0.1], [0.2, 0.3], [0.0])
