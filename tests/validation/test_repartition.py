"""Runs in which the first choice of dependent coordinates becomes bad, against ones it suits."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from test_partitions import Motion, dop853, rk4

from vehicledyn.multibody import GROUND, BallCut, Body, BodyCut, Joint, ParameterTable, System

pytestmark = pytest.mark.validation

EXACT = 1e-9
BAR = {"mass": 1.0, "inertia": (0.02, 0.02, 0.02)}
PLANE = (0.0, -9.81, 0.0)


def bar(name, parent, at, angle, length, rate=0.0, role="auto"):
    joint = Joint("R3", f"{name}.angle", angle, role, rate)
    return Body(name, parent, (*at, 0.0), (joint,), com=(0.5 * length, 0.0, 0.0), **BAR)


def drift(motion):
    """Largest change of the energy, as a part of the largest kinetic energy."""
    c = motion.channel
    energy = c["energy.kinetic"] + c["energy.gravity"]
    return np.abs(energy - energy[0]).max() / c["energy.kinetic"].max()


def closed(motion):
    gap = motion.channel["constraints.position_error"].max()
    opening = motion.channel["constraints.velocity_error"].max()
    return gap < 1e-11 and opening < EXACT


def even_slider_crank(role):
    """Crank and rod of equal length: at a quarter turn the slider may stay where it is."""
    length, angle = 0.5, 0.6
    crank = bar("crank", GROUND, (0.0, 0.0), angle, length, 5.0, role)
    rod = bar("rod", "crank", (length, 0.0), -2.0 * angle, length)
    joint = Joint("T1", "slider.x", 2.0 * length * np.cos(angle))
    slider = Body("slider", GROUND, joints=(joint,), mass=1.3)
    cut = BallCut("pin", "rod", (length, 0.0, 0.0), "slider", (0.0, 0.0, 0.0))
    bodies = (crank, rod, slider)
    return System("even", ParameterTable(), bodies, (cut,), gravity=(0.0, 0.0, 0.0))


@pytest.mark.parametrize("solver", [partial(rk4, 2.5e-4), partial(dop853, 1e-11)])
def test_a_slider_crank_of_equal_lengths_passes_its_singular_configuration(solver):
    """It goes on as the ellipsograph that it has been: x = 2 l cos φ, rod and crank mirrored."""
    motion = Motion(even_slider_crank("independent"), solver(), 2.0, 0.01)
    angle, rod = motion.channel["crank.angle"], motion.channel["rod.angle"]
    assert np.ptp(angle) > 2.0 * np.pi
    assert rod == pytest.approx(-2.0 * angle, abs=EXACT)
    assert motion.channel["slider.x"] == pytest.approx(np.cos(angle), abs=EXACT)
    assert drift(motion) < EXACT
    assert closed(motion)


def five_bar():
    """A planar five-bar of two freedoms whose cranks turn far."""
    left = bar("left", GROUND, (0.0, 0.0), 2.2, 0.5, 3.0)
    right = bar("right", GROUND, (1.0, 0.0), 0.8, 0.5, -4.0)
    tips = [np.array([0.5 * np.cos(2.2), 0.5 * np.sin(2.2)])]
    tips.append(np.array([1.0 + 0.5 * np.cos(0.8), 0.5 * np.sin(0.8)]))
    gap = tips[1] - tips[0]
    lean = np.arccos(0.5 * np.linalg.norm(gap) / 1.1)
    along = np.arctan2(gap[1], gap[0])
    upper_left = bar("upper_left", "left", (0.5, 0.0), along + lean - 2.2, 1.1)
    upper_right = bar("upper_right", "right", (0.5, 0.0), along + np.pi - lean - 0.8, 1.1)
    bodies = (left, right, upper_left, upper_right)
    cut = BallCut("top", "upper_left", (1.1, 0.0, 0.0), "upper_right", (1.1, 0.0, 0.0))
    return System("five-bar", ParameterTable(), bodies, (cut,), gravity=PLANE)


def ring():
    """A heavy ring of spatial joints between ground and ground that swings far."""
    names = ("one", "two", "three")
    bodies, parent = [], GROUND
    for k, name in enumerate(names):
        kinds = (("R1", "R2", "R3"), ("R1",), ("R2", "R3", "R1"))[k]
        joints = tuple(
            Joint(kind, f"{name}.q{j}", 0.25 * (1 + j) * (-1) ** k) for j, kind in enumerate(kinds)
        )
        at = (0.0, 0.0, 0.0) if k == 0 else (0.1, 0.4, -0.1)
        bodies.append(Body(name, parent, at, joints, com=(0.1, 0.2, 0.0), **BAR))
        parent = name
    cut = BallCut("end", "three", (0.1, 0.3, 0.0), GROUND, (0.35, 0.75, -0.2))
    return System("ring", ParameterTable(), tuple(bodies), (cut,), gravity=(0.0, 0.0, -9.81))


def double_loop():
    """Two four-bars one on the other, the second on the coupler of the first."""
    crank = bar("crank", GROUND, (0.0, 0.0), 1.2, 0.3, 9.0, "independent")
    coupler = bar("coupler", "crank", (0.3, 0.0), -0.9, 0.9)
    rocker = bar("rocker", GROUND, (0.8, 0.0), 1.3, 0.7)
    lever = bar("lever", "coupler", (0.5, 0.1), 0.9, 0.5)
    stay = bar("stay", GROUND, (-0.3, 0.7), 0.3, 1.2)
    cuts = (
        BallCut("first", "coupler", (0.9, 0.0, 0.0), "rocker", (0.7, 0.0, 0.0)),
        BallCut("second", "lever", (0.5, 0.0, 0.0), "stay", (1.2, 0.0, 0.0)),
    )
    bodies = (crank, coupler, rocker, lever, stay)
    return System("double loop", ParameterTable(), bodies, cuts, gravity=PLANE)


def welded():
    """The same with the second loop welded shut: beside its hinge it stays in the plane."""
    system = double_loop()
    tip = Body("tip", "stay", (1.2, 0.0, 0.0), (Joint("R3", "tip.angle", 0.9),))
    weld = BodyCut("second", "lever", (0.5, 0.0, 0.0), "tip", (0.0, 0.0, 0.0))
    return replace(system, bodies=(*system.bodies, tip), cuts=(system.cuts[0], weld))


MECHANISMS = {"five-bar": five_bar, "ring": ring, "double loop": double_loop, "welded": welded}


@pytest.mark.parametrize("name", MECHANISMS)
def test_energy_and_constraints_through_changes_of_partition(name):
    motion = Motion(MECHANISMS[name](), dop853(1e-12), 1.5, 0.01)
    if name != "five-bar":
        assert len(motion.changes) >= 2
    assert drift(motion) < EXACT
    assert closed(motion)


def test_a_weld_of_a_hinged_loop_is_that_loop():
    """The two descriptions of the same mechanism move alike through their own partitions.

    At 1.41 s lever and stay of the welded one come into one line within an output interval.
    """
    settings = dop853(1e-12), 1.5, 0.01
    hinged, held = (Motion(make(), *settings) for make in (double_loop, welded))
    for name in ("crank.angle", "rocker.angle", "lever.angle", "stay.angle"):
        assert held.channel[name] == pytest.approx(hinged.channel[name], abs=EXACT), name


@pytest.mark.parametrize("solver", [partial(rk4, 2.5e-4), partial(dop853, 1e-11)])
def test_the_coordinate_that_has_changed_its_role_is_named(solver, caplog):
    with caplog.at_level(
        "INFO", logger="vehicledyn.analyses.simulation.partitions.partition_changes"
    ):
        motion = Motion(double_loop(), solver(), 1.2, 0.01)
    told = [r.getMessage() for r in caplog.records if "no longer dependent" in r.getMessage()]
    changes = [name for name, _ in motion.changes if name == "partition.changed"]
    assert len(told) == len(changes) > 0
    names = [j.name for j in double_loop().joints()]
    assert all(any(f"'{name}'" in line for name in names) for line in told)
