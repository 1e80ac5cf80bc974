"""Friction of contacts that sticks, against closed forms: slopes, stick-slip, belts, rolling."""

import math

import numpy as np
import pytest

import vehicledyn as vd

STEPS = {"kind": "rk4", "step": "0.2 ms"}
STICKS = "stick_stiffness: 1e6 N/m, stick_damping: 2000 N*s/m"


def run(folder, text, duration, solver=STEPS):
    path = folder / "model.yaml"
    path.write_text(text)
    return vd.simulate(path, duration=duration, solver=solver, output={"interval": "5 ms"})


SLOPE = f"""
title: A box on a slope
bodies:
  box: {{joints: [T1 x, T2 y, T3 z], mass: 2 kg}}
elements:
  slope: {{kind: body_impact, body_a: ground, body_b: box, plane: {{normal: [0.6, 0, 0.8]}},
    ball: {{radius: 0.1 m}}, friction: FRICTION, {STICKS}}}
initial: {{box.x: 0.06 m, box.z: 0.08 m}}
"""


def test_a_box_rests_on_a_slope_for_ever(tmp_path):
    """It gives way by m g sin / k at once, and no more: tan α = 0.75 < μ = 1."""
    found = run(tmp_path, SLOPE.replace("FRICTION", "1"), "60 s")
    places = np.stack([found[f"box.{axis}"].values for axis in "xyz"])
    settled = places[:, 200:]
    assert np.ptp(settled, axis=1) == pytest.approx([0.0, 0.0, 0.0], abs=1e-13)
    given = np.array([0.06, 0.0, 0.08]) + 2 * 9.81 * 0.6 / 1e6 * np.array([0.8, 0.0, -0.6])
    assert settled[:, -1] == pytest.approx(given, abs=1e-9)
    assert found["slope.friction_force"].values[-1] == pytest.approx(2 * 9.81 * 0.6, rel=1e-9)


def test_a_box_slides_where_friction_does_not_suffice(tmp_path):
    found = run(tmp_path, SLOPE.replace("FRICTION", "0.5"), "0.5 s")
    speed = np.hypot(found["box.x_rate"].values, found["box.z_rate"].values)
    gained = (speed[-1] - speed[40]) / (found["time"].values[-1] - found["time"].values[40])
    assert gained == pytest.approx(9.81 * (0.6 - 0.5 * 0.8), rel=1e-9)
    assert found["slope.friction_force"].values[40:] == pytest.approx(2 * 9.81 * 0.8 * 0.5)


def test_sliding_across_a_slope_turns_downhill(tmp_path):
    """Friction opposes the motion: thrown across, a slope with μ = tan α ends at half the speed.

    The part of the speed downhill and the size of the speed have a constant sum (textbooks).
    """
    text = SLOPE.replace("FRICTION", "0.75").replace("initial: {", "initial: {box.y_rate: 2 m/s, ")
    found = run(tmp_path, text, "6 s")
    down = 0.8 * found["box.x_rate"].values - 0.6 * found["box.z_rate"].values
    speed = np.hypot(down, found["box.y_rate"].values)
    assert down + speed == pytest.approx(np.full(down.size, 2.0), abs=1e-2)
    assert speed[-1] == pytest.approx(1.0, abs=1e-2)
    assert found["box.y_rate"].values[-1] == pytest.approx(0.0, abs=0.1)


def test_a_spring_against_friction_stops_where_it_should(tmp_path):
    """Each swing loses 2 μ m g / k; it ends within μ m g / k of the middle."""
    found = run(
        tmp_path,
        f"""
title: A mass on a rough table
bodies:
  mass: {{joints: [T1 x, T3 z], mass: 1 kg}}
springs:
  coil: {{coordinate: mass.x, law: {{kind: spring_damper, stiffness: 100 N/m}}}}
elements:
  table: {{kind: body_impact, body_a: ground, body_b: mass, plane: {{}}, ball: {{radius: 0.1 m}},
    friction: 0.1, {STICKS}}}
initial: {{mass.x: 0.1 m, mass.z: 0.1 m}}
""",
        "3 s",
    )
    lost = 0.1 * 9.81 / 100.0
    place, time = found["mass.x"].values, found["time"].values
    swings = math.ceil((0.1 / lost - 1.0) / 2.0)
    end = (-1) ** swings * (0.1 - 2.0 * lost * swings)
    assert abs(end) < lost
    assert place[time > 0.2 + swings * math.pi / 10.0] == pytest.approx(end, abs=2e-5)
    turn = place[np.argmin(np.abs(time - math.pi / 10.0))]
    assert turn == pytest.approx(-(0.1 - 2.0 * lost), abs=2e-5)


@pytest.mark.parametrize("pull", [3.0, 5.0])
def test_a_box_on_a_belt(pull, tmp_path):
    """A belt that accelerates takes the box along up to μ g = 3.924 m/s², then slides away."""
    found = run(
        tmp_path,
        f"""
title: A box on a belt
bodies:
  belt: {{joints: [T1 x], mass: 100 kg}}
  box: {{joints: [T1 x, T3 z], mass: 1 kg}}
elements:
  carries: {{kind: body_impact, body_a: belt, body_b: box, plane: {{}}, ball: {{radius: 0.1 m}},
    friction: 0.4, {STICKS}}}
drives:
  belt: {{coordinate: belt.x, law: {{kind: expression, position: "{0.5 * pull} m/s^2 * time**2"}}}}
initial: {{box.z: 0.1 m}}
""",
        "1 s",
    )
    speed = found["box.x_rate"].values
    assert 2.0 * (speed[-1] - speed[-101]) == pytest.approx(min(pull, 0.4 * 9.81), rel=1e-6)


def test_a_ball_rolls_without_loss(tmp_path):
    """On a slope a = g sin / (1 + I / (m r²)), and no energy is lost to creep."""
    found = run(
        tmp_path,
        f"""
title: A ball rolls down a slope
bodies:
  ball: {{joints: [T1 x, T3 z, R2 spin], mass: 2 kg,
    inertia: [0.008 kg*m^2, 0.008 kg*m^2, 0.008 kg*m^2]}}
elements:
  slope: {{kind: body_impact, body_a: ground, body_b: ball, plane: {{normal: [0.6, 0, 0.8]}},
    ball: {{radius: 0.1 m}}, friction: 0.5, {STICKS}}}
initial: {{ball.x: 0.06 m, ball.z: 0.08 m}}
""",
        "1 s",
    )
    speed = np.hypot(found["ball.x_rate"].values, found["ball.z_rate"].values)
    gained = 2.0 * (speed[-1] - speed[-101])
    assert gained == pytest.approx(9.81 * 0.6 / 1.4, rel=1e-6)
    assert 0.1 * found["ball.spin_rate"].values[-1] == pytest.approx(speed[-1], rel=1e-5)
