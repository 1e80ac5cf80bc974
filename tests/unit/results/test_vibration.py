"""Vibration by ISO 2631-1: published weighting factors, sines in closed form, runs with seats."""

import math

import numpy as np
import pytest

import vehicledyn
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.base.units import shown, to_si
from vehicledyn.interface.targets import read_target
from vehicledyn.results.assessment.even_samples import even_samples
from vehicledyn.results.assessment.summary import summarise_vibration
from vehicledyn.results.assessment.vibration import assess_vibration, vibration_remarks
from vehicledyn.results.assessment.weighting import W_D, W_K

PRINTED = {
    W_K: {1: 0.482, 2: 0.531, 4: 0.967, 5: 1.039, 6.3: 1.054, 8: 1.036, 10: 0.988, 16: 0.768,
          31.5: 0.405},
    W_D: {1: 1.011, 2: 0.890, 4: 0.512, 8: 0.253},
}  # fmt: skip
STEP = 2e-3
TIME = np.arange(0.0, 40.0 + STEP / 2, STEP)


@pytest.mark.parametrize("weighting", PRINTED, ids=lambda w: w.name)
def test_the_weightings_are_those_of_the_tables_of_the_standard(weighting):
    """ISO 2631-1:1997, principal weightings at third octaves, three digits; 0.1 %."""
    frequencies = np.array(list(PRINTED[weighting]), dtype=float)
    printed = np.array(list(PRINTED[weighting].values()))
    assert np.abs(weighting(frequencies)) == pytest.approx(printed, rel=1e-3)


def seat(**given):
    values = {d: given.get(d, 0.0) + 0.0 * TIME for d in ("longitudinal", "lateral", "vertical")}
    channels = {f"seat.{direction}": column for direction, column in values.items()}
    return even_samples(TIME, channels, begin=10.0, end=30.0)


def test_a_sine_has_the_figures_of_its_weighted_amplitude():
    """rms A/√2, VDV A (3 T/8)^¼, crest factor √2, total by Pythagoras."""
    tones = {"longitudinal": (1.0, 0.4), "lateral": (2.0, 0.6), "vertical": (5.0, 0.5)}
    samples = seat(**{d: a * np.sin(2.0 * np.pi * f * TIME) for d, (f, a) in tones.items()})
    found = assess_vibration("seat", samples)
    total = 0.0
    for direction, (frequency, amplitude) in tones.items():
        weighting = W_K if direction == "vertical" else W_D
        weighted = amplitude * abs(weighting(np.array([frequency]))[0])
        axis = found.axes[direction]
        assert axis.rms == pytest.approx(weighted / math.sqrt(2.0), rel=1e-3)
        assert axis.transient == pytest.approx(axis.rms, rel=1e-3)
        assert axis.dose == pytest.approx(weighted * (3.0 * 20.0 / 8.0) ** 0.25, rel=1e-3)
        assert axis.crest_factor == pytest.approx(math.sqrt(2.0), rel=2e-3)
        total += axis.rms**2
    assert found.total == pytest.approx(math.sqrt(total))
    assert not list(vibration_remarks(found, samples))
    entries = {e.name: e for e in summarise_vibration(found)}
    assert entries["seat.vdv_vertical"].unit == "m/s^1.75"
    assert entries["seat.reaction"].value == "a little uncomfortable to fairly uncomfortable"


def test_a_shock_has_a_crest_factor_that_is_reported_and_a_transient_of_its_second():
    shock = np.where(np.abs(TIME - 20.0) < 0.05, 10.0 * np.cos(10.0 * np.pi * (TIME - 20.0)), 0.0)
    samples = seat(vertical=shock)
    found = assess_vibration("seat", samples)
    axis = found.axes["vertical"]
    assert axis.transient == pytest.approx(axis.rms * math.sqrt(20.0), rel=0.02)
    assert "judge by MTVV and VDV" in "".join(vibration_remarks(found, samples))
    assert math.isnan(found.axes["lateral"].crest_factor)


def test_what_does_not_vibrate_and_what_is_short_has_no_such_figures():
    short = even_samples(TIME[:100], {"seat.vertical": np.zeros(100)})
    found = assess_vibration("seat", short)
    assert found.total is None
    assert [e.name for e in summarise_vibration(found)] == [
        "seat.weighted_vertical", "seat.vdv_vertical",
    ]  # fmt: skip


def test_the_unit_of_the_dose_is_read_and_shown():
    assert shown(1.25, "m/s^1.75") == "1.25 m/s^1.75"
    assert to_si("2 km/s^1.75", "m/s^1.75") == 2000.0


SHAKEN = """\
title: A shaken chair
bodies:
  table:
    joints: [T3 height]
    mass: 1 kg
drives:
  shaker: {coordinate: table.height, law: {kind: sine, amplitude: 2 mm, frequency: 4 Hz}}
sensors:
  chair: {kind: seat, body: table}
"""


@pytest.mark.long
def test_a_run_reports_the_vibration_at_its_seat(tmp_path):
    path = tmp_path / "shaken.yaml"
    path.write_text(SHAKEN)
    run = {"duration": "5 s", "solver": {"kind": "rk4", "step": "1 ms"}, "backend": "interpreted"}
    data = vehicledyn.simulate(path, output={"interval": "10 ms"}, **run)
    weighted = 2e-3 * (2.0 * math.pi * 4.0) ** 2 * abs(W_K(np.array([4.0]))[0])
    found = data.summary["chair.weighted_vertical"].value
    assert found == pytest.approx(weighted / math.sqrt(2.0), rel=0.02)
    assert "up to 50 Hz" in data.summary["vibration_remarks"].value


DRIVEN = """\
title: A seat in the small car
model: small_car
speed: 10 m/s
manoeuvre: {kind: straight, seat: [-0.2 m, 0.35 m, 0.1 m]}
duration: 1 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 5 ms}
"""


def test_a_scenario_puts_a_seat_into_a_road_vehicle(tmp_path):
    path = tmp_path / "driven.yaml"
    path.write_text(DRIVEN)
    subject = build_subject(read_target(path))
    (sensor,) = (part for part in subject.system.parts if part.name == "seat")
    assert sensor.body == "chassis"
    entries = {e.name: e.value for e in subject.system.table.entries if e.name[:5] == "seat."}
    assert entries == {"seat.x": -0.2, "seat.y": 0.35, "seat.z": 0.1}
