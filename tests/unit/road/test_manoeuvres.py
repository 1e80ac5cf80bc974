"""Every manoeuvre, driver and relaxation of the catalogue, in a short run of the Iltis."""

from dataclasses import fields
from types import SimpleNamespace

import numpy as np
import pytest
from manoeuvre_examples import DEFAULTS, DRIVERS, MANOEUVRES, SLALOM, written

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.base.registry import find, kinds
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.store.reader import open_result
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.standards.signals import Signals

pytestmark = pytest.mark.long

UNSTEERED = {
    "straight",
    "coast_down",
    "acceleration",
    "straight_braking",
    "split_braking",
    "crosswind",
}
RELAXATIONS = {
    "first_order": "{kind: first_order, longitudinal: 0.2 m, lateral: 0.4 m}",
    "of_tyre": "{kind: of_tyre}",
    "contact_patch": "{kind: contact_patch, mass: 1.5 kg, half_length: 60 mm, "
    "longitudinal_damping: 400 N*s/m, lateral_damping: 400 N*s/m}",
}
TYRES = dict.fromkeys(("of_tyre", "contact_patch"), "{file: passenger_R0394_mf61.tir}")


def drive(folder, **changes):
    path, output = folder / "run.yaml", folder / "run.h5"
    path.write_text(written(**changes))
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


@pytest.mark.parametrize("air_by", ["part", "force", ""])
def test_coast_down_finds_the_resistance_that_slows_a_car(air_by):
    """v = √(d₀/d₂) tan(φ₀ - √(d₀ d₂) t) is the solution of v' = -d₀ - d₂ v²."""
    rolling, air, time = 0.12, 4e-4, np.arange(0.0, 60.0, 0.1)
    root = np.sqrt(rolling * air)
    angle = np.arctan(30.0 * np.sqrt(air / rolling))
    speed = np.sqrt(rolling / air) * np.tan(angle - root * np.maximum(time - 0.6, 0.0))
    names = [field.name for field in fields(Signals)]
    seen = Signals(**dict.fromkeys(names, 0.0 * time) | {"time": time, "forward_speed": speed})
    has_part, mass = air_by == "part", 1200.0
    parts = [object.__new__(find("element_type", "air_drag"))] if has_part else []
    gravity = SimpleNamespace(parts=parts, gravity=(0.0, 0.0, -9.81))
    corners = (SimpleNamespace(name="wheel"),)
    vehicle = SimpleNamespace(system=gravity, corners=corners, worth=float)
    # Without air the tyres alone slow the car, however their resistance grows.
    # Lateral forces of wheels with toe take a thousandth of a metre per second squared beside.
    tyres = -mass * (rolling + (0.0 if air_by else 0.99 * air) * speed**2)
    channels = {
        "wheel.tyre.longitudinal_force": tyres,
        "wheel.tyre.normal_force": np.full_like(time, mass * 9.81),
    }
    recording = Recording(time, channels)
    entries = find("manoeuvre", "coast_down")().quantities(seen, recording, vehicle)
    found = {entry.name: entry.value for entry in entries}
    assert found["rolling_deceleration"] == pytest.approx(rolling, rel=1e-5)
    assert found.get("air_deceleration") == (pytest.approx(air, rel=1e-5) if air_by else None)
    way = np.log(np.cos(angle - root * 59.3) / np.cos(angle)) / air
    assert found["rolled_distance"] == pytest.approx(way, rel=1e-5)


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
        after = -rate[time >= 0.125] * np.sign(rate[np.argmax(np.abs(rate) * (time <= 0.125))])
        peak = after[1 + np.argmax((after[1:-1] > after[:-2]) & (after[1:-1] >= after[2:]))]
        later = np.interp(0.26 + 1.75, time, np.abs(rate)) / peak
        found = result.summary["second_yaw_rate_ratio"].value
        assert found == pytest.approx(later, rel=1e-9)
        ratios = [result.summary[f"{n}_yaw_rate_ratio"].value for n in ("first", "second")]
        assert result.summary["stable"].value == (ratios[0] <= 0.35 and ratios[1] <= 0.2)
        moved = np.interp(1.07, time, result.channel("chassis.y").values)
        assert result.summary["lateral_displacement"].value == pytest.approx(abs(moved), rel=1e-9)
