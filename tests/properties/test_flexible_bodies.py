"""Bodies from finite elements obey the laws of mechanics, in any state; no integration."""

import casadi as ca
import numpy as np
import pytest
from finite_elements import assembled, lattice

from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, derive
from vehicledyn.multibody.bodies.finite_elements.beam_frames import (
    BeamElement,
    Member,
    stiffened,
)
from vehicledyn.multibody.bodies.finite_elements.reading import write_archive
from vehicledyn.multibody.bodies.finite_elements.standard_input_writer import write_standard_input
from vehicledyn.multibody.elements.flexible.flexible_body import FlexibleBody
from vehicledyn.multibody.model.deformation import Integrals

GIVEN = {"axial": 5e3, "torsion": 20.0, "bending": (50.0, 30.0), "mass": 2.0, "polar": 0.1}
PLACES = [(0, 0, 0), (0.5, 0, 0.1), (1, 0.1, 0), (1.5, 0, 0), (1, 0.6, 0)]
MEMBERS = [(0, 1), (1, 2), (2, 3), (2, 4)]
SETTINGS = {
    "mean axes": {"interface": {"root": 1, "tip": 4}},
    "held": {"interface": {"root": 1, "tip": 4}, "reference": "root"},
    "solid": {"interface": {"root": (1, 2, 3, 4), "tip": (17, 18, 19, 20)}},
}
STIFFENED = {
    "stiffened": {"file": "stiff.npz", **SETTINGS["mean axes"], "modes": 2},
    "standard": {"file": "stiff.sid", "interface": {"root": 1, "tip": 2}, "modes": 5},
}
FREE = ("T1", "T2", "T3", "R1", "R2", "R3")


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("models")
    frame = assembled(PLACES, MEMBERS, GIVEN)
    write_archive(frame, folder / "frame.npz")
    write_archive(lattice((5, 2, 2), 0.3, stiffness=3e3), folder / "solid.npz")
    members = [Member(a + 1, b + 1, BeamElement(**GIVEN)) for a, b in MEMBERS]
    for name, held in (("stiff", 0), ("held", 1)):
        made = stiffened(frame, members, held, [1, 4, 5] if not held else [4, 5])
        write_archive(made, folder / f"{name}.npz")
    held = FlexibleBody(
        "frame", body="hub", file=str(folder / "held.npz"), modes=2, nodes={"side": 5},
        **SETTINGS["held"],
    )  # fmt: skip
    write_standard_input(held.component_modes, folder / "stiff.sid")
    return folder


def rider(name, parent, joints, **more):
    chain = tuple(Joint(kind, f"{name}.{kind}") for kind in joints)
    return Body(
        name, parent, (0.1, -0.2, 0.3), chain, mass=0.7, com=(0.2, 0.1, -0.1),
        inertia=(0.02, 0.03, 0.04, 0.001, 0.002, 0.003), **more,
    )  # fmt: skip


def flexible(files, model, **more):
    if model in STIFFENED:
        given = {**STIFFENED[model], "nodes": {"side": 5 if model == "stiffened" else 3}}
        return FlexibleBody("frame", **{**given, "file": str(files / given["file"])}, **more)
    solid = model == "solid"
    file, side = ("solid.npz", 9) if solid else ("frame.npz", 5)
    return FlexibleBody(
        "frame", file=str(files / file), modes=2, nodes={"side": side}, **SETTINGS[model], **more
    )


def carrying(files, model, *more):
    """A structure on a moving hub, with bodies at an interface and at another node."""
    body = flexible(files, model, body="hub", at=(0.1, 0.2, 0.3), direction=(0.6, 0.8, 0.0))
    bodies = (
        rider("hub", GROUND, ("T1", "R3", "R1")),
        rider("first", "frame.tip", ("R2", "T3")),
        rider("second", "frame", ("R1",), place=body.flexibility.place_of("side")),
    )
    gravity = (0.3, -0.2, -9.81)
    return System("carrying", ParameterTable(), bodies, parts=(body, *more), gravity=gravity)


def at_random(equations, seed):
    rng = np.random.default_rng(seed)
    count = len(equations.states) // 2
    return np.concatenate([0.3 * rng.normal(size=count), rng.normal(size=count)])


@pytest.mark.parametrize("model", [*SETTINGS, *STIFFENED])
def test_lagrange(files, model):
    """d/dt ∂T/∂q̇ - ∂T/∂q + ∂V/∂q is the elastic force on deformations and zero on joints."""
    e = derive(carrying(files, model))
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
    left, size = f(at_random(e, 1))
    assert np.abs(np.array(left)).max() < 1e-11 * np.abs(np.array(size)).max()


def test_frames_move_as_pictures_and_velocities_say(files):
    """Positions of frames differentiated are their velocities; pictures show them there."""
    from vehicledyn.multibody.elements.point_sensors import PointSensor, RateSensor
    from vehicledyn.multibody.equations.system_shapes import appearance
    from vehicledyn.multibody.recursion.numeric_kinematics import skeleton_from

    sensors = (PointSensor("second", body="second"), RateSensor("rate", body="second"))
    made = carrying(files, "mean axes", *sensors)
    e = derive(made)
    x = at_random(e, 3)
    out = ca.Function("out", [e.state], [e.output, ca.jtimes(e.output, e.state, e.rate)])
    names = [c.name for c in e.channels]
    value, slope = (dict(zip(names, np.array(item)[:, 0], strict=True)) for item in out(x))
    for axis in "xyz":
        assert slope[f"second.{axis}"] == pytest.approx(value[f"second.velocity_{axis}"], abs=1e-11)
        lift = value[f"second.acceleration_{axis}"]
        assert slope[f"second.velocity_{axis}"] == pytest.approx(lift, abs=1e-9)
        spin = value[f"rate.angular_acceleration_{axis}"]
        assert slope[f"rate.angular_velocity_{axis}"] == pytest.approx(spin, abs=1e-9)
    poses = skeleton_from(appearance(made, [])).poses({n: np.array([v]) for n, v in value.items()})
    body = [b.name for b in made.bodies if not b.is_abstract].index("second")
    at = [value[f"second.{axis}"] for axis in "xyz"]
    assert poses.position[0, body] == pytest.approx(at, abs=1e-12)


@pytest.mark.parametrize("model", ["mean axes", "solid"])
def test_a_free_body_keeps_momentum_and_energy(files, model):
    """Without outer forces the rates of momentum and energy are zero."""
    hub = Body("hub", GROUND, joints=tuple(Joint(kind, f"hub.{kind}") for kind in FREE))
    body = flexible(files, model, body="hub")
    e = derive(System("free", ParameterTable(), (hub,), parts=(body,), gravity=(0.0, 0.0, 0.0)))
    n = len(e.states) // 2
    q, u = e.state[:n], e.state[n:]
    channel = {c.name: k for k, c in enumerate(e.channels)}
    kinetic = e.output[channel["energy.kinetic"]]
    strain = e.output[channel["frame.strain_energy"]]
    total = kinetic + strain
    push = ca.gradient(kinetic, u)  # Conjugate to T1, T2, T3: the momentum.
    names = [s.name for s in e.states]
    # Axes of R1, R2, R3 in the world: (1, 0, 0), (0, cos a, sin a), (sin b, -sin a cos b,
    # cos a cos b); with these rates of the angles the body turns about z.
    a, b = q[names.index("hub.R1")], q[names.index("hub.R2")]
    about_z = ca.vertcat(-ca.tan(b) * ca.cos(a), ca.sin(a), ca.cos(a) / ca.cos(b))
    spins = [names.index(f"hub.{kind}") for kind in ("R1", "R2", "R3")]
    along = [names.index(f"hub.{kind}") for kind in ("T1", "T2", "T3")]
    spin = sum(about_z[k] * push[j] for k, j in enumerate(spins))
    spin = spin + q[along[0]] * push[along[1]] - q[along[1]] * push[along[0]]
    kept = ca.vertcat(total, spin, *(push[j] for j in along))
    rate = ca.Function("f", [e.state], [ca.jtimes(kept, e.state, e.rate), push, total])
    slopes, momentum, energy = rate(at_random(e, 5))
    size = max(np.abs(np.array(momentum)).max(), float(energy))  # of what cancels
    fastest = body.component_modes.frequencies.max()
    assert np.abs(np.array(slopes)).max() < 1e-14 * size * fastest


@pytest.mark.parametrize("model", [*SETTINGS, *STIFFENED])
def test_a_body_that_does_not_deform_is_a_rigid_one(files, model):
    """With no amplitudes and rates its energies are those of a rigid body, for any motion."""
    body = flexible(files, model, body="hub")
    hub = Body("hub", GROUND, joints=tuple(Joint(kind, f"hub.{kind}") for kind in FREE))
    root = body.added_bodies()[0]
    rigid = Body(
        "frame", "hub", mass=root.mass, com=root.com, inertia=root.inertia, apparent_inertia=True
    )
    e = derive(System("bends", ParameterTable(), (hub,), parts=(body,)))
    r = derive(System("rigid", ParameterTable(), (hub, rigid)))
    x = np.random.default_rng(2).normal(size=12)
    state = np.zeros(len(e.states))
    index = {s.name: k for k, s in enumerate(e.states)}
    for value, s in zip(x, r.states, strict=True):
        state[index[s.name]] = value
    for word in ("energy.kinetic", "energy.gravity"):
        values = [
            float(
                ca.Function("f", [k.state], [k.output[[c.name for c in k.channels].index(word)]])(y)
            )
            for k, y in ((e, state), (r, x))
        ]
        assert values[0] == pytest.approx(values[1], rel=1e-12)


@pytest.mark.parametrize("model", SETTINGS)
def test_roots_of_the_mass_matrix(files, model, monkeypatch):
    """The rows that singular masses are found by have the mass matrix as their square."""
    from vehicledyn.multibody.equations.singular_mass import Resistance

    seen = []
    original = Resistance._inertial

    def noted(self, time, q, values):
        seen.append((self, original(self, time, q, values)))
        return seen[-1][1]

    monkeypatch.setattr(Resistance, "_inertial", noted)
    e = derive(carrying(files, model))
    n = len(e.states) // 2
    names = [c.name for c in e.channels]
    kinetic = e.output[names.index("energy.kinetic")]
    resistance = seen[0][0]
    state = at_random(e, 6)
    state[:n] *= 0.3  # at larger deformations the mass of second order is not positive definite
    order = [[s.name for s in e.states].index(joint.name) for joint in resistance.joints]
    rows = original(resistance, 0.0, state[order], resistance._values)
    hessian = ca.hessian(kinetic, e.state[n:])[0]
    mass = np.array(ca.Function("m", [e.state], [hessian])(state))[np.ix_(order, order)]
    assert rows.T @ rows == pytest.approx(mass, abs=1e-11 * np.abs(mass).max())


@pytest.mark.parametrize("model", SETTINGS)
def test_integrals_are_those_of_the_points(files, monkeypatch, model):
    """By integrals and by points of the same integrals the rates are the same."""
    from vehicledyn.multibody.bodies.finite_elements.reduced_body import ReducedBody

    functions = []
    for products in (lambda body: Integrals(body.integrals.products), lambda _: None):
        monkeypatch.setattr(ReducedBody, "products", property(products))
        e = derive(carrying(files, model))
        functions.append(ca.Function("f", [e.state], [e.rate], {"cse": True}))
        x = at_random(e, 7)
    a, b = (np.array(f(x))[:, 0] for f in functions)
    assert a == pytest.approx(b, rel=1e-9, abs=1e-9 * np.abs(b).max())
    if model == "solid":
        assert functions[0].n_instructions() < 0.8 * functions[1].n_instructions()


def test_terms_grow_with_the_square_of_the_modes(files):
    """Twice the modes take at most four times the operations."""
    counts = []
    for modes in (4, 8, 16):
        hub = Body("hub", GROUND, joints=(Joint("R3", "turn"),))
        body = FlexibleBody(
            "frame", body="hub", file=str(files / "solid.npz"), modes=modes,
            interface={"root": (1, 2, 3, 4)},
        )  # fmt: skip
        e = derive(System("growth", ParameterTable(), (hub,), parts=(body,)))
        counts.append(ca.Function("f", [e.state], [e.rate], {"cse": True}).n_instructions())
    assert counts[1] < 4 * counts[0]
    assert counts[2] < 4 * counts[1]
