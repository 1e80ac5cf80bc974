"""Torque converters: tables, energy at random states, steady points, bad input."""

import numpy as np
import pytest
from system_texts import Motion, equations

from vehicledyn.base.errors import InputError

SYSTEM = """
title: Two flywheels with a torque converter between them
gravity: [0, 0, 0]
parameters: {drive: 0 N*m, load: 0 N*m}
bodies:
  pump: {joints: [R1 angle], mass: 5 kg, inertia: [0.3 kg*m^2, 0, 0]}
  shaft: {joints: [R1 angle], mass: 5 kg, inertia: [2 kg*m^2, 0, 0]}
forces:
  drive: {coordinate: pump.angle, force: drive}
  load: {coordinate: shaft.angle, force: -load}
elements:
  converter:
    kind: torque_converter
    pump: pump.angle
    turbine: shaft.angle
    ratio: 2.5
    speed_ratios: [0, 0.4, 0.8, 0.9, 1]
    torque_ratios: [2, 1.6, 1.1, 1, 1]
    capacities: [5e-3, 4.8e-3, 3.6e-3, 2e-3, 0]
"""
RATIOS, MORE = [0, 0.4, 0.8, 0.9, 1], [2, 1.6, 1.1, 1, 1]
CAPACITIES = [5e-3, 4.8e-3, 3.6e-3, 2e-3, 0]


@pytest.fixture(scope="module")
def motion(tmp_path_factory):
    return Motion(equations(tmp_path_factory.mktemp("converter"), SYSTEM))


def _by_hand(before, after):
    """Return torques of pump and turbine by the definitions."""
    if abs(before) >= abs(after):
        nu = after / before
        pump = np.interp(nu, RATIOS, CAPACITIES) * before * abs(before)
        gain = np.interp(nu, RATIOS, MORE)
        return pump, pump * (1.0 + (gain - 1.0) * (1.0 + min(nu, 0.0)))
    pump = -np.interp(before / after, RATIOS, CAPACITIES) * after * abs(after)
    return pump, pump


@pytest.mark.parametrize("seed", range(40))
def test_growth_of_energy_is_less_by_the_loss_and_never_more(motion, seed):
    draw = np.random.default_rng(seed)
    before, turn = (float(v) for v in draw.normal(scale=[200.0, 80.0]))
    seen = motion.at(pump__angle_rate=before, shaft__angle_rate=turn)
    pump, turbine = _by_hand(before, 2.5 * turn)
    assert seen["converter.pump_torque"] == pytest.approx(pump, rel=1e-9)
    assert seen["converter.turbine_torque"] == pytest.approx(turbine, rel=1e-9)
    growth = 0.3 * before * seen["d.pump.angle_rate"] + 2.0 * turn * seen["d.shaft.angle_rate"]
    size = abs(pump * before) + abs(turbine * 2.5 * turn)
    assert growth == pytest.approx(-seen["converter.loss"], abs=1e-9 * size)
    assert growth <= 1e-9 * size


def test_at_stall_the_turbine_has_the_stall_torque_ratio(motion):
    seen = motion.at(pump__angle_rate=200.0, shaft__angle_rate=0.0)
    assert seen["converter.pump_torque"] == pytest.approx(5e-3 * 200.0**2, rel=1e-9)
    assert seen["converter.turbine_torque"] == pytest.approx(2.0 * 5e-3 * 200.0**2, rel=1e-9)


def test_torques_are_continuous_where_the_shafts_change_places(motion):
    for turn in (200.0 / 2.5, -200.0 / 2.5):
        a, b = (motion.at(pump__angle_rate=200.0, shaft__angle_rate=turn * s)
                for s in (1.0 - 1e-9, 1.0 + 1e-9))  # fmt: skip
        for name in ("pump_torque", "turbine_torque"):
            assert a[f"converter.{name}"] == pytest.approx(b[f"converter.{name}"], abs=1e-4)


def test_nothing_divides_by_zero_at_standstill(motion):
    seen = motion.at(pump__angle_rate=0.0, shaft__angle_rate=0.0)
    assert seen["converter.pump_torque"] == seen["converter.loss"] == 0.0


def test_steady_points_are_those_of_the_closed_form(tmp_path):
    """A drive T at a load R(ν) T i turns the pump at √(T/λ) and the turbine at ν times that."""
    nu, drive = 0.6, 100.0
    load = drive * np.interp(nu, RATIOS, MORE) * 2.5
    text = SYSTEM.replace("drive: 0", f"drive: {drive}").replace("load: 0", f"load: {load}")
    speed = np.sqrt(drive / np.interp(nu, RATIOS, CAPACITIES))
    steady = Motion(equations(tmp_path, text))
    seen = steady.at(pump__angle_rate=speed, shaft__angle_rate=nu * speed / 2.5)
    assert seen["converter.speed_ratio"] == pytest.approx(nu, rel=1e-9)
    assert seen["d.pump.angle_rate"] == pytest.approx(0.0, abs=1e-9 * drive)
    assert seen["d.shaft.angle_rate"] == pytest.approx(0.0, abs=1e-9 * drive)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[0, 0.4, 0.8, 0.9, 1]", "[0, 0.4, 0.9, 0.8, 1]", "0.8 follows 0.9"),
        ("[0, 0.4, 0.8, 0.9, 1]", "[0, 0.4, 0.8, 0.9, 0.95]", "run from 0"),
        ("[2, 1.6, 1.1, 1, 1]", "[2, 1.6, 1.1, 1]", "5 speed ratios and 4 values of 'torque_ra"),
        ("[2, 1.6, 1.1, 1, 1]", "[2, 1.6, 1.3, 1, 1]", "efficiency of 1.04 at speed ratio 0.8"),
        # 1.98 at 0.5 and 1 at 1 lie below 1/ν, the line between them does not.
        ("[2, 1.6, 1.1, 1, 1]", "[2, 2, 1.25, 1.1, 1]", "at most 1 is possible"),
        ("3.6e-3, 2e-3, 0]", "3.6e-3, 2e-3, 1e-3]", "it must be 0"),
        ("[5e-3,", "[-5e-3,", "0 or more"),
        ("[5e-3,", "[.nan,", "finite"),
    ],
)
def test_tables_of_no_converter_are_refused(tmp_path, old, new, words):
    with pytest.raises(InputError, match=words):
        equations(tmp_path, SYSTEM.replace(old, new))
