"""Impacts balance momentum and keep all constraints, on random trees and closed systems."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from evaluation import Derived
from random_systems import CLOSED, tree
from test_reactions import constrained_tree

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.elements.triggers import Trigger
from vehicledyn.multibody.equations.derivation import solve_motion
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import Situation
from vehicledyn.multibody.recursion.mass_matrix import mass_matrix
from vehicledyn.symbolic import ops

IDENTITY = 1e-10
SYSTEMS = [tree, constrained_tree, *CLOSED]
RESTITUTION = 0.35


def gap(situation):
    """A curved gap between a body and the ground that moves in time."""
    body = next(b for b in ("right_end", "five", "hub_a", "rocker", "fourth")
                if b in situation.kinematics.tree.body_link)  # fmt: skip
    place = situation.kinematics.position(body, (0.1, 0.2, -0.1))
    return place[2] + 0.3 * place[0] * place[0] + 0.4 * place[1] - 0.2 * situation.time


def pushed(system):
    """A coordinate of the system whose rate an event resets."""
    names = [j.name for j in system.joints() if j.role != "driven"]
    return names[-2]


class Jump:
    """The rates of all coordinates before and after the only event of a system."""

    def __init__(self, make, seed, *, restitution=True, reset=False):
        system = make(seed)
        rates = ((pushed(system), lambda s: ops.scalar(0.7)),) if reset else ()
        rebound = (lambda s: RESTITUTION) if restitution else None
        trigger = Trigger("hit", gap, restitution=rebound, rates=rates)
        self.d = d = Derived(system.with_parts(trigger), seed)
        e = d.equations
        after = d.value(e.reset)[:, 0]
        time, state, unknowns, parameters = d.point
        new = state.copy()
        for index, row in e.events[0].resets:
            new[index] = after[row]
        self.before = self._rates(d.point)
        self.after = self._rates((time, new, unknowns, parameters))
        self.gap_rate = [self._gap_rate(s) for s in (state, new)]

    def _rates(self, point):
        outputs = self.d._output(*point)[:, 0]
        named = dict(zip(self.d.names, outputs, strict=True))
        return np.array([named[f"{j.name}_rate"] for j in self.d.system.joints()])

    def _gap_rate(self, state):
        d, e = self.d, self.d.equations
        rate = d.derivative(e.event[:1])
        time, _, unknowns, parameters = d.point
        return ops.numeric(d.inputs, rate)(time, state, unknowns, parameters)[0, 0]

    def directions(self, extra):
        """Mass matrix, and Jacobian of the constraints with the directions of the impulses."""
        d = self.d
        solved = solve_motion(d.system)
        system, symbols, gaps = solved.system, solved.symbols, solved.loops.gaps
        kinematics = Kinematics(solved.tree, symbols.coordinates, symbols.rates)
        names = [j.name for j in symbols.joints]
        free = [k for k, j in enumerate(symbols.joints) if j.role != "driven"]
        entries = mass_matrix(kinematics, set(names))
        inputs = [ops.column([symbols.coordinates[n] for n in names]), d.equations.parameter]
        values = d.output
        q = [values[n] for n in names]
        square = ops.column([entries.get((a, b), 0.0) for a in names for b in names])
        n = len(names)
        mass = ops.numeric(inputs, square)(q, d.parameters)[:, 0].reshape(n, n)
        jacobian = np.zeros((0, n))
        if system.cuts or system.constraints:
            jacobian = gaps.jacobian(0.0, np.array(q))
        rows = []
        if "gap" in extra:
            function = gap(Situation(ops.scalar(0.0), {}, {}, kinematics))
            slope = ops.jacobian(function, inputs[0])
            rows.append(ops.numeric(inputs, slope)(q, d.parameters)[0])
        if "rate" in extra:
            rows.append(np.eye(n)[names.index(pushed(system))])
        return mass[np.ix_(free, free)], np.vstack([jacobian, *rows])[:, free], free


@lru_cache(maxsize=32)
def jump(make, seed, restitution, reset):
    return Jump(make, seed, restitution=restitution, reset=reset)


@pytest.mark.parametrize("seed", [0, 3])
@pytest.mark.parametrize("make", SYSTEMS)
@pytest.mark.parametrize(("restitution", "reset"), [(True, False), (False, True)])
def test_momentum_jumps_by_the_impulses_alone(make, seed, restitution, reset):
    """M (v⁺ - v⁻) lies in the range of Jᵀ and Eᵀ; the demand is met; constraints hold."""
    j = jump(make, seed, restitution, reset)
    extra = [*(["gap"] if restitution else []), *(["rate"] if reset else [])]
    mass, directions, free = j.directions(extra)
    momentum = mass @ (j.after - j.before)[free]
    impulses, *_ = np.linalg.lstsq(directions.T, momentum, rcond=1e-12)
    assert directions.T @ impulses == pytest.approx(momentum, abs=IDENTITY * np.abs(momentum).max())
    assert np.abs(momentum).max() > 1e-3
    if restitution:
        assert j.gap_rate[1] == pytest.approx(-RESTITUTION * j.gap_rate[0], rel=IDENTITY)
    if reset:
        names = [joint.name for joint in j.d.system.joints()]
        assert j.after[names.index(pushed(j.d.system))] == pytest.approx(0.7, rel=IDENTITY)
    driven = [k for k in range(len(j.before)) if k not in free]
    assert j.after[driven] == pytest.approx(j.before[driven], abs=1e-14)


def test_an_elastic_impact_keeps_the_energy_of_a_system_without_drives():
    system = CLOSED[3](0)
    still = lambda s: gap(replace(s, time=ops.scalar(0.0)))  # noqa: E731
    trigger = Trigger("hit", still, restitution=lambda s: 1.0)
    d = Derived(system.with_parts(trigger), 0)
    before = d.output["energy.kinetic"]
    state = d.point[1].copy()
    after = d.value(d.equations.reset)[:, 0]
    for index, row in d.equations.events[0].resets:
        state[index] = after[row]
    energy = dict(zip(d.names, d._output(0.0, state, *d.point[2:])[:, 0], strict=True))
    assert state != pytest.approx(d.point[1])
    assert energy["energy.kinetic"] == pytest.approx(before, rel=IDENTITY)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"rates": (("root.q9", lambda s: 1.0),)}, "no coordinate named 'root.q9'"),
        ({"rates": (("driven.q1", lambda s: 1.0),)}, "'driven.q1', which is driven"),
        ({"values": (("nothing", lambda s: 1.0),)}, "no state named 'nothing'"),
        (
            {"function": lambda s: s.kinematics.rate("root.q0"), "restitution": lambda s: 1.0},
            "must be one of coordinates and positions, not of rates",
        ),
    ],
)
def test_impossible_demands_are_refused(change, message):
    trigger = Trigger(**{"name": "hit", "function": gap, **change})
    with pytest.raises(InputError, match=message):
        Derived(tree(0).with_parts(trigger), 0)
