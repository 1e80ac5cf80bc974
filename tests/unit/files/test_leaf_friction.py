"""Friction of leaf springs against its closed forms: reversals, loss a cycle, passivity."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from system_texts import Motion, equations, problems

LIMIT, BETA, AMPLITUDE, OMEGA = 900.0, 3e-3, 0.01, 2.0
SYSTEM = """
title: A leaf spring's friction that a drive works
gravity: [0, 0, 0]
bodies:
  axle: {joints: [{kind: T3, name: travel, role: independent}], mass: 3 kg}
  hub: {joints: [{kind: T3, name: travel, role: driven}], mass: 1 kg}
elements:
  free:
    kind: leaf_friction
    a: {body: ground, point: [0, 0, 1 m]}
    b: axle
    limit: 900 N
    transition: 3 mm
  friction:
    kind: leaf_friction
    a: {body: ground, point: [0, 0, 1 m]}
    b: hub
    direction: [0, 0, 1]
    limit: 900 N + 20 kN/m * hub.travel
    transition: 3 mm
drives:
  work: {coordinate: hub.travel, law: {kind: expression, position: "10 mm * cos(2 rad/s * time)"}}
"""


@pytest.fixture(scope="module")
def motion(tmp_path_factory):
    return Motion(equations(tmp_path_factory.mktemp("leaf"), SYSTEM))


@pytest.mark.parametrize("seed", range(6))
def test_power_is_growth_of_stored_energy_and_a_loss(motion, seed):
    """F L' = d(H β z²/2)/dt + H |L'| z², and it is what the axle loses."""
    draw = np.random.default_rng(seed)
    share, rate = float(draw.uniform(-1.0, 1.0)), float(draw.normal())
    seen = motion.at(0.3, free__share=share, axle__travel_rate=rate)
    stored = LIMIT * BETA * share * seen["d.free.share"]
    loss = LIMIT * abs(rate) * share**2
    kinetic = 3.0 * rate * seen["d.axle.travel_rate"]
    size = abs(stored) + loss + abs(kinetic)
    assert seen["free.force"] == pytest.approx(LIMIT * share, rel=1e-12)
    assert seen["free.power"] == pytest.approx(stored + loss, abs=1e-9 * size)
    assert kinetic + stored + loss == pytest.approx(0.0, abs=1e-9 * size)


def test_a_cycle_follows_the_exponentials_and_takes_its_energy(motion):
    """Between reversals z = ±1 + (z_0 ∓ 1) exp(-|ΔL|/β); a cycle takes 4 H (A - β tanh(A/β))."""
    equation = motion.equations
    place = [s.name for s in equation.states].index("friction.share")
    start = np.array([s.start for s in equation.states])
    channel = [c.name for c in equation.channels].index("friction.power")

    def slopes(time, values):
        state = start.copy()
        state[place] = values[0]
        nothing = np.empty(0)
        rate = motion.kernel.rates(time, state, nothing)[place]
        return rate, motion.kernel.outputs(time, state, nothing)[channel]

    share, half, losses = -np.tanh(AMPLITUDE / BETA), np.pi / OMEGA, []
    for k, side in enumerate((1.0, -1.0)):  # the hub falls and L grows, then it rises
        begun, span = share, (k * half, (k + 1) * half)
        at = [span[0] + 0.4, span[1]]
        found = solve_ivp(slopes, span, [begun, 0.0], rtol=1e-9, atol=1e-12, t_eval=at)
        way = AMPLITUDE * (1.0 - np.cos(OMEGA * 0.4))
        wanted = side + (begun - side) * np.exp(-way / BETA)
        assert found.y[0, 0] == pytest.approx(wanted, abs=1e-7)
        share = found.y[0, 1]
        assert share == pytest.approx(-begun, abs=1e-7)
        losses.append(found.y[1, 1])
    cycle = 4.0 * LIMIT * (AMPLITUDE - BETA * np.tanh(AMPLITUDE / BETA))
    assert sum(losses) == pytest.approx(cycle, rel=1e-6)


def test_transition_must_be_positive(tmp_path):
    text = SYSTEM.replace("transition: 3 mm", "transition: 0 mm", 1)
    assert any("elements.free.transition" in problem for problem in problems(tmp_path, text))
