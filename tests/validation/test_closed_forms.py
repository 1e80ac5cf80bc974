"""Closed forms of Samin and Fisette, chapters 1 and 2, and of the IFToMM benchmark library."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import find
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import (
    GROUND,
    BallCut,
    BasePart,
    Body,
    ConstantRate,
    Joint,
    Loads,
    ParameterTable,
    System,
    derive,
)
from vehicledyn.symbolic import ops

REFERENCE = YAML(typ="safe").load(
    (Path(__file__).parent / "data" / "n_four_bar_pendulum.yaml").read_text(encoding="utf-8")
)
GRAVITY = (0.0, -REFERENCE["gravity"]["value"], 0.0)
# dop853 at 1e-12 with a few hundred steps; the figures have fifteen digits.
MOTION = 1e-9
ALGEBRA = 1e-12

pytestmark = pytest.mark.validation


def system(name, bodies, **more):
    more.setdefault("gravity", (0.0, 0.0, 0.0))
    return System(name, more.pop("table", ParameterTable()), tuple(bodies), **more)


def bar(name, parent, at, angle, *, rate=0.0, role="auto"):
    """A uniform bar of 1 m and 1 kg along its own first axis."""
    joint = Joint("R3", f"{name}.angle", angle, role, rate)
    inertia = (0.0, 1.0 / 12.0, 1.0 / 12.0)
    return Body(name, parent, at, (joint,), mass=1.0, com=(0.5, 0.0, 0.0), inertia=inertia)


def start_values(equations):
    return np.array([s.start for s in equations.states]), np.array(
        [u.start for u in equations.unknowns]
    )


def evaluate(equations, state=None, expression=None):
    """Numbers of the rates (or another expression) at a state, unknowns as assembled."""
    x, z = start_values(equations)
    inputs = [equations.time, equations.state, equations.algebraic, equations.parameter]
    expression = equations.rate if expression is None else expression
    values = [p.value for p in equations.parameters]
    return ops.numeric(inputs, expression)(0.0, x if state is None else state, z, values)[:, 0]


def channels(equations, state=None):
    values = evaluate(equations, state, equations.output)
    return dict(zip((c.name for c in equations.channels), values, strict=True))


def states_at(equations, times):
    """States at equal intervals from zero, by name, with a tight integrator."""
    kernel = compile_kernel(equations, backend="interpreted")
    x, z = start_values(equations)
    found = []
    simulate(
        kernel,
        find("solver", "dop853")(relative_tolerance=1e-12, absolute_tolerance=1e-12),
        start=0.0,
        stop=times[-1],
        state=x,
        unknowns=z,
        interval=times[0],
        sink=lambda t, x, z, y: found.extend(zip(t, x, strict=True)),
    )
    names = [s.name for s in equations.states]
    return {round(float(t), 9): dict(zip(names, x, strict=True)) for t, x in found}


def test_pendulum():
    joint = Joint("R3", "angle", start=0.0)
    body = Body("mass", GROUND, joints=(joint,), mass=1.0, com=(-1.0, 0.0, 0.0))
    equations = derive(system("pendulum", [body], gravity=GRAVITY))
    expected = REFERENCE["pendulum"]["times"]
    found = states_at(equations, [0.5, max(expected)])
    for time, place in expected.items():
        angle = found[time]["angle"]
        position = (-np.cos(angle), -np.sin(angle))
        assert position == pytest.approx((place["x"], place["y"]), abs=MOTION)


def four_bars(count):
    up = 0.5 * np.pi
    first = bar("upright_0", GROUND, (0.0, 0.0, 0.0), up, rate=-1.0, role="independent")
    bodies, cuts, tip = [first], [], (1.0, 0.0, 0.0)
    for k in range(count):
        bodies.append(bar(f"coupler_{k}", f"upright_{k}", tip, -up))
        bodies.append(bar(f"upright_{k + 1}", GROUND, (k + 1.0, 0.0, 0.0), up))
        cuts.append(BallCut(f"cut_{k}", f"coupler_{k}", tip, f"upright_{k + 1}", tip))
    return system(f"{count} four-bars", bodies, cuts=tuple(cuts), gravity=GRAVITY)


@pytest.mark.parametrize("count", [1, 2])
def test_n_four_bar(count):
    equations = derive(four_bars(count))
    assert equations.structure["degrees_of_freedom"] == 1
    # The gap across the plane of motion closes by itself, once a loop.
    assert equations.structure["redundant"] == [f"cut_{k}" for k in range(count)]
    case = REFERENCE["n_four_bar"]
    state = states_at(equations, [case["time"]])[case["time"]]
    angle, rate = state["upright_0.angle"], state["upright_0.angle_rate"]
    x, y = np.cos(angle), np.sin(angle)
    expected = case["bars"][count]
    assert (x, y, -y * rate, x * rate) == pytest.approx(
        tuple(expected[k] for k in ("x", "y", "vx", "vy")), abs=MOTION
    )


@dataclass(frozen=True)
class Spring(BasePart):
    coordinate: str
    stiffness: float

    def loads(self, situation):
        q = situation.kinematics.coordinate(self.coordinate)
        return Loads(joint_forces={self.coordinate: -self.stiffness * q})


def ball_in_tube(stiffness, speed=2.0, mass=0.7):
    """Equation 2.59: a ball slides in a tube that turns at a prescribed rate."""
    tube = Body("tube", GROUND, joints=(Joint("R3", "turn", role="driven"),))
    slide = Joint("T1", "slide", start=0.3, start_rate=-0.2)
    ball = Body("ball", "tube", joints=(slide,), mass=mass)
    parts = (ConstantRate("drive", "turn", speed), Spring("spring", "slide", stiffness))
    return derive(system("ball in tube", [tube, ball], parts=parts))


@pytest.mark.parametrize("stiffness", [0.0, 1.5, 9.0])
def test_ball_in_a_turning_tube(stiffness):
    _, acceleration = evaluate(ball_in_tube(stiffness))
    assert acceleration == pytest.approx((2.0**2 - stiffness / 0.7) * 0.3, rel=ALGEBRA)


def test_motion_of_the_free_ball_in_the_tube():
    """With k = 0 the solution of 2.59 is q0 cosh ωt + (q̇0/ω) sinh ωt."""
    found = states_at(ball_in_tube(0.0), [1.0])[1.0]["slide"]
    assert found == pytest.approx(0.3 * np.cosh(2.0) - 0.1 * np.sinh(2.0), rel=MOTION)


def test_drive_of_the_tube_overcomes_coriolis():
    values = channels(ball_in_tube(0.0))
    assert values["turn_force"] == pytest.approx(0.7 * 2.0 * 2.0 * -0.2 * 0.3, rel=ALGEBRA)


R, L = 0.3, 0.8
J, M = 0.05, 1.7


def slider_crank(angle):
    """Crank with inertia, massless rod, slider: constraint 2.12 of the book, by a ball cut."""
    crank_joint = Joint("R3", "crank.angle", angle, "independent", 4.0)
    crank = Body("crank", GROUND, joints=(crank_joint,), mass=1.0, inertia=(J, J, J))
    lean = np.arcsin(R / L * np.sin(angle))
    rod = Body("rod", "crank", (R, 0.0, 0.0), (Joint("R3", "rod.angle", -lean - angle),))
    place = R * np.cos(angle) + L * np.cos(lean)
    slider = Body("slider", GROUND, joints=(Joint("T1", "slider.x", place),), mass=M)
    cut = BallCut("pin", "rod", (L, 0.0, 0.0), "slider", (0.0, 0.0, 0.0))
    return derive(system("slider-crank", [crank, rod, slider], cuts=(cut,)))


@pytest.mark.parametrize("angle", [0.2, 1.1, 2.4, -0.9])
def test_slider_crank(angle):
    """Slider motion, crank acceleration and the force of the guide in closed form (2.4.3)."""
    equations = slider_crank(angle)
    s, c, w = np.sin(angle), np.cos(angle), 4.0
    root = np.sqrt(L**2 - R**2 * s**2)
    place = R * c + root
    slope = -R * s - R**2 * s * c / root
    bend = -R * c - R**2 * (c * c - s * s) / root - R**4 * s * s * c * c / root**3
    angular = -M * slope * bend * w**2 / (J + M * slope**2)
    pull = M * (slope * angular + bend * w**2)
    values = channels(equations)
    assert values["slider.x"] == pytest.approx(place, rel=ALGEBRA)
    assert values["slider.x_rate"] == pytest.approx(slope * w, rel=ALGEBRA)
    assert evaluate(equations)[1] == pytest.approx(angular, rel=1e-11)
    assert values["pin.force_x"] == pytest.approx(pull, rel=1e-11)
    # The massless rod pulls along itself; the guide bears what is across.
    assert values["pin.force_y"] == pytest.approx(-pull * R * s / root, rel=1e-11)


def parallelogram(angle):
    """Figure 2.5 of the book: two cranks of length d and a coupler of length l."""
    crank = bar("one", GROUND, (0.0, 0.0, 0.0), angle)
    coupler = bar("two", "one", (1.0, 0.0, 0.0), -angle)
    other = bar("three", GROUND, (1.0, 0.0, 0.0), angle)
    cut = BallCut("C", "two", (1.0, 0.0, 0.0), "three", (1.0, 0.0, 0.0))
    return system("parallelogram", [crank, coupler, other], cuts=(cut,))


def test_parallelogram_has_one_degree_of_freedom():
    equations = derive(parallelogram(0.7))
    assert equations.structure["degrees_of_freedom"] == 1
    assert equations.structure["redundant"] == ["C"]


def test_parallelogram_in_one_line_is_singular():
    """At φ1 = 0 the Jacobian has rank one and the parallelogram two freedoms (figure 2.6)."""
    with pytest.raises(InputError, match=r"singular.*'C'"):
        derive(parallelogram(0.0))


def test_angular_velocity_of_tait_bryan_angles():
    """Equation 1.61: sequence 1-2-3, components in the axes of the body."""
    a2, a3 = 0.7, -0.4
    joints = tuple(
        Joint(f"R{k}", f"angle_{k}", q, start_rate=w)
        for k, q, w in ((1, 0.3, 1.1), (2, a2, -0.6), (3, a3, 0.8))
    )
    inertia = (1.0, 1.0, 1.0)
    body = Body("body", GROUND, joints=joints, mass=1.0, inertia=inertia)

    @dataclass(frozen=True)
    class Spin(BasePart):
        def loads(self, situation):
            spin.append(situation.kinematics.angular_velocity("body"))
            return Loads()

    spin = []
    equations = derive(system("body", [body], parts=(Spin("spin"),)))
    c2, s2, c3, s3 = np.cos(a2), np.sin(a2), np.cos(a3), np.sin(a3)
    book = np.array([[c2 * c3, s3, 0.0], [-c2 * s3, c3, 0.0], [s2, 0.0, 1.0]])
    found = evaluate(equations, expression=spin[0])
    assert found == pytest.approx(book @ [1.1, -0.6, 0.8], rel=ALGEBRA)
