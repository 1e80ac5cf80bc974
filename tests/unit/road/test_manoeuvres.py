"""Every manoeuvre, driver and relaxation of the catalogue, in a short run of the Iltis."""

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.base.registry import find, kinds
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.store.reader import open_result

pytestmark = pytest.mark.long

DRIVERS = {
    "preview": "{kind: preview, preview_time: 0.5 s, lag_frequency: 20 rad/s, lag_damping: 0.8, "
    "rack_stop: 60 mm}",
    "macadam": "{kind: macadam, preview_time: 1 s, points: 5, speed: 10 m/s, mass: 1600 kg, "
    "yaw_inertia: 1800 kg*m^2, front_distance: 1 m, rear_distance: 1 m, HANDS, "
    "front_stiffness: 60 kN/rad, rear_stiffness: 60 kN/rad, rack_speed: 0.5 m/s}",
    "pure_pursuit": "{kind: pure_pursuit, distance: 5 m, HANDS, rack_acceleration: 20 m/s^2}",
    "stanley": "{kind: stanley, gain: 3 Hz, HANDS}",
}
HANDS = "lag_frequency: 20 rad/s, lag_damping: 0.8, rack_stop: 60 mm"
DRIVERS = {kind: text.replace("HANDS", HANDS) for kind, text in DRIVERS.items()}
SLALOM = (
    "{kind: slalom, cones: 1, spacing: 18 m, first_cone: 4 m, cone_radius: 0.1 m, "
    "path_offset: 1 m, driver: DRIVER}"
)
MANOEUVRES = {
    "acceleration": "{kind: acceleration, torque: 900 N*m, begin: 0}",
    "braking_in_turn": "{kind: braking_in_turn, angle: 3 deg, begin: 0, brake_at: 0.1 s, "
    "torque: 900 N*m}",
    "constant_steer": "{kind: constant_steer, angle: 3 deg, begin: 0, accelerate_at: 0.1 s, "
    "last_speed_change: 1 m/s, speed_control: CONTROL}",
    "crosswind": "{kind: crosswind, force: 900 N, ahead: 0.2 m, begin: 0}",
    "double_lane_change": "{kind: double_lane_change, begin: -14 m, driver: DRIVER}",
    "fishhook": "{kind: fishhook, angle: 8 deg, begin: 0}",
    "j_turn": "{kind: j_turn, angle: 8 deg, begin: 0}",
    "obstacle_avoidance": "{kind: obstacle_avoidance, begin: -11 m, release_at: 0, driver: DRIVER}",
    "open_loop": "{kind: open_loop, times: [0 s, 0.1 s], angles: [0 deg, 3 deg], "
    "brake_torques: [0 N*m, 900 N*m]}",
    "pulse_steer": "{kind: pulse_steer, amplitude: 2 deg, width: 0.1 s, begin: 0}",
    "single_sine": "{kind: single_sine, amplitude: 2 deg, frequency: 8 Hz, begin: 0}",
    "slowly_increasing_steer": "{kind: slowly_increasing_steer, angle: 9 deg, begin: 0}",
    "step_steer": "{kind: step_steer, angle: 3 deg, begin: 0}",
    "straight_braking": "{kind: straight_braking, torque: 900 N*m, brake_at: 0}",
    "swept_sine": "{kind: swept_sine, amplitude: 1 deg, sweep_time: 0.2 s, first: 5 Hz, "
    "last: 15 Hz, begin: 0}",
    "weave": "{kind: weave, amplitude: 1 deg, frequency: 10 Hz, begin: 0}",
    "ramp_steer": "{kind: ramp_steer, rate: 10 mm/s, ramp_time: 0.1 s}",
    "sine_steer": "{kind: sine_steer, amplitude: 4 mm, frequency: 2 Hz}",
    "sine_with_dwell": "{kind: sine_with_dwell, amplitude: 6 mm, frequency: 4 Hz, dwell: 10 ms}",
    "slalom": SLALOM.replace("DRIVER", DRIVERS["preview"]),
    "straight": "{kind: straight}",
}
MANOEUVRES = {
    kind: text.replace("DRIVER", DRIVERS["preview"]).replace(
        "CONTROL", "{proportional_gain: 3000 N*s, integral_gain: 300 N}"
    )
    for kind, text in MANOEUVRES.items()
}
UNSTEERED = {"straight", "acceleration", "straight_braking", "crosswind"}
RELAXATIONS = {
    "first_order": "{kind: first_order, longitudinal: 0.2 m, lateral: 0.4 m}",
    "of_tyre": "{kind: of_tyre}",
}
TYRES = {"of_tyre": "{file: passenger_R0394_mf61.tir}"}
SCENARIO = """\
title: A short run
model: iltis
tyres: TYRES
road: ROAD
relaxation: RELAXATION
wheel_spin: SPIN
speed: SPEED
manoeuvre: MANOEUVRE
duration: DURATION
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""
DEFAULTS = {
    "ROAD": "{kind: flat}",
    "TYRES": "{kind: magic_formula_1987}",
    "RELAXATION": "null",
    "SPIN": "free",
    "SPEED": "10 m/s",
    "DURATION": "0.3 s",
    "MANOEUVRE": MANOEUVRES["straight"],
}


def drive(folder, **changes):
    text = SCENARIO
    for word, value in (DEFAULTS | changes).items():
        text = text.replace(word, value)
    path, output = folder / "run.yaml", folder / "run.h5"
    path.write_text(text)
    loaded = load_scenario(path, ())
    outcome = run_scenario(loaded, output=output, backend="auto", progress=lambda *_: None)
    assert outcome.status == "ok"
    return open_result(output)


def test_every_entry_has_an_example():
    own = {
        k for k in kinds("manoeuvre") if find("manoeuvre", k).__module__.startswith("vehicledyn")
    }
    assert own == set(MANOEUVRES)
    assert set(kinds("driver")) == set(DRIVERS)
    assert set(kinds("relaxation")) == set(RELAXATIONS)


@pytest.mark.parametrize("kind", kinds("manoeuvre"))
def test_manoeuvre_runs_and_says_what_it_writes(tmp_path, kind):
    with drive(tmp_path, MANOEUVRE=MANOEUVRES[kind]) as result:
        assert len(result.time) == 31
        for name in result.channels:
            channel = result.channel(name)
            assert channel.unit and channel.description, name
        assert result.summary
        for name, entry in result.summary.items():
            assert entry.description and (entry.unit or isinstance(entry.value, str)), name
        assert {plot["name"] for plot in result.plots} >= {"path", "steering", "yaw"}
        turned = abs(result.channel("steering.rack").values).max()
        assert (turned > 1e-4) == (kind not in UNSTEERED)


@pytest.mark.parametrize("kind", kinds("driver"))
def test_driver_steers_towards_the_path(tmp_path, kind):
    """The path bends to the left; behind the axle, the rack pulls to the right for that."""
    manoeuvre = SLALOM.replace("DRIVER", DRIVERS[kind])
    with drive(tmp_path, MANOEUVRE=manoeuvre) as result:
        assert result.channel("body.yaw_rate").values[-1] > 0.01
        assert result.channel("chassis.y").values[-1] > 0.0


@pytest.mark.parametrize("kind", kinds("relaxation"))
def test_relaxation_holds_a_standing_car_on_a_slope(tmp_path, kind):
    with drive(
        tmp_path,
        RELAXATION=RELAXATIONS[kind],
        TYRES=TYRES.get(kind, DEFAULTS["TYRES"]),
        ROAD="{kind: plane, slope_x: 0.05, slope_y: 0.1}",
        SPIN="prescribed",
        SPEED="0",
        DURATION="3 s",
    ) as result:
        for name in ("chassis.x", "chassis.y"):
            settling, standing = (
                result.channel(name).values[:150],
                result.channel(name).values[150:],
            )
            assert abs(settling).max() < 0.01  # tyres and springs give way first
            assert abs(standing - standing[-1]).max() < 1e-4


def test_a_car_at_standstill_has_no_side_slip(tmp_path):
    with drive(tmp_path, SPEED="0 m/s") as result:
        assert "largest_sideslip_angle" not in result.summary
    with drive(tmp_path) as result:
        assert result.summary["largest_sideslip_angle"].value < 1e-3


def test_a_sine_with_dwell_waits_at_its_second_peak_and_ends_in_the_middle(tmp_path):
    with drive(tmp_path, MANOEUVRE=MANOEUVRES["sine_with_dwell"], DURATION="2.1 s") as result:
        time, rack = result.time, result.channel("steering.rack").values
        quarter = 0.0625  # s
        at = np.interp([quarter, 3 * quarter, 3 * quarter + 0.01, 4 * quarter + 0.01], time, rack)
        assert at == pytest.approx([6e-3, -6e-3, -6e-3, 0.0], abs=1.5e-4)
        rate = result.channel("body.yaw_rate").values
        later = np.interp(0.26 + 1.75, time, np.abs(rate)) / np.abs(rate[time >= 0.125]).max()
        found = result.summary["second_yaw_rate_ratio"].value
        assert found == pytest.approx(later, rel=1e-9)
        moved = np.interp(1.07, time, result.channel("chassis.y").values)
        assert result.summary["lateral_displacement"].value == pytest.approx(abs(moved), rel=1e-9)
