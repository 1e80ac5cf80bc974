"""Systems with deformable bodies obey Lagrange's equations, in any state; no integration."""

import casadi as ca
import numpy as np
import pytest

from vehicledyn.multibody import (
    GROUND,
    Body,
    Joint,
    ParameterTable,
    System,
    Turn,
    derive,
)
from vehicledyn.multibody.bodies.modal_beam import ModalBeam
from vehicledyn.multibody.elements.flexible.beam import Beam, Modes, Stiffness
from vehicledyn.symbolic import rotations
from vehicledyn.symbolic.shared import count_operations

STIFFNESS = Stiffness(mass_per_length=2.0, y=50.0, z=30.0, twist=20.0, stretch=5e3, polar=0.1)
THICK = Stiffness(
    mass_per_length=2.0, y=50.0, z=30.0, twist=20.0, stretch=5e3, shear_y=3e3, shear_z=2e3,
    polar=0.1, rotary_y=0.03, rotary_z=0.02,
)  # fmt: skip
ALL = {"stiffness": THICK, "modes": Modes(y=2, z=1, twist=1, stretch=1, shear_y=1, shear_z=1)}
SETTINGS = {
    "modes": {
        "model": "modes", "stiffness": STIFFNESS, "modes": Modes(y=2, z=2, twist=1, stretch=1),
    },
    "exact": {"model": "exact", **ALL},
    "curved": {"model": "exact", "curvature": (0.3, -0.4, 0.8), **ALL},
}  # fmt: skip
BRIEF = ["modes", "exact", pytest.param("curved", marks=pytest.mark.long)]
SIZE = {"modes": 0.05, "exact": 0.3, "curved": 0.3}
"""Amplitudes to look at: of small deflections, of large ones."""


def rider(name, parent, joints, **more):
    chain = tuple(Joint(kind, f"{name}.{kind}") for kind in joints)
    return Body(
        name, parent, (0.1, -0.2, 0.3), chain, mass=0.7, com=(0.2, 0.1, -0.1),
        inertia=(0.02, 0.03, 0.04, 0.001, 0.002, 0.003), **more,
    )  # fmt: skip


def branched(*more, model="modes"):
    """A beam on a moving hub, bodies at its frames and at a point, a beam at its end."""
    tilted = Turn(rotations.turn(2, 0.4))
    bodies = (
        rider("hub", GROUND, ("T1", "R3", "R1")),
        rider("first", "beam.frame_1", ("R2", "T3")),
        rider("second", "beam", ("R1",), place=0.7),
        Body("bend", "beam.tip", joints=(tilted, Joint("R3", "bend.turn"))),
    )
    parts = (
        Beam("beam", body="hub", at=(0.1, 0.2, 0.3), direction=(0.6, 0.8, 0.0), length=1.5,
             frames=(0.4,), **SETTINGS[model]),
        Beam("end", body="bend", length=0.8, stiffness=THICK, model=SETTINGS[model]["model"],
             modes=Modes(y=2, stretch=1)),
        *more,
    )  # fmt: skip
    gravity = (0.3, -0.2, -9.81)
    return System("branched", ParameterTable(), bodies, parts=parts, gravity=gravity)


def at_random(equations, seed, model):
    rng = np.random.default_rng(seed)
    count = len(equations.states) // 2
    place = 0.5 * rng.normal(size=count)
    for k, state in enumerate(equations.states[:count]):
        if "beam." in state.name or "end." in state.name:
            place[k] *= SIZE[model]
    return place, rng.normal(size=count)


@pytest.mark.parametrize("model", BRIEF)
def test_lagrange(model):
    """d/dt ∂T/∂q̇ - ∂T/∂q + ∂V/∂q is the elastic force on deformations and zero on joints."""
    e = derive(branched(model=model))
    n = len(e.states) // 2
    q, u = e.state[:n], e.state[n:]
    channel = {c.name: k for k, c in enumerate(e.channels)}
    kinetic, height = (e.output[channel[f"energy.{word}"]] for word in ("kinetic", "gravity"))
    power = ca.gradient(e.output[channel["power.forces"]], u)
    momentum = ca.gradient(kinetic, u)
    rate = ca.jtimes(momentum, e.state, e.rate)
    needed = rate - ca.gradient(kinetic - height, q)
    elastic = ca.substitute(power, u, ca.SX.zeros(n, 1))
    f = ca.Function("f", [e.state], [needed - elastic, needed])
    left, size = f(np.concatenate(at_random(e, 1, model)))
    assert np.abs(np.array(left)).max() < 1e-11 * np.abs(np.array(size)).max()


@pytest.mark.long
@pytest.mark.parametrize("basis", ["polynomials", "sines"])
def test_slopes_in_place_of_amplitudes_and_points_give_the_same(monkeypatch, basis):
    """With integrals, in the slopes or in the amplitudes themselves, and with points of mass."""
    joints = (Joint("R3", "turn"), Joint("T1", "slide"))
    root = Body("hub", GROUND, joints=joints, mass=1.0, inertia=(0.1, 0.1, 0.1))
    beam = Beam(
        "beam", body="hub", length=1.5, stiffness=STIFFNESS, modes=Modes(y=2, z=1, stretch=1),
        basis=basis,
    )  # fmt: skip
    hung = rider("rider", "beam.tip", ("R2",))
    made = System("beam", ParameterTable(), (root, hung), parts=(beam,))
    found = []
    for change in ({}, {"recast": None}, {"recast": None, "products": None}):
        with monkeypatch.context() as patch:
            for name, value in change.items():
                patch.setattr(ModalBeam, name, value)
            e = derive(made)
        x = 0.2 * np.concatenate(at_random(e, 2, "modes"))
        found.append(np.array(ca.Function("f", [e.state], [e.rate])(x))[:, 0])
    for other in found[1:]:
        assert other == pytest.approx(found[0], rel=1e-9, abs=1e-9 * np.abs(found[0]).max())


@pytest.mark.long
def test_operations_grow_with_the_square_of_the_modes():
    counts = []
    for n in (5, 10):
        beam = Beam("beam", body="hub", length=1.5, stiffness=STIFFNESS, modes=Modes(y=n))
        root = Body("hub", GROUND, joints=(Joint("R3", "turn"),), inertia=(0.1, 0.1, 0.1))
        e = derive(System("beam", ParameterTable(), (root,), parts=(beam,)))
        counts.append(count_operations(e.rate))
    assert np.log2(counts[1] / counts[0]) < 2.0


@pytest.mark.parametrize("model", BRIEF)
def test_a_frame_moves_as_its_velocity_says(model):
    """Positions and rotations of frames differentiated are their velocities and accelerations."""
    from vehicledyn.multibody.elements.motion_sensors import SequenceSensor
    from vehicledyn.multibody.elements.point_sensors import PointSensor, RateSensor

    sensors = (
        PointSensor("place", body="second", point=(0.3, 0.2, 0.1)),
        RateSensor("rate", body="second"),
        SequenceSensor("angles", body="second"),
    )
    e = derive(branched(*sensors, model=model))
    channel = {c.name: k for k, c in enumerate(e.channels)}
    x = np.concatenate(at_random(e, 3, model))
    out = ca.Function("out", [e.state], [e.output, ca.jtimes(e.output, e.state, e.rate)])
    value, slope = (np.array(item)[:, 0] for item in out(x))
    for axis in "xyz":
        speed = value[channel[f"place.velocity_{axis}"]]
        assert slope[channel[f"place.{axis}"]] == pytest.approx(speed, abs=1e-11)
        lift = value[channel[f"place.acceleration_{axis}"]]
        assert slope[channel[f"place.velocity_{axis}"]] == pytest.approx(lift, abs=1e-9)
        spin = value[channel[f"rate.angular_acceleration_{axis}"]]
        assert slope[channel[f"rate.angular_velocity_{axis}"]] == pytest.approx(spin, abs=1e-9)
    roll, pitch = (value[channel[f"angles.{word}"]] for word in ("roll", "pitch"))
    yaw_rate, pitch_rate, roll_rate = (
        slope[channel[f"angles.{word}"]] for word in ("yaw", "pitch", "roll")
    )
    omega = [
        roll_rate - yaw_rate * np.sin(pitch),
        pitch_rate * np.cos(roll) + yaw_rate * np.sin(roll) * np.cos(pitch),
        -pitch_rate * np.sin(roll) + yaw_rate * np.cos(roll) * np.cos(pitch),
    ]
    for axis, rate in zip("xyz", omega, strict=True):
        assert value[channel[f"rate.angular_velocity_{axis}"]] == pytest.approx(rate, abs=1e-11)


@pytest.mark.parametrize("model", BRIEF)
def test_pictures_show_points_where_they_are(model):
    """The numeric poses of an animation are those of the symbolic kinematics."""
    from vehicledyn.multibody.elements.point_sensors import PointSensor
    from vehicledyn.multibody.equations.system_shapes import appearance
    from vehicledyn.multibody.recursion.numeric_kinematics import skeleton_from

    made = branched(*(PointSensor(b, body=b) for b in ("second", "end.tip")), model=model)
    e = derive(made)
    x = np.concatenate(at_random(e, 4, model))
    out = np.array(ca.Function("out", [e.state], [e.output])(x))[:, 0]
    seen = {c.name: value for c, value in zip(e.channels, out, strict=True)}
    poses = skeleton_from(appearance(made, [])).poses({n: np.array([v]) for n, v in seen.items()})
    place = {body.name: k for k, body in enumerate(b for b in made.bodies if not b.is_abstract)}
    for body in ("second", "end.tip"):
        at = [seen[f"{body}.{axis}"] for axis in "xyz"]
        assert poses.position[0, place[body]] == pytest.approx(at, abs=1e-12)
