"""Accelerations of a body that moves freely, from its own equations and from all coordinates."""

import numpy as np
import pytest

from vehicledyn.multibody.equations.derivation import solve_motion
from vehicledyn.multibody.model.bodies import Body, Joint
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.model.tree import unfold
from vehicledyn.multibody.recursion.floating_body import floating_base
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.parameters import ParameterTable


def system_of(kinds, parent="ground"):
    base = Body(
        "base",
        parent,
        joints=tuple(Joint(kind, f"base.{kind}_{k}") for k, kind in enumerate(kinds)),
        mass=3.0,
        com=(0.1, -0.2, 0.05),
        inertia=(0.5, 0.6, 0.7, 0.05, -0.03, 0.02),
    )
    arm = Body(
        "arm",
        "base",
        (0.3, 0.1, -0.2),
        (Joint("R2", "arm.first"), Joint("T1", "arm.second")),
        mass=1.0,
        com=(0.4, 0.0, 0.1),
        inertia=(0.1, 0.2, 0.15),
    )
    return System("floating", ParameterTable(), (base, arm), gravity=(0.3, -0.2, -9.81))


def accelerations(system, formulation, at):
    found = solve_motion(system, formulation)
    names = [joint.name for joint in found.symbols.joints]
    column = ops.column([found.solved.accelerations[name] for name in names])
    inputs = [found.symbols.coordinate_column, found.symbols.rate_column]
    return ops.numeric(inputs, column)(*at)[:, 0]


@pytest.mark.parametrize(
    "kinds",
    [
        ("T1", "T2", "T3", "R3", "R2", "R1"),
        ("T3", "T1", "T2", "R1", "R2", "R3"),
        ("T2", "T3", "T1", "R3", "R1", "R3"),
        ("T1", "T3", "T2", "R2", "R3", "R1"),
    ],
    ids="-".join,
)
def test_free_body_needs_no_recursion(kinds):
    system = system_of(kinds)
    assert floating_base(unfold(system.bodies), lambda link: link < len(kinds)) == len(kinds) - 1
    rng = np.random.default_rng(3)
    for _ in range(4):
        at = rng.uniform(-1.0, 1.0, size=(2, len(system.joints())))
        expected = accelerations(system, "composite", at)
        np.testing.assert_allclose(
            accelerations(system, "articulated", at), expected, rtol=1e-11, atol=1e-11
        )


@pytest.mark.parametrize(
    "kinds",
    [
        ("T1", "T2", "T2", "R3", "R2", "R1"),
        ("T1", "T2", "T3", "R3", "R3", "R1"),
        ("R3", "T1", "T2", "T3", "R2", "R1"),
        ("T1", "T2", "T3", "R3", "R2"),
    ],
    ids="-".join,
)
def test_other_chains_are_no_floating_base(kinds):
    assert floating_base(unfold(system_of(kinds).bodies), lambda link: link < len(kinds)) is None


def test_base_with_a_force_on_its_coordinates_is_left_to_the_recursion():
    system = system_of(("T1", "T2", "T3", "R3", "R2", "R1"))
    assert floating_base(unfold(system.bodies), lambda link: link != 1) is None
