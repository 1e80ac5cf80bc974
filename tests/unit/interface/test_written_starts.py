"""Start values written as expressions of parameters follow these in every study."""

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import InputError

pytestmark = pytest.mark.usefixtures("needs_compiler")

SYSTEM = """\
title: A ball is thrown
parameters:
  height: {value: 0.5 m}
  pace: {value: 2 m/s}
  far: {value: 0.3 m}
bodies:
  ball:
    joints:
      - {kind: T1, name: x, start: far}
      - {kind: T3, name: z, start: height}
    mass: 0.3 kg
initial: {ball.z_rate: pace**2 / (1 m/s), ball.x: 0.2 m}
"""
SCENARIO = """\
title: A ball is thrown
model: ball.yaml
duration: 0.2 s
solver: {kind: rk4, step: 10 ms}
output: {interval: 10 ms}
"""


@pytest.fixture
def run(tmp_path):
    """Return the scenario of a ball whose height and pace at the start are parameters."""
    (tmp_path / "ball.yaml").write_text(SYSTEM, encoding="utf-8")
    path = tmp_path / "run.yaml"
    path.write_text(SCENARIO, encoding="utf-8")
    return path


def test_the_start_moves_with_parameters(run):
    """By height, pace and a place that ``initial`` overrides, z = h + p² t - g t² / 2."""
    found = vd.sensitivity(run, ["final(ball.z)", "final(ball.x)"], ["height", "pace", "far"])
    slopes = dict(zip(found["parameter"].values, found["figure_slope"].values.T, strict=True))
    assert slopes["height"] == pytest.approx([1.0, 0.0], abs=1e-12)
    assert slopes["pace"] == pytest.approx([2.0 * 2.0 * 0.2, 0.0], rel=1e-12)
    assert slopes["far"] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_a_start_given_to_the_scenario_stays(run):
    """It is written in place of the model's."""
    given = {"initial.ball.z": "0.4 m"}
    found = vd.sensitivity(run, "final(ball.z)", ["height", "pace"], set=given)
    assert found["figure_slope"].values[0] == pytest.approx([0.0, 0.8], abs=1e-12)


def test_second_derivatives_know_bent_starts(run):
    """d²z/dp² = 2 t."""
    found = vd.sensitivity(run, "final(ball.z)", ["height", "pace"], along={"pace": 1.0})
    assert found["figure_curvature"].values[0] == pytest.approx([0.0, 0.4], abs=1e-12)


def test_samples_of_studies_start_anew(run):
    """The deviation of a height at the start is that of all heights."""
    laws = {"height": {"kind": "normal", "mean": "0.5 m", "deviation": "10 mm"}}
    of = run, "final(ball.z)", laws
    sampled = vd.uncertainty(*of, method="sequence", number=32).found.deviation
    assert vd.uncertainty(*of, method="first_order").found.deviation == pytest.approx([0.01])
    assert sampled == pytest.approx([0.01], rel=0.2)


CRANK = """\
title: A slider-crank given the speed of its slider
parameters:
  r: {value: 50 mm}
  l: {value: 150 mm}
  v: {value: 2 m/s}
bodies:
  crank:
    joints: [{kind: R2, name: angle, role: independent, start: 40 deg}]
    mass: 1 kg
    inertia: [0, 4e-3 kg*m^2, 0]
  coupler: {parent: crank, at: [r, 0, 0], joints: [{kind: R2, name: angle, start: -55 deg}]}
  slider: {joints: [{kind: T1, name: position, start: r + l}], mass: 0.4 kg}
cuts:
  pin: {kind: ball, a: {body: coupler, point: [l, 0, 0]}, b: slider}
initial: {slider.position_rate: -v}
"""


@pytest.fixture
def turn(tmp_path):
    """Return the scenario of a crank that turns as the rate of its slider wants."""
    (tmp_path / "crank.yaml").write_text(CRANK, encoding="utf-8")
    path = tmp_path / "turn.yaml"
    path.write_text(SCENARIO.replace("ball.yaml", "crank.yaml"), encoding="utf-8")
    return path


def test_rates_given_to_dependent_coordinates_move_independent_ones(turn):
    """The crank's rate is v / (r sin φ + r² sin φ cos φ / q), q² = l² - r² sin² φ."""

    def rate(r, length, v):
        s, c = np.sin(np.radians(40.0)), np.cos(np.radians(40.0))
        return v / (r * s + r * r * s * c / np.sqrt(length**2 - (r * s) ** 2))

    found = vd.sensitivity(turn, "initial(crank.angle_rate)", ["r", "l", "v"], duration="20 ms")
    steps = 1e-30j * np.eye(3)
    exact = [rate(*(np.array([0.05, 0.15, 2.0]) + step)).imag / 1e-30 for step in steps]
    assert found["figure_slope"].values[0] == pytest.approx(exact, rel=1e-10)


def test_second_derivatives_refuse_rates_given_to_dependent_coordinates(turn):
    """They would leave out how the start bends."""
    with pytest.raises(InputError, match=r"rate of 'slider\.position'"):
        vd.sensitivity(turn, "final(crank.angle)", "r", along={"r": 1.0}, duration="20 ms")


LINE = """\
title: A ball on a line through the origin, which it is put on
parameters: {m: {value: 0.4}, far: {value: 0.3 m}}
bodies: {ball: {joints: [{kind: T1, name: x, start: far}, T2 y], mass: 1 kg}}
constraints: {line: {kind: expression, zero: ball.y - m * ball.x}}
"""


@pytest.mark.long
def test_a_start_moves_with_the_loops(tmp_path):
    """The point of y = m x nearest to (f, 0): x = f / (1 + m²); runs, sweeps and derivatives."""
    path = tmp_path / "run.yaml"
    path.write_text(SCENARIO.replace("title: A ball", "title: Another ball"), encoding="utf-8")
    (tmp_path / "ball.yaml").write_text(LINE, encoding="utf-8")
    found = vd.sensitivity(path, "initial(ball.x)", ["m", "far"])
    m, f = 0.4, 0.3
    exact = [-2.0 * f * m / (1.0 + m**2) ** 2, 1.0 / (1.0 + m**2)]
    assert found["figure_value"].values[0] == pytest.approx(f / (1.0 + m**2), rel=1e-12)
    assert found["figure_slope"].values[0] == pytest.approx(exact, rel=1e-9)
    assert not any("warning" in note for note in found.notes)
    starts = vd.sweep(path, vary={"m": [0.4, 0.6]}, workers=1)["ball.x"].values[:, 0]
    assert starts == pytest.approx([f / (1.0 + m**2), f / (1.0 + 0.6**2)], rel=1e-12)
    with pytest.raises(InputError, match=r"'ball\.x' moves with the loops"):
        vd.sensitivity(path, "final(ball.x)", "m", along={"m": 1.0})
