"""Every type of joint of the catalogue: what it says of its motion, and what follows from it."""

from dataclasses import dataclass

import numpy as np
import pytest
from joint_examples import SETTINGS, joint, train

from vehicledyn.base import registry
from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import find, kinds
from vehicledyn.multibody import (
    GROUND,
    Body,
    BodyCut,
    Joint,
    ParameterTable,
    ReactionSensor,
    System,
    Turn,
    derive,
)
from vehicledyn.multibody.elements.coordinate_forces import CoordinateForce
from vehicledyn.multibody.equations.inverse_dynamics import derive_inverse
from vehicledyn.multibody.joints.joint_type import Axes, JointType, setting
from vehicledyn.multibody.joints.numeric_joint import displacements, quaternions
from vehicledyn.symbolic import ops, rotations

KINDS = kinds("joint_type")
ONE_COORDINATE = [kind for kind in KINDS if kind != "spherical_quaternion"]


@pytest.mark.parametrize("kind", ONE_COORDINATE)
def test_axes_are_the_rates_of_rotation_and_displacement(kind):
    of, q = joint(kind).type, ops.symbol("q")
    turn, slide = of.rotation(q), of.displacement(q)
    turn = rotations.identity() + 0.0 * q if turn is None else turn
    slide = ops.vector(0.0, 0.0, 0.0) if slide is None else slide
    swing = turn.T @ ops.unflat(ops.derivative(ops.flat(turn), q, 1.0), 3)
    found = ops.stacked(
        swing[2, 1], swing[0, 2], swing[1, 0], turn.T @ ops.derivative(slide, q, 1.0)
    )
    axes, none = of.motion(q), ops.vector(0.0, 0.0, 0.0)
    told = ops.stacked(*(none if axis is None else axis for axis in (axes.angular, axes.linear)))
    assert np.abs(ops.numeric([q], found - told)(0.6)).max() < 1e-15


@pytest.mark.parametrize("kind", ONE_COORDINATE)
def test_numbers_are_those_of_the_expressions(kind):
    of, values = joint(kind).type, np.array([-2.0, 0.3, 4.0])
    for found in (displacements(of, values[:0]), quaternions(of, values[:0])):
        assert found is None or len(found) == 0
    shift, turned = displacements(of, values), quaternions(of, values)
    for k, value in enumerate(values):
        if shift is not None:
            assert shift[k] == pytest.approx(ops.numeric([], of.displacement(value))()[:, 0])
        if turned is not None:
            w, x, y, z = turned[k]
            first = [w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)]
            assert first == pytest.approx(ops.numeric([], of.rotation(value))()[:, 0])


def rates(equations, state):
    inputs = [equations.time, equations.state, equations.algebraic, equations.parameter]
    numbers = [0.0, state, [], [p.value for p in equations.parameters]]
    return ops.numeric(inputs, equations.rate)(*numbers)[:, 0]


@pytest.mark.parametrize("kind", KINDS)
def test_formulations_agree(kind):
    found = [derive(train(kind), formulation=f) for f in ("composite", "articulated")]
    state = np.random.default_rng(3).normal(size=len(found[0].states))
    assert rates(found[0], state) == pytest.approx(rates(found[1], state), rel=1e-11, abs=1e-11)


@pytest.mark.parametrize("kind", KINDS)
def test_energy_is_kept(kind):
    e = derive(train(kind))
    rows = [k for k, c in enumerate(e.channels) if c.name in ("energy.kinetic", "energy.gravity")]
    energy = sum(e.output[k] for k in rows)
    growth = ops.derivative(energy, e.state, e.rate)
    at = ops.numeric([e.state, e.parameter], ops.stacked(growth, energy))
    for seed in range(3):
        state = np.random.default_rng(seed).normal(size=len(e.states))
        found = at(state, [p.value for p in e.parameters])[:, 0]
        assert found[0] == pytest.approx(0.0, abs=1e-11 * abs(found[1]))


@pytest.mark.parametrize("kind", ONE_COORDINATE)
def test_forces_of_a_prescribed_motion_give_that_motion(kind):
    position, rate, wanted = np.random.default_rng(5).normal(size=(3, 3))
    inverse = derive_inverse(train(kind))
    e = inverse.equations
    numbers = ops.numeric([e.state, e.parameter], e.output)(
        inverse.state(position, rate, wanted), []
    )[:, 0]
    place = {c.name: k for k, c in enumerate(e.channels)}
    forces = [float(numbers[place[name]]) for name in inverse.force_channels]
    pushes = [
        CoordinateForce(f"push {name}", name, lambda _, f=force: f)
        for name, force in zip(inverse.coordinates, forces, strict=True)
    ]
    found = derive(train(kind).with_parts(*pushes))
    assert [found.states[k].name for k in found.positions] == list(inverse.coordinates)
    state = np.concatenate([position, rate])
    assert rates(found, state)[3:] == pytest.approx(wanted, rel=1e-10, abs=1e-10)


def test_cylinder_rolls_down_a_slope():
    """By the energy, m r² + J is what the weight on the slope, m g r sin β, turns."""
    slope, radius, mass, spin = 0.3, 0.4, 2.0, 0.05
    roll = Joint("rolling", "c.q", settings={"axis": 2, "normal": 3, "radius": radius})
    turns = (Turn(rotations.turn(2, slope)), roll)
    cylinder = Body("c", GROUND, joints=turns, mass=mass, inertia=(1.0, spin, 1.0, 0, 0, 0))
    found = derive(System("s", ParameterTable(), (cylinder,)))
    wanted = mass * GRAVITY * radius * np.sin(slope) / (mass * radius**2 + spin)
    assert rates(found, [0.7, 3.0]) == pytest.approx([3.0, wanted], rel=1e-13)


def test_nothing_rolls_about_the_normal_of_its_plane():
    with pytest.raises(InputError, match="the normal is the axis, 2"):
        _ = Joint("rolling", "c.q", settings={"axis": 2, "normal": 2, "radius": 1.0}).type


@pytest.mark.parametrize("mirror", [1, 2, 3])
@pytest.mark.parametrize(("axis", "normal"), [(2, 3), (1, 3), (3, 1)])
def test_mirror_image_of_a_roller_travels_as_the_image_of_the_roller(mirror, axis, normal):
    of = find("joint_type", "rolling")(axis=axis, normal=normal, radius=0.4)
    turned = -1.0 if of.is_turned_by_mirror(mirror) else 1.0
    side = -1.0 if of.handed_settings(mirror) else 1.0
    image = find("joint_type", "rolling")(axis=axis, normal=normal, radius=0.4 * side)
    wanted = ops.numeric([], of.displacement(0.3))()[:, 0]
    wanted[mirror - 1] *= -1.0
    assert ops.numeric([], image.displacement(0.3 * turned))()[:, 0] == pytest.approx(wanted)


LEAD, MASS, SPIN, GRAVITY = 0.02, 3.0, 0.004, 9.81
ADVANCE = LEAD / (2.0 * np.pi)


def nut(**more):
    table = ParameterTable()
    lead = table.add("lead", LEAD, "m", "Lead of the thread")
    turn = Joint("screw", "nut.angle", settings={"axis": 3, "lead": lead})
    inertia = (0.003, 0.003, SPIN)
    return System(
        "jack", table, (Body("nut", GROUND, joints=(turn,), mass=MASS, inertia=inertia),), **more
    )


@pytest.mark.parametrize("formulation", ["composite", "articulated"])
def test_nut_falls_along_its_screw(formulation):
    """m z̈ + (J/h²) z̈ = -m g with h the advance over angle; the thread bears the rest."""
    e = derive(nut(parts=(ReactionSensor("thread", "nut"),)), formulation=formulation)
    falls = -GRAVITY / (1.0 + SPIN / (MASS * ADVANCE**2))
    found = rates(e, np.array([0.4, 2.0]))
    assert found[1] * ADVANCE == pytest.approx(falls, rel=1e-13)
    channels = {c.name: k for k, c in enumerate(e.channels)}
    numbers = ops.numeric([e.state, e.parameter], e.output)([0.4, 2.0], [LEAD])[:, 0]
    force = numbers[channels["thread.force_z"]]
    torque = numbers[channels["thread.torque_z"]]
    assert force == pytest.approx(MASS * (GRAVITY + falls), rel=1e-12)
    assert torque == pytest.approx(SPIN * falls / ADVANCE, rel=1e-12)
    assert force * ADVANCE + torque == pytest.approx(0.0, abs=1e-14)


def test_lead_stays_a_parameter():
    e = derive(nut())
    rate = ops.numeric([e.state, e.parameter], e.rate)
    h = 0.05 / (2.0 * np.pi)
    falls = -GRAVITY / (1.0 + SPIN / (MASS * h**2))
    assert rate([0.0, 0.0], [0.05])[1, 0] * h == pytest.approx(falls, rel=1e-13)


def test_screw_in_a_loop():
    """A spindle turns between bearings; its nut, held by a slide, comes down."""
    h, spin, mass = ADVANCE, 0.01, 4.0
    thread = Joint("screw", "nut.angle", settings={"axis": 3, "lead": LEAD})
    bodies = (
        Body("table", GROUND, joints=(Joint("T3", "table.z"),), mass=mass, inertia=(1.0,) * 3),
        Body(
            "spindle", GROUND, joints=(Joint("R3", "spindle.angle"),), mass=1.0,
            inertia=(0.02, 0.02, spin),
        ),
        Body("nut", "spindle", joints=(thread,)),
    )  # fmt: skip
    cut = BodyCut("held", "nut", (0.0, 0.0, 0.0), "table", (0.0, 0.0, 0.0))
    e = derive(System("press", ParameterTable(), bodies, (cut,)))
    assert e.structure["degrees_of_freedom"] == 1
    (free,) = e.structure["independent"]
    inputs = [e.time, e.state, e.algebraic, e.parameter]
    found = ops.numeric(inputs, e.rate)(0.0, [0.0, 0.0], [0.0, 0.0], [])[1, 0]
    falls = -GRAVITY / (1.0 + spin / (mass * h**2))
    share = {"table.z": 1.0, "spindle.angle": -1.0 / h, "nut.angle": 1.0 / h}
    assert found == pytest.approx(falls * share[free], rel=1e-10)


def test_settings_are_checked():
    for settings, words in (
        ({"axis": 3}, "lacks lead"),
        ({"axis": 3, "lead": 0.1, "lede": 1.0}, "setting of the joint screw"),
    ):
        system = System("x", ParameterTable(), (
            Body("b", GROUND, joints=(Joint("screw", "b.q", settings=settings),), mass=1.0),
        ))  # fmt: skip
        with pytest.raises(InputError, match=words):
            system.check()


def test_every_type_with_settings_has_an_example():
    for kind in KINDS:
        assert joint(kind).type.kind == kind
    assert set(SETTINGS) <= set(KINDS)


@dataclass(frozen=True)
class Slot(JointType):
    """Slide along z = k x²/2 by the coordinate x: axes that change, and no turn."""

    unit = "m"
    kind = "slot"
    has_constant_axes = False

    curvature: float = setting("1/m", "Curvature k at the bottom")

    def displacement(self, q):
        return ops.vector(q, 0.0, 0.5 * self.curvature * q * q)

    def motion(self, q):
        return Axes(linear=ops.vector(1.0, 0.0, self.curvature * q))

    def is_turned_by_mirror(self, axis):
        return axis == 1


@pytest.mark.parametrize("formulation", ["composite", "articulated"])
def test_bead_in_a_slot_whose_direction_changes(formulation, monkeypatch):
    """ẍ = -k x (g + k ẋ²) / (1 + k² x²), of L = m/2 (1 + k² x²) ẋ² - m g k x²/2."""
    monkeypatch.setitem(registry._catalogues["joint_type"], "slot", Slot)
    k, x, v = 3.0, 0.4, -1.2
    bead = Body(
        "bead", GROUND, joints=(Joint("slot", "bead.x", settings={"curvature": k}),), mass=2.0
    )
    e = derive(System("bead", ParameterTable(), (bead,)), formulation=formulation)
    exact = -k * x * (GRAVITY + k * v * v) / (1.0 + k * k * x * x)
    assert rates(e, np.array([x, v]))[1] == pytest.approx(exact, rel=1e-14)
