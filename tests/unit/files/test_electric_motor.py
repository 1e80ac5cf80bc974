"""The electric motor as a part: limits of torque and power, recuperation, losses, energy."""

from pathlib import Path

import numpy as np
import pytest

from vehicledyn.files.building.construct import build_system
from vehicledyn.files.system.read import read_system
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive

PART = Path(__file__).parents[3] / "systems" / "electric_motor.yaml"


@pytest.fixture(scope="module")
def motor():
    model, problems = read_system(PART, {})
    assert not problems
    equations = derive(build_system(model))
    kernel = compile_kernel(equations, backend="interpreted")

    def at(speed, accelerator):
        given = {"propeller.angle_rate": speed, "accelerator.value": accelerator}
        x = np.array([given.get(s.name, s.start) for s in equations.states])
        z = np.array([u.start for u in equations.unknowns])
        names = [f"d.{s.name}" for s in equations.states]
        seen = dict(zip(names, kernel.rates(0.0, x, z), strict=True))
        channels = [c.name for c in equations.channels]
        return seen | dict(zip(channels, kernel.outputs(0.0, x, z), strict=True))

    return model.resolved, at


def test_torque_is_constant_and_then_the_power(motor):
    p, at = motor
    base = p["motor.power"] / p["motor.torque"]
    for speed in (1.5, 0.5 * base, 0.99 * base):
        assert at(speed, 1.0)["torque"] == pytest.approx(p["motor.torque"], rel=1e-12)
    for speed in (1.01 * base, 2.0 * base):
        assert at(speed, 1.0)["torque"] * speed == pytest.approx(p["motor.power"], rel=1e-12)
    assert at(p["motor.top_speed"], 1.0)["torque"] == 0.0
    assert at(100.0, 0.25)["torque"] == pytest.approx(0.25 * p["motor.torque"], rel=1e-12)
    half = 0.5 * p["recuperation.pedal"]
    braking = 0.5 * p["recuperation.overrun"] * p["recuperation.torque"]
    assert at(100.0, half)["torque"] == pytest.approx(half * p["motor.torque"] - braking)


def test_recuperation_keeps_its_limits_and_fades_at_standstill(motor):
    p, at = motor
    part, torque, power = (p[f"recuperation.{n}"] for n in ("overrun", "torque", "power"))
    assert at(200.0, 0.0)["torque"] == pytest.approx(-part * torque, rel=1e-12)
    assert at(800.0, 0.0)["torque"] * 800.0 == pytest.approx(-part * power, rel=1e-12)
    assert at(0.0, 0.0)["torque"] == 0.0
    assert at(-30.0, 0.0)["torque"] > 0.0
    assert at(200.0, 0.0)["battery_power"] < 0.0


@pytest.mark.parametrize("seed", range(6))
def test_the_battery_gives_what_the_shaft_gains_and_the_losses(motor, seed):
    p, at = motor
    draw = np.random.default_rng(seed)
    speed, accelerator = draw.uniform(-100.0, 1700.0), draw.uniform()
    seen = at(speed, accelerator)
    gained = p["flywheel.inertia"] * speed * seen["d.propeller.angle_rate"]
    lost = p["loss.copper"] * seen["torque"] ** 2 + p["loss.iron"] * abs(speed)
    lost += p["loss.windage"] * abs(speed) ** 3
    size = abs(gained) + lost
    assert seen["battery_power"] == pytest.approx(gained + lost, abs=1e-9 * size)
