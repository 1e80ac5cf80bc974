"""Forward against inverse dynamics of the PUMA 560 arm and of chains, by every formulation.

Two errors are told. The unbalanced force: what inverse dynamics need for the accelerations
found, less the forces that act, relative to the largest sum of sizes |M||q̈| + |c| + |Q| of any
coordinate. And the acceleration: that found for the forces of known accelerations, relative to
the largest of these; it also has the condition number of the mass matrix in it.
"""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

from vehicledyn.multibody import (
    GROUND,
    BasePart,
    Body,
    Joint,
    Loads,
    ParameterTable,
    System,
    Turn,
    derive,
)
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.tree import unfold
from vehicledyn.multibody.recursion.mass_matrix import mass_matrix
from vehicledyn.multibody.recursion.newton_euler import inverse_dynamics
from vehicledyn.symbolic import ops, rotations

pytestmark = pytest.mark.validation
DATA = Path(__file__).parent / "data" / "puma560.yaml"
LINKS = YAML(typ="safe").load(DATA.read_text(encoding="utf-8"))["links"]
GRAVITY = (0.0, 0.0, -9.81)
FORWARD = 1e-12
ROUNDING = 2e-15
"""A few roundings of the forces, which the condition number enlarges."""


@dataclass(frozen=True)
class Actuators(BasePart):
    """Forces on coordinates that are parameters."""

    forces: dict

    def loads(self, situation):
        return Loads(joint_forces=dict(self.forces))


def with_actuators(bodies):
    table = ParameterTable()
    names = [j.name for body in bodies for j in body.joints if isinstance(j, Joint)]
    forces = {n: table.add(f"force.{n}", 0.0, "N*m", "Force of the actuator") for n in names}
    return System(
        "arm", table, tuple(bodies), parts=(Actuators("actuators", forces),), gravity=GRAVITY
    )


def puma():
    bodies, parent = [], GROUND
    for k, link in enumerate(LINKS):
        angle = 0.5 * np.pi * link["twist"]
        s, c = ops.sin(angle), ops.cos(angle)
        at = (link["length"], -link["offset"] * s, link["offset"] * c)
        joints = (Turn(rotations.turn(1, angle)), Joint("R3", f"joint_{k + 1}"))
        six = {"mass": link["mass"] or 1e-3, "com": link["com"], "inertia": link["inertia"]}
        six["apparent_inertia"] = True  # as identified
        bodies.append(Body(f"link_{k + 1}", parent, at, joints, **six))
        parent = f"link_{k + 1}"
    return with_actuators(bodies)


def chain(count):
    """Uniform bars that turn about all three axes in turn."""
    bodies = []
    for k in range(count):
        joint = Joint(f"R{1 + k % 3}", f"angle_{k}")
        parent = f"bar_{k - 1}" if k else GROUND
        at = (0.02, 0.01, -0.2) if k else (0.0, 0.0, 0.0)
        inertia = (0.0034, 0.0035, 0.0002)
        body = Body(f"bar_{k}", parent, at, (joint,), 1.0, (0.01, 0.005, -0.1), inertia)
        bodies.append(body)
    return with_actuators(bodies)


ARMS = {"puma": puma} | {f"chain of {n}": (lambda n=n: chain(n)) for n in (6, 12, 30, 100)}


@cache
def inverse(name):
    """Forces needed, and the sizes of what they are made of, at any motion."""
    system = ARMS[name]()
    names = [j.name for j in system.joints()]
    symbols = [{n: ops.symbol(f"{n}{k}") for n in names} for k in range(3)]
    k = Kinematics(unfold(system.bodies), *symbols)
    needed, _ = inverse_dynamics(k, [], ops.vector(*GRAVITY))
    inputs = [ops.column(list(s.values())) for s in symbols]
    return names, ops.numeric(inputs, ops.column([needed[n] for n in names]))


@cache
def masses(name):
    system = ARMS[name]()
    names = [j.name for j in system.joints()]
    symbols = [{n: ops.symbol(f"{n}{k}") for n in names} for k in range(2)]
    entries = mass_matrix(Kinematics(unfold(system.bodies), *symbols), set(names))
    column = ops.column([entries.get((a, b), 0.0) for a in names for b in names])
    found = ops.numeric([ops.column(list(symbols[0].values()))], column)
    return lambda q: found(q)[:, 0].reshape(len(names), len(names))


@cache
def forward(name, formulation):
    system = ARMS[name]()
    e = derive(system, formulation=formulation)
    rates = ops.numeric([e.time, e.state, e.parameter], e.rate)
    n = len(system.joints())
    return lambda q, qd, forces: rates(0.0, [*q, *qd], forces)[n:, 0]


CASES = [
    (name, way)
    for name in ARMS
    for way in ("composite", "articulated", "auto")
    # The mass matrix of a hundred joints has ten thousand entries, each a long expression.
    if not (name == "chain of 100" and way == "composite")
]


@pytest.mark.parametrize(("name", "way"), CASES)
def test_forward_dynamics_undo_inverse_dynamics(name, way):
    names, needed = inverse(name)
    count = len(names)
    rng = np.random.default_rng(count)
    for _ in range(10):
        q, qd = rng.uniform(-np.pi, np.pi, size=count), rng.uniform(-1.0, 1.0, size=count)
        forces = rng.uniform(-1.0, 1.0, size=count)
        accelerations = forward(name, way)(q, qd, forces)
        left = needed(q, qd, accelerations)[:, 0] - forces
        sizes = np.abs(masses(name)(q)) @ np.abs(accelerations) + np.abs(forces)
        sizes += np.abs(needed(q, qd, np.zeros(count))[:, 0])
        assert np.abs(left).max() < FORWARD * sizes.max()
        wanted = rng.uniform(-1.0, 1.0, size=count)
        found = forward(name, way)(q, qd, needed(q, qd, wanted)[:, 0])
        condition = np.linalg.cond(masses(name)(q))
        assert np.abs(found - wanted).max() < ROUNDING * condition * np.abs(wanted).max()
