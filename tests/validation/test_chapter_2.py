"""The mechanisms of chapter 2 of Samin and Fisette (2003), from their system files."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from reference_cases.hand_equations import EQUATIONS, G
from reference_cases.system_files import (
    FOLDER,
    TIGHT,
    Matrices,
    motion,
    parameters,
    ready,
    values_at_start,
)

from vehicledyn.files.building.construct import build_system
from vehicledyn.files.system.read import read_system
from vehicledyn.multibody import derive

pytestmark = pytest.mark.validation

ALGEBRA = 1e-12
# Accelerations solve a linear system whose condition is below a thousand.
SOLVED = 1e-10
MOTION = 1e-9
# Half width of the random coordinates [m, rad]; springs of 0.3 m must not turn over.
SPREAD = 0.25


@pytest.fixture(scope="module", params=EQUATIONS)
def case(request):
    matrices = Matrices(request.param)
    return matrices, EQUATIONS[request.param], parameters(matrices.prepared)


def close(found, wanted, share):
    scale = 1.0 + np.abs(wanted).max(initial=0.0)
    assert np.shape(found) == np.shape(wanted)
    assert np.abs(found - wanted).max(initial=0.0) < share * scale


@pytest.mark.parametrize("seed", range(5))
def test_equations_are_those_written_by_hand(case, seed):
    """Mass matrix, bias, Jacobian and quadratic term at random times, places and rates."""
    matrices, hand, p = case
    random = np.random.default_rng(seed)
    time, size = random.uniform(0.0, 3.0), len(matrices.names)
    q, v = matrices.start + SPREAD * random.uniform(-1.0, 1.0, size), random.normal(size=size)
    mass, bias, jacobian, quadratic = matrices.at(time, q, v)
    acting = np.abs(jacobian).max(axis=1, initial=0.0) > 0.0
    wanted = hand(p, time, q, v).in_file_coordinates()
    for found, value in zip((mass, bias, jacobian[acting], quadratic[acting]), wanted, strict=True):
        close(found, value, ALGEBRA)


@pytest.mark.parametrize("seed", range(5))
def test_accelerations_and_multipliers_are_those_written_by_hand(case, seed):
    matrices, hand, p = case
    time = 0.3 + 0.2 * seed
    q, v = matrices.consistent(seed, time)
    found, channels = matrices.solved(time, q, v)
    accelerations, multipliers = hand(p, time, q, v).solution()
    wanted = dict(zip(matrices.names, accelerations, strict=True))
    assert found
    for name, value in found.items():
        known = wanted[name.removesuffix("_rate")]
        assert value == pytest.approx(known, rel=SOLVED, abs=SOLVED * np.abs(accelerations).max())
    ends = (".multiplier", ".force_x", ".force_z", "_rolls.force")
    forces = [value for name, value in channels.items() if name.endswith(ends)]
    close(np.array(forces), multipliers, SOLVED)


def test_multiplier_of_the_slider_is_the_normal_force():
    """Moment of momentum of rod and slider about the crank pin, without any multiplier."""
    matrices = Matrices("slider_crank_two_angles")
    p = parameters(matrices.prepared)
    q, v = matrices.consistent(3, 0.0)
    accelerations, _ = EQUATIONS["slider_crank_two_angles"](p, 0.0, q, v).solution()
    crank, rod = q[0], q.sum()
    turned, tilted = accelerations[0], accelerations.sum()
    along = np.array([np.cos(crank), -np.sin(crank)])
    down = np.array([-np.sin(crank), -np.cos(crank)])
    pin = p["radius"] * (turned * down - v[0] ** 2 * along)
    across = np.array([-np.sin(rod), -np.cos(rod)])
    length = p["rod"]
    moment = (0.5 * p["coupler.mass"] + p["slider.mass"]) * length
    inertia = (p["coupler.mass"] / 3.0 + p["slider.mass"]) * length**2
    balance = moment * G * np.cos(rod) - inertia * tilted - moment * pin @ across
    _, channels = matrices.solved(0.0, q, v)
    assert channels["guide.multiplier"] == pytest.approx(balance / (length * np.cos(rod)), rel=1e-9)


@pytest.mark.parametrize("stiffness", [0.0, 1.7, 9.0])
def test_ball_in_the_tube_obeys_equation_2_59(stiffness):
    prepared = ready("ball_in_tube", f"parameters.stiffness={stiffness} N/m")
    p = parameters(prepared)
    state = dict(zip(("ball.place", "ball.place_rate"), (0.41, -0.23), strict=True))
    x = np.array([state[s.name] for s in prepared.equations.states])
    rates = prepared.kernel.rates(0.9, x, [])
    wanted = p["rate"] ** 2 * 0.41 - stiffness / p["mass"] * 0.41
    assert rates[1] == pytest.approx(wanted, rel=ALGEBRA, abs=ALGEBRA)
    outputs = prepared.kernel.outputs(0.9, x, [])
    names = [c.name for c in prepared.equations.channels]
    torque = 2.0 * p["mass"] * p["rate"] * 0.41 * -0.23
    assert outputs[names.index("tube.turn_force")] == pytest.approx(torque, rel=ALGEBRA)


def test_free_ball_leaves_the_tube_as_a_hyperbola():
    """With k = 0: q = q0 cosh ωt + (q0'/ω) sinh ωt, in one and in two coordinates."""
    for name, place in (("ball_in_tube", "ball.place"), ("ball_in_tube_dependent", "place")):
        run = motion(name, *TIGHT)
        turn = 2.0 * run.time
        wanted = 0.3 * np.cosh(turn) - 0.1 * np.sinh(turn)
        assert run[place] == pytest.approx(wanted, rel=MOTION), name


def test_wall_of_the_tube_pushes_with_twice_the_coriolis_rate():
    """The multiplier of 2.60 is the force across the tube, 2 m ω q'."""
    run = motion("ball_in_tube_dependent", *TIGHT)
    turn = 2.0 * run.time
    rate = 0.6 * np.sinh(turn) - 0.2 * np.cosh(turn)
    assert run["tube.multiplier"] == pytest.approx(2.0 * 0.7 * 2.0 * rate, rel=MOTION, abs=MOTION)


@pytest.mark.parametrize("seed", range(3))
def test_pendulum_on_rollers_obeys_equation_2_45(seed):
    matrices = Matrices("roller_pendulum")
    p = parameters(matrices.prepared)
    q, v = matrices.consistent(seed, 0.0)
    found, channels = matrices.solved(0.0, q, v)
    big, rod, m, b = (
        p[k] for k in ("pendulum.mass", "pendulum.length", "roller.mass", "roller.arm")
    )
    pull = G * (big * rod + 2.0 * m * b * np.cos(p["roller.angle"])) * np.sin(q[0])
    turned = -pull / (big * rod**2 + 3.0 * m * b**2)
    # The roller's equation: the ring pushes with half of its mass times the acceleration.
    for name in ("roller_2_rolls", "roller_3_rolls"):
        assert channels[f"{name}.multiplier"] == pytest.approx(-0.5 * m * b * turned, rel=SOLVED)
    assert found["pendulum.angle_rate"] == pytest.approx(turned, rel=SOLVED)


PINNED = """
title: The same, with the rollers held by pins
parameters: {arm: 0.8 m, tilt: 35 deg, mass: 0.6 kg, radius: 0.1 m}
bodies:
  pendulum: {joints: [{kind: R2, name: angle, role: independent}], mass: 3 kg, com: [0, 0, -0.5 m]}
repeat:
  - for: {k: {from: 2, to: 3}}
    bodies:
      "roller_{k}":
        joints: [T1 x, T3 z, R2 angle]
        mass: mass
        inertia: [mass * radius**2 / 4, mass * radius**2 / 2, mass * radius**2 / 4]
    cuts:
      "pin_{k}":
        kind: ball
        a:
          body: pendulum
          point: ["(2 * {k} - 5) * arm * sin(tilt)", 0, -arm * cos(tilt)]
        b: "roller_{k}"
    constraints:
      "rolls_{k}":
        kind: rate_expression
        zero: >-
          -cos(pendulum.angle + (5 - 2 * {k}) * tilt) * roller_{k}.x_rate
          + sin(pendulum.angle + (5 - 2 * {k}) * tilt) * roller_{k}.z_rate
          + radius * roller_{k}.angle_rate
initial: {pendulum.angle: 0.5 rad, pendulum.angle_rate: 1.1 rad/s}
"""


def test_force_in_the_axle_of_a_roller_is_equation_2_46(tmp_path):
    """S = -3/2 m b φ'' - m g sin(φ + α), the force of roller 2 on the pendulum along its path.

    The ring pushes the roller, so its place against the ring is what may not slip here.
    """
    path = tmp_path / "pinned.yaml"
    path.write_text(PINNED, encoding="utf-8")
    model, problems = read_system(path)
    assert not problems
    equations = derive(build_system(model))
    rates, channels = values_at_start(equations)
    angle, alpha, m, b = 0.5, np.deg2rad(35.0), 0.6, 0.8
    turned = -G * (3.0 * 0.5 + 2.0 * m * b * np.cos(alpha)) * np.sin(angle)
    turned /= 3.0 * 0.5**2 + 3.0 * m * b**2
    assert rates["pendulum.angle_rate"] == pytest.approx(turned, rel=SOLVED)
    place = angle + alpha
    onto_roller = np.array([channels["pin_2.force_x"], channels["pin_2.force_z"]])
    path_direction = np.array([-np.cos(place), np.sin(place)])
    wanted = -1.5 * m * b * turned - m * G * np.sin(place)
    assert -onto_roller @ path_direction == pytest.approx(wanted, rel=SOLVED)


def test_parallelogram_has_rank_one_in_its_singular_configuration():
    matrices = Matrices("parallelogram")
    _, _, jacobian, _ = matrices.at(0.0, np.zeros(3), np.zeros(3))
    assert np.linalg.matrix_rank(jacobian, tol=ALGEBRA) == 1
    _, _, jacobian, _ = matrices.at(0.0, matrices.start, np.zeros(3))
    assert np.linalg.matrix_rank(jacobian, tol=1e-3) == 2


def test_parallelogram_in_one_line_is_refused_and_named():
    flat = [f"initial.{name}.angle=0 deg" for name in ("first_crank", "coupler", "second_crank")]
    program = Path(sys.executable).parent / "vehicledyn"
    sets = [word for item in flat for word in ("--set", item)]
    done = subprocess.run(
        [program, "equilibrium", FOLDER / "parallelogram.yaml", *sets],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    assert "singular" in done.stderr
    assert "'C'" in done.stderr
    assert "undetermined" in done.stderr


def test_parallelogram_swings_as_one_pendulum():
    """The coupler never turns; both cranks are one pendulum (m/3 · 2 + n) d² φ'' = ..."""
    run = motion("parallelogram", *TIGHT)
    angle, rate = run["first_crank.angle"], run["first_crank.angle_rate"]
    assert run["second_crank.angle"] == pytest.approx(angle, abs=MOTION)
    assert run["coupler.angle"] == pytest.approx(-angle, abs=MOTION)
    energy = 0.5 * (2.0 / 3.0 + 2.0) * 0.4**2 * rate**2 - (1.0 + 2.0) * G * 0.4 * np.sin(angle)
    assert np.ptp(angle) > 1.0
    assert energy == pytest.approx(energy[0], abs=1e-9)


def test_upright_disk_rolls_without_slip():
    run = motion("upright_disk", *TIGHT)
    heading = run["fork.heading"]
    forward = -run["fork.x_rate"] * np.sin(heading) + run["fork.y_rate"] * np.cos(heading)
    assert forward == pytest.approx(-0.5 * run["disk.spin_rate"], abs=1e-12)
    # Spin and heading are two freedoms that know nothing of each other.
    inertia = 0.5 * 0.5**2 + 0.5**2
    wanted = -2.0 - 1.0 / inertia * (1.0 - np.exp(-run.time))
    assert run["disk.spin_rate"] == pytest.approx(wanted, abs=MOTION)
    turned = 0.05 / (0.25 * 0.5**2) / 2.0 * (1.0 - np.cos(2.0 * run.time))
    assert run["fork.heading_rate"] == pytest.approx(turned, abs=MOTION)
