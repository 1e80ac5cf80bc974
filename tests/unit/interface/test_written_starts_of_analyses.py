"""Start values written as expressions move what kinematics and linear analyses find."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd

ROOT = Path(__file__).parents[3]

CRANK = """\
title: A four-bar whose rocker stands on a slide that a driven coordinate bears
parameters:
  r: {value: 50 mm}
  l: {value: 150 mm}
  s: {value: 70 mm}
  h: {value: 20 mm}
  k: {value: 30 mm}
bodies:
  crank: {joints: [{kind: R2, name: angle, start: 40 deg}], mass: 1 kg}
  coupler: {parent: crank, at: [r, 0, 0], joints: [{kind: R2, name: angle, start: -55 deg}]}
  post:
    joints:
      - {kind: T3, name: height, role: independent, start: h**2 / s}
      - {kind: T3, name: lift, role: driven}
  slider: {parent: post, joints: [{kind: T1, name: position, start: r + l}], mass: 0.4 kg}
  flag: {parent: slider, joints: [{kind: T2, name: side, start: 2*h}], mass: 0.1 kg}
cuts:
  pin: {kind: ball, a: {body: coupler, point: [l, 0, 0]}, b: slider}
drives:
  up: {coordinate: post.lift, law: {kind: expression, position: k * cos(time * 1 rad/s)}}
sensors:
  end: {kind: point, body: flag}
"""


def test_coordinates_that_are_not_driven_follow_what_they_are_written_as(tmp_path):
    """The slider's place is r cos φ + √(l² - (r sin φ + z)²), z = h² / s + k."""
    path = tmp_path / "crank.yaml"
    path.write_text(CRANK, encoding="utf-8")
    of = [f"kinematics(end.{c}, crank.angle, 10 deg:90 deg:2)" for c in "xyz"]
    found = vd.sensitivity(path, of, ["r", "l", "s", "h", "k"])

    def place(angle, r, length, s, h, k):
        z = h * h / s + k
        reach = np.sqrt(length**2 - (z + r * np.sin(angle)) ** 2)
        return np.array([r * np.cos(angle) + reach, 2.0 * h, z])

    values = np.array([0.05, 0.15, 0.07, 0.02, 0.03])
    for number, angle in enumerate(np.radians([10.0, 50.0, 90.0])):
        own = slice(number, None, 3)
        assert found["figure_value"].values[own] == pytest.approx(place(angle, *values), rel=1e-9)
        exact = [place(angle, *(values + step)).imag / 1e-30 for step in 1e-30j * np.eye(5)]
        assert found["figure_slope"].values[own] == pytest.approx(np.array(exact).T, abs=1e-9)


PENDULUM = """\
title: A pendulum held aside by a torque that its start is written by
parameters: {l: {value: 0.4 m}, a: {value: 0.6 rad}, b: {value: 1.5}}
bodies:
  arm: {joints: [{kind: R2, name: angle, start: a * b**2}], mass: 2 kg, com: [0, 0, -l]}
"""


@pytest.fixture
def held(tmp_path):
    """Return a scenario that starts a pendulum aside, not in equilibrium."""
    (tmp_path / "pendulum.yaml").write_text(PENDULUM, encoding="utf-8")
    path = tmp_path / "held.yaml"
    path.write_text(
        "title: Held aside\nmodel: pendulum.yaml\nduration: 1 s\nstart: nominal\n"
        "solver: {kind: rk4, step: 1 ms}\noutput: {interval: 10 ms}\n",
        encoding="utf-8",
    )
    return path


def test_eigenvalues_about_a_written_start_follow_it(held):
    """ω² = g cos(a b²) / l, the frequency ω / 2π."""
    found = vd.sensitivity(held, "eigenvalues", ["l", "a", "b"])

    def frequency(length, a, b):
        return np.sqrt(9.81 * np.cos(a * b * b) / length) / (2.0 * np.pi)

    exact = [frequency(*(np.array([0.4, 0.6, 1.5]) + s)).imag / 1e-30 for s in 1e-30j * np.eye(3)]
    assert list(found["figure"].values) == [
        f"mode_1.{name}" for name in ("growth", "frequency", "undamped_frequency", "damping_ratio")
    ]
    assert found["figure_slope"].values[1] == pytest.approx(exact, rel=1e-10)


def test_responses_about_a_written_start_follow_it(held):
    """H = 1 / (m l² (ω² - Ω²)) of the angle to a torque."""
    found = vd.sensitivity(held, "gain(arm.angle, force:arm.angle, 0.1 Hz)", ["l", "a", "b"])

    def gain(length, a, b):
        rate = 9.81 * np.cos(a * b * b) / length - (0.2 * np.pi) ** 2
        return 1.0 / (2.0 * length**2 * rate)

    exact = [gain(*(np.array([0.4, 0.6, 1.5]) + s)).imag / 1e-30 for s in 1e-30j * np.eye(3)]
    assert found["figure_slope"].values[0] == pytest.approx(exact, rel=1e-9)


def test_a_bicycle_that_is_given_its_speed_follows_it():
    """Of the benchmark's matrices: M q̈ + v C q̇ + (g K + v² L) q = 0, Meijaard et al. 2007."""
    mass = np.array([[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]])
    damping = np.array([[0.0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]])
    heavy = np.array([[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]])
    fast = np.array([[0.0, 76.59734589573222], [0.0, 2.65431523794604]])

    def matrix(speed):
        stiffness = 9.81 * heavy + speed**2 * fast
        below = np.hstack([stiffness, speed * damping])
        above = np.hstack([np.zeros((2, 2)), np.eye(2)])
        return np.vstack([above, -np.linalg.solve(mass, below)])

    values, right = np.linalg.eig(matrix(5.0))
    moved = (matrix(5.0 + 1e-4) - matrix(5.0 - 1e-4)) / 2e-4  # exact: quadratic in the speed
    slopes = np.diag(np.linalg.solve(right, moved @ right))
    order = np.argsort(-values.real)
    kept = [k for k in order if values[k].imag >= 0.0]
    found = vd.sensitivity("bicycle", "eigenvalues", "forward_speed")
    wanted = [(values[k], slopes[k]) for k in kept]
    expected = []
    for value, slope in wanted:
        expected.append(slope.real)
        if value.imag:
            along = value.conjugate() * slope
            expected += [slope.imag / (2.0 * np.pi), along.real / abs(value) / (2.0 * np.pi)]
            expected.append(value.imag * along.imag / abs(value) ** 3)
    assert found["figure_slope"].values[:, 0] == pytest.approx(expected, rel=1e-8)


HILL = """\
title: A slide that is held where it is written, on a spring that hardens
parameters: {a: {value: 0.3 m}, k: {value: 4 kN/m^2}}
bodies:
  cart: {joints: [{kind: T1, name: x, role: driven, start: a}], mass: 1 kg}
  ball: {parent: cart, joints: [{kind: T3, name: z, start: -1 mm}], mass: 2 kg}
forces:
  hill: {coordinate: ball.z, force: -k * cart.x * position}
"""


def test_an_equilibrium_follows_what_is_held(tmp_path):
    """Z = -m g / (k a) of a driven coordinate that nothing drives, a is where it starts."""
    path = tmp_path / "hill.yaml"
    path.write_text(HILL, encoding="utf-8")
    found = vd.sensitivity(path, "equilibrium.ball.z", ["a", "k"])
    sag = -2.0 * 9.81 / (4000.0 * 0.3)
    assert found["figure_value"].values == pytest.approx([sag], rel=1e-10)
    assert found["figure_slope"].values[0] == pytest.approx([-sag / 0.3, -sag / 4000.0], rel=1e-10)


@pytest.fixture
def aside(tmp_path):
    """Return a scenario of a car whose place and heading on the road parameters write."""
    text = (ROOT / "systems" / "small_car.yaml").read_text(encoding="utf-8")
    head, _ = text.split("initial:")
    head = head.replace("parameters:\n", "parameters:\n  a: {value: 0.05 rad}\n  b: {value: 3 m}\n")
    (tmp_path / "car.yaml").write_text(
        head + "initial: {chassis.z: body.height, chassis.yaw: 20 * a**2, chassis.y: a * b}\n",
        encoding="utf-8",
    )
    path = tmp_path / "straight.yaml"
    path.write_text(
        "title: Straight\nmodel: car.yaml\nmanoeuvre: {kind: straight}\nwheel_spin: free\n"
        "speed: 10 m/s\nduration: 50 ms\nsolver: {kind: rk4, step: 1 ms}\n"
        "output: {interval: 10 ms}\n",
        encoding="utf-8",
    )
    return path


@pytest.mark.long
@pytest.mark.parametrize("kind", ["static", "steady"])
def test_a_vehicle_in_balance_follows_where_it_is_written_to_stand(aside, kind):
    """What no balance finds moves as written; what follows agrees with differences of runs."""
    of = ["initial(chassis.yaw)", "initial(chassis.y)", "final(chassis.y)", "final(chassis.roll)"]

    def figures(a, **more):
        changed = {"parameters.a": f"{a!r} rad"}
        return vd.sensitivity(aside, of, ["a", "b"], start=kind, set=changed, **more)

    found = figures(0.05, along={"a": 1.0})
    slopes, bends = found["figure_slope"].values, found["figure_curvature"].values
    assert slopes[:2] == pytest.approx(np.array([[2.0, 0.0], [3.0, 0.05]]), rel=1e-9, abs=1e-12)
    assert bends[:2] == pytest.approx(np.array([[40.0, 0.0], [0.0, 1.0]]), rel=1e-9, abs=1e-12)
    low, high = (figures(0.05 + step) for step in (-1e-5, 1e-5))
    for name, exact in (("figure_value", slopes[:, 0]), ("figure_slope", bends)):
        differences = (high[name].values - low[name].values) / 2e-5
        assert exact == pytest.approx(differences, rel=1e-6, abs=1e-7)
