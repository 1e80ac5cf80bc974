"""Constraint forces against closed forms and balances written by hand."""

import math

import numpy as np
import pytest

from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import (
    GROUND,
    BallCut,
    Belt,
    Body,
    ConstraintForceSensor,
    Joint,
    ParameterTable,
    ReactionSensor,
    RodCut,
    System,
    UserConstraint,
    derive,
)

G = 9.81
ALGEBRA = 1e-11

pytestmark = pytest.mark.validation


def channels(system, **states):
    """Channels at a state that is given by name, others at their start."""
    e = derive(system)
    kernel = compile_kernel(e, backend="interpreted")
    x = np.array([states.get(s.name, s.start) for s in e.states])
    z = assemble(kernel, 0.0, x, np.array([u.start for u in e.unknowns]))
    return dict(zip((c.name for c in e.channels), kernel.outputs(0.0, x, z), strict=True))


def system(bodies, **more):
    return System("test", ParameterTable(), tuple(bodies), **more)


def triple(values, name):
    return np.array([values[f"{name}_{axis}"] for axis in "xyz"])


@pytest.mark.parametrize(("angle", "rate"), [(0.3, 0.0), (-1.1, 2.5), (2.0, -3.0)])
def test_tension_of_a_pendulum_rod(angle, rate):
    """S = m (g cos a + l a'²), as the axial force of a rod and as the reaction of a hinge."""
    mass, length = 1.7, 0.8
    bob = Body(
        "bob",
        GROUND,
        joints=(
            Joint("T1", "x", start=-length * math.sin(angle)),
            Joint("T3", "z", start=-length * math.cos(angle)),
        ),
        mass=mass,
    )
    rod = RodCut("rod", GROUND, (0, 0, 0), "bob", (0, 0, 0), length)
    sensor = ConstraintForceSensor("on_bob", "rod", "bob")
    free = {"x_rate": -length * rate * math.cos(angle), "z_rate": length * rate * math.sin(angle)}
    values = channels(system([bob], cuts=(rod,), parts=(sensor,)), **free)
    tension = mass * (G * math.cos(angle) + length * rate**2)
    assert values["rod.axial_force"] == pytest.approx(tension, rel=ALGEBRA)
    along = np.array([math.sin(angle), 0.0, math.cos(angle)])
    assert triple(values, "on_bob.force") == pytest.approx(tension * along, abs=ALGEBRA * tension)

    hung = Body("bob", GROUND, joints=(Joint("R2", "a"),), mass=mass, com=(0, 0, -length))
    sensors = (ReactionSensor("hinge", "bob", axes="body"),)
    values = channels(system([hung], parts=sensors), a=angle, a_rate=rate)
    assert values["hinge.force_z"] == pytest.approx(tension, rel=ALGEBRA)
    assert values["hinge.force_x"] == pytest.approx(0.0, abs=ALGEBRA * tension)


def test_the_normal_force_of_a_slider_is_the_multiplier():
    """Slider-crank, h = r sin a + l sin b (book, 2.4.3), against the guide of a real slider.

    Written with the height of the end of the rod, the multiplier of h is the force of the guide
    on the slider; a slider on a prismatic joint with a ball cut must find the same.
    """
    r, length, mass, a, rate = 0.1, 0.3, 0.7, 0.6, 12.0
    b = -a - math.asin(r * math.sin(a) / length)
    inertia = (0.0, 0.002, 0.002)

    def chain(*extra):
        crank = Body("crank", GROUND, joints=(Joint("R3", "a", start=a, role="independent"),),
                     mass=0.5, com=(0.05, 0, 0), inertia=inertia)  # fmt: skip
        rod = Body("rod", "crank", (r, 0, 0), (Joint("R3", "b", start=b),), mass=0.4,
                   com=(0.15, 0, 0), inertia=inertia)  # fmt: skip
        return [crank, rod, *extra]

    gravity = (0.0, -G, 0.0)
    load = Body("slider", "rod", (length, 0, 0), (Joint("R3", "c", start=-a - b),), mass=mass,
                inertia=(0.01, 0.01, 0.01))  # fmt: skip
    height = UserConstraint("guide", lambda g: g.position("slider")[1])
    upright = UserConstraint(
        "upright", lambda g: g.coordinate("a") + g.coordinate("b") + g.coordinate("c"), "rad", "N*m"
    )
    written = channels(
        system(chain(load), constraints=(height, upright), gravity=gravity), a_rate=rate
    )
    x = r * math.cos(a) + length * math.cos(a + b)
    slide = Body("slider", GROUND, joints=(Joint("T1", "s", start=x),), mass=mass)
    pin = BallCut("pin", "rod", (length, 0, 0), "slider", (0, 0, 0))
    sensor = ReactionSensor("guide", "slider", shows=("force",))
    real = channels(
        system(chain(slide), cuts=(pin,), parts=(sensor,), gravity=gravity), a_rate=rate
    )
    assert written["guide.multiplier"] == pytest.approx(real["guide.force_y"], rel=1e-10)
    assert abs(real["guide.force_y"]) > 1.0


def test_tension_difference_of_a_belt():
    """An open belt between two pulleys, one of them loaded: J₁ a₁ = M - r₁ S, J₂ a₂ = r₂ S."""
    r1, r2, j1, j2 = 0.05, 0.2, 0.01, 0.3
    motor = Body("motor", GROUND, joints=(Joint("R2", "m"),), mass=1.0, inertia=(1.0, j1, 1.0))
    drum = Body("drum", GROUND, (1, 0, 0), (Joint("R2", "d"),), mass=2.0, com=(0.1, 0.0, 0.0),
                inertia=(1.0, j2, 1.0))  # fmt: skip
    made = system([motor, drum], constraints=(Belt("belt", "d", "m", r2, r1),))
    values = channels(made)
    weight = 2.0 * G * 0.1
    inertia = j2 + 2.0 * 0.1**2 + j1 * (r2 / r1) ** 2
    tension = -(r2 / r1**2) * j1 * weight / inertia
    assert values["belt.tension_difference"] == pytest.approx(tension, rel=ALGEBRA)
    assert values["belt.torque"] == pytest.approx(r2 * tension, rel=ALGEBRA)
    assert values["belt.driving_torque"] == pytest.approx(-r1 * tension, rel=ALGEBRA)


def test_bearing_forces_of_a_four_bar():
    """Nine balances of three bars in the plane, solved for four bearing forces."""
    lengths, masses, ground = (0.4, 0.9, 0.7), (1.0, 2.0, 1.5), np.array([0.8, 0.1])
    angles = [1.2, -0.9, 0.0]
    place = [0.4 * np.array([math.cos(1.2), math.sin(1.2)])]
    tip = place[0] + 0.9 * np.array([math.cos(0.3), math.sin(0.3)])
    reach = tip - ground
    angles[2] = math.atan2(reach[1], reach[0])
    rocker = float(np.hypot(*reach))
    lengths = (0.4, 0.9, rocker)
    moments = [m * h * h / 12.0 for m, h in zip(masses, lengths, strict=True)]
    parents, at = (GROUND, "one", GROUND), ((0, 0, 0), (0.4, 0, 0), (*ground, 0))
    roles = ("independent", "auto", "auto")
    bodies = [
        Body(n, p, o, (Joint("R3", f"q{n}", start=q, role=role),), mass=m, com=(h / 2, 0, 0),
             inertia=(0, k, k))
        for n, p, o, q, role, m, h, k in zip(
            ("one", "two", "three"), parents, at, angles, roles, masses, lengths, moments,
            strict=True)
    ]  # fmt: skip
    pin = BallCut("pin", "two", (0.9, 0, 0), "three", (rocker, 0, 0))
    sensors = [ReactionSensor(n, n, shows=("force",)) for n in ("one", "two", "three")]
    sensors.append(ConstraintForceSensor("tip", "pin", "three", shows=("force",)))
    made = system(bodies, cuts=(pin,), parts=tuple(sensors), gravity=(0, -G, 0))
    values = channels(made, qone_rate=3.0)

    absolute = np.array([angles[0], angles[0] + angles[1], angles[2]])
    rates = [values["qone_rate"], values["qone_rate"] + values["qtwo_rate"], values["qthree_rate"]]
    along = np.array([[math.cos(q), math.sin(q)] for q in absolute])
    across = np.array([[-math.sin(q), math.cos(q)] for q in absolute])
    # Unknown: angular accelerations (3), forces in the bearings 0-1, 1-2, 0-3 and pin on 3 (8).
    matrix, right = np.zeros((11, 11)), np.zeros(11)
    arms = [[(0, 0.5)], [(0, 1.0), (1, 0.5)], [(2, 0.5)]]
    acting = [[(3, 1.0, 0.0), (5, -1.0, 1.0)], [(5, 1.0, 0.0), (9, -1.0, 1.0)],
              [(7, 1.0, 0.0), (9, 1.0, 1.0)]]  # fmt: skip
    for k in range(3):
        for bar, part in arms[k]:
            lever = part * lengths[bar]
            matrix[3 * k : 3 * k + 2, bar] += masses[k] * lever * across[bar]
            right[3 * k : 3 * k + 2] += masses[k] * lever * rates[bar] ** 2 * along[bar]
        right[3 * k + 1] -= masses[k] * G
        matrix[3 * k + 2, k] = moments[k]
        for column, sign, end in acting[k]:
            for axis in range(2):
                matrix[3 * k + axis, column + axis] -= sign
            lever = (end - 0.5) * lengths[k] * along[k]
            matrix[3 * k + 2, column : column + 2] -= sign * np.array([-lever[1], lever[0]])
    for bar, sign in ((0, 1.0), (1, 1.0), (2, -1.0)):
        matrix[9:11, bar] += sign * lengths[bar] * across[bar]
        right[9:11] += sign * lengths[bar] * rates[bar] ** 2 * along[bar]
    found = np.linalg.solve(matrix, right)
    for name, column in (("one", 3), ("two", 5), ("three", 7), ("tip", 9)):
        told = triple(values, f"{name}.force")
        assert told[:2] == pytest.approx(found[column : column + 2], rel=1e-10, abs=1e-10)
        assert np.isnan(told[2])


def test_a_door_on_two_hinges_says_what_cannot_be_told(caplog):
    """Two hinges in line: each may take the weight and push along the axis against the other."""
    door = Body("door", GROUND, joints=(Joint("R3", "a", start=0.4),), mass=20.0,
                com=(0.4, 0, 1.0), inertia=(1, 1, 1))  # fmt: skip
    upper = BallCut("upper", GROUND, (0, 0, 2.0), "door", (0, 0, 2.0))
    sensor = ReactionSensor("lower", "door", shows=("force",))
    e = derive(system([door], cuts=(upper,), parts=(sensor,)))
    assert {f"upper.force_{axis}" for axis in "xyz"} == set(e.structure["undetermined"])
    told = {c.name: c.description for c in e.channels}
    assert not {name for name in told if name.startswith("upper.")}
    assert "not unique" in told["lower.force_x"]
    assert "sensor 'lower': force_x, force_y, force_z cannot be determined" in caplog.text
    assert "upper.force_x" in caplog.text
