"""The motorcycle without its rider, held up by him, and leaning into a steady turn."""

import numpy as np
import pytest
from reference_cases.motorcycle import GRAVITY, HEIGHT, MASS, SCENARIO, linear, modes

import vehicledyn as vd

pytestmark = [pytest.mark.validation, pytest.mark.long]


@pytest.mark.parametrize("speed", [10.0, 20.0, 40.0])
def test_weave_wobble_and_capsize_without_the_rider(speed):
    found = modes(speed)
    wanted = [v for v in linear(speed) if abs(v) > 1e-6 and v.imag >= 0.0]
    for value in wanted:
        assert np.abs(found - value).min() < 1e-3 * abs(value) + 2e-3, value


def test_the_rider_steers_into_the_fall_and_holds_the_motorcycle_up():
    """Without the rider it capsizes at 20 m/s; the gains of the file make every mode decay."""
    assert linear(20.0).real.max() > 0.05
    held = linear(20.0, 100.0, 5.0)
    found = modes(20.0, roll="100 N*m/rad", rate="5 N*m*s/rad")
    for value in held[(np.abs(held) > 1e-6) & (held.imag >= 0.0)]:
        assert value.real < -1.0
        assert np.abs(found - value).min() < 1e-3 * abs(value) + 2e-3, value


def test_a_steady_turn_takes_its_lean():
    """Moments about the line of contact: m g h tan φ = v r (m h + Σ I/R), with the wheels' spin."""
    run = vd.simulate(SCENARIO)
    roll, turn = (float(np.asarray(run[f"frame.{n}"])[-1]) for n in ("roll", "yaw_rate"))
    along, across = (float(np.asarray(run[f"frame.{n}_rate"])[-1]) for n in "xy")
    spin = 0.8 / 0.299 + 0.6 / 0.294
    speed = np.hypot(along, across)
    assert roll > 0.1
    moment = MASS * HEIGHT + spin
    assert np.tan(roll) == pytest.approx(
        -turn * speed * moment / (GRAVITY * MASS * HEIGHT), rel=2e-2
    )
