"""Contacts of bodies against closed forms: bounces, collisions, friction, a ball in a cage."""

import math

import numpy as np
import pytest

import vehicledyn as vd

EVENTS = {"kind": "dop853", "relative_tolerance": 1e-10, "absolute_tolerance": 1e-12}


def run(folder, text, duration, solver=EVENTS, backend="interpreted"):
    path = folder / "model.yaml"
    path.write_text(text)
    return vd.simulate(
        path, duration=duration, solver=solver, output={"interval": "5 ms"}, backend=backend
    )


BALL = """
title: A ball
bodies:
  ball: {joints: [T1 x, T3 z], mass: 2 kg, inertia: [0.1 kg*m^2, 0.1 kg*m^2, 0.1 kg*m^2]}
elements:
  ground: {kind: body_impact, body_a: ground, body_b: ball, plane: {}, ball: {radius: 0.1 m},
    touching: false, restitution: 0.8}
initial: {ball.z: 1.1 m, ball.x_rate: 1 m/s}
"""


def test_bounces_on_a_plane(tmp_path):
    found = run(tmp_path, BALL, "2 s")
    hits = [e.time for e in found.events]
    first = math.sqrt(2.0 / 9.81)
    flights = first * (1.0 + 2.0 * np.cumsum(0.8 ** np.arange(len(hits))) - 2.0)
    assert len(hits) == 3
    assert hits == pytest.approx([first, *(flights[1:])], rel=1e-8)


TWO = """
title: Two balls
gravity: [0, 0, 0]
bodies:
  a: {joints: [T1 x, T2 y], mass: 1 kg}
  b: {joints: [T1 x, T2 y], mass: 3 kg}
elements:
  hit: {kind: body_impact, body_a: a, body_b: b, capsule: {radius: 0.1 m}, ball: {radius: 0.2 m},
    touching: false, restitution: 0.5}
initial: {a.x_rate: 2 m/s, b.x: 1 m, b.y: 0.1 m}
"""


def test_balls_collide(tmp_path):
    """Along the line of centres the speeds change as Newton says; momentum and energy follow."""
    found = run(tmp_path, TWO, "1 s")
    sine = 0.1 / 0.3
    cosine = math.sqrt(1 - sine**2)
    assert found.events[0].time == pytest.approx((1.0 - 0.3 * cosine) / 2.0, rel=1e-9)
    pushed = 1.5 * 2.0 * cosine * 1.0 * 3.0 / 4.0  # (1 + e) v m_a m_b / (m_a + m_b)
    assert found["b.x_rate"].values[-1] == pytest.approx(pushed / 3 * cosine, rel=1e-9)
    assert found["b.y_rate"].values[-1] == pytest.approx(pushed / 3 * sine, rel=1e-9)
    assert found["a.x_rate"].values[-1] == pytest.approx(2.0 - pushed * cosine, rel=1e-9)
    assert found["a.y_rate"].values[-1] == pytest.approx(-pushed * sine, rel=1e-9)


SLOPE = """
title: A ball on a slope
bodies:
  ball: {joints: [T1 x, T3 z, R2 spin], mass: 2 kg, inertia: [0.008 kg*m^2, 0.008 kg*m^2,
        0.008 kg*m^2]}
elements:
  slope: {kind: body_impact, body_a: ground, body_b: ball, plane: {normal: [0.6, 0, 0.8]},
    ball: {radius: 0.1 m}, friction: FRICTION, creep_speed: 1e-4 m/s}
initial: {ball.x: 0.06 m, ball.z: 0.08 m}
"""


@pytest.mark.parametrize("friction", [0.1, 0.5])
def test_a_ball_slides_or_rolls_down_a_slope(friction, tmp_path):
    """It rolls, a = g sin / (1 + I / (m r²)), where friction suffices, else a = g (sin - μ cos)."""
    steps = {"kind": "rk4", "step": "20 us" if friction < 0.2 else "5 us"}
    found = run(tmp_path, SLOPE.replace("FRICTION", str(friction)), "0.2 s", steps, "auto")
    rolls = 9.81 * 0.6 / (1 + 0.008 / (2 * 0.01))
    slides = 9.81 * (0.6 - friction * 0.8)
    speed = np.hypot(found["ball.x_rate"].values[-1], found["ball.z_rate"].values[-1])
    assert speed == pytest.approx(0.2 * max(rolls, slides), rel=2e-3)
    assert found["slope.normal_force"].values == pytest.approx(
        np.full(41, 2 * 9.81 * 0.8), rel=1e-6
    )


CAGE = """
title: A ball in a cage
gravity: [0, 0, 0]
bodies:
  ball: {joints: [T1 x, T3 z], mass: 1 kg}
elements:
  cage: {kind: body_impact, body_a: ground, body_b: ball, touching: false, restitution: 1,
    polygon: {first: [-1, 1, 1, -1], second: [-0.5, -0.5, 0.5, 0.5], encloses: true},
    ball: {radius: 0.1 m}}
initial: {ball.x_rate: 0.3 m/s, ball.z_rate: 2 m/s}
"""


def test_a_ball_stays_in_its_cage(tmp_path):
    """Elastic walls fold the straight path; axis 2 sees z as its first direction, x as second."""
    found = run(tmp_path, CAGE, "2 s")
    z = 2.0 * found["time"].values
    folded = np.abs(np.mod(z + 0.9, 3.6) - 1.8) - 0.9
    assert np.abs(found["ball.z"].values) == pytest.approx(np.abs(folded), abs=1e-8)
    energy = found["energy.kinetic"].values
    assert energy == pytest.approx(np.full(energy.size, energy[0]), rel=1e-9)


CAPSULES = """
title: Two capsules that cross
gravity: [0, 0, 0]
bodies:
  a: {joints: [T3 z], mass: 1 kg}
elements:
  rest: {kind: body_contact, body_a: ground, body_b: a, stiffness: 1e4, exponent: 1,
    capsule: {centre: [-1 m, 0, 0], far_centre: [1 m, 0, 0], radius: 0.1 m},
    ball: {centre: [0.2 m, -1 m, 0], far_centre: [0.2 m, 1 m, 0], radius: 0.2 m}}
initial: {a.z: 0.29 m}
"""


def test_crossed_capsules_push_each_other_as_springs(tmp_path):
    found = run(tmp_path, CAPSULES, "10 ms")
    w = 100.0
    time = found["time"].values
    assert found["a.z"].values == pytest.approx(0.3 - 0.01 * np.cos(w * time), abs=1e-9)
    assert found["rest.gap"].values == pytest.approx(-0.01 * np.cos(w * time), abs=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("plane: {}, ", "", "give one of plane, capsule and polygon"),
        ("plane: {}, ", "polygon: {first: [0, 1], second: [0, 0]}, ", "2 and 2 corners"),
        ("plane: {}, ", "polygon: {first: [0, 0, 1], second: [0, 1, 0]}, ", "not convex, or not"),
    ],
)
def test_shapes_that_cannot_be_are_refused(old, new, words, tmp_path):
    with pytest.raises(vd.InputError, match=words):
        run(tmp_path, BALL.replace(old, new), "0.1 s")
