"""A run whose driver loses the car: whole result, time and place, exit code 1."""

from types import SimpleNamespace

import numpy as np
import pytest

import vehicledyn
from vehicledyn.analyses.sensitivity import motion
from vehicledyn.analyses.sensitivity.driving_failures import driving_failure
from vehicledyn.analyses.simulation.lost_control import PATH_ERROR
from vehicledyn.base.errors import AccuracyWarning, NumericalError
from vehicledyn.cli import main
from vehicledyn.results.store.study_reader import open_study
from vehicledyn.road.manoeuvres.lane_change_test import LOST
from vehicledyn.road.standards.entries import entry
from vehicledyn.studies.figures import run_figures
from vehicledyn.symbolic.equations import Channel

TOO_FAST = """
title: The small car is too fast for a bend
model: small_car
speed: 30 m/s
manoeuvre:
  kind: path
  xs: [0 m, 40 m, 80 m, 110 m, 120 m]
  ys: [0 m, 0 m, 10 m, 40 m, 80 m]
  distances: [0 m, 80 m]
  speeds: [30 m/s, 30 m/s]
  driver: {kind: preview, preview_time: 0.5 s, lag_frequency: 20 rad/s, lag_damping: 0.8,
    rack_stop: 50 mm}
  speed_control: {proportional_gain: 1000 N*s, integral_gain: 300 N}
duration: 4 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""

RUN = """
title: A pendulum swings
model: double_pendulum
duration: 0.1 s
solver: {kind: rk4, step: 10 ms}
output: {interval: 10 ms}
"""
SEARCH = """
title: Its length
scenarios: run.yaml
variables: {length: {from: 0.5 m, to: 2 m}}
minimise: {final(upper.angle): 1}
"""


def test_a_run_whose_driver_lost_the_car_is_whole_and_no_success(tmp_path, capsys, monkeypatch):
    (tmp_path / "fast.yaml").write_text(TOO_FAST)
    result = tmp_path / "fast.h5"
    words = ["vehicledyn", "run", str(tmp_path / "fast.yaml"), "--no-plots", "-o", str(result)]
    monkeypatch.setattr("sys.argv", words)
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 1
    data = vehicledyn.open_result(result)
    assert data.status == "driver_lost"
    assert data.time[-1] == pytest.approx(4.0)
    summary = data.summary
    time, way = summary["lost_at_time"].value, summary["lost_at_distance"].value
    error = np.abs(data["driver.path_error"].values)
    assert np.interp(time, data.time, error) >= 5.0 > np.interp(time - 0.01, data.time, error)
    said = capsys.readouterr().err
    for words in (f"from its path: {time:.4g} s", f"he lost it: {way:.4g} m"):
        assert words in said
        assert words in data.status_message


@pytest.mark.parametrize("figures", ["true", "false"])
def test_a_case_of_a_sweep_whose_driver_lost_the_car_says_so(tmp_path, figures):
    (tmp_path / "fast.yaml").write_text(TOO_FAST)
    study = f"""
title: Too fast and slow enough
scenario: fast.yaml
set: {{manoeuvre.speed_control: {{proportional_gain: 1 N*s, integral_gain: 1 N}}}}
cases: {{kind: grid, vary: {{speed: [12 m/s, 30 m/s]}}}}
output: {{interval: 20 ms, channels: [body.*], figures: {figures}}}
"""
    (tmp_path / "study.yaml").write_text(study)
    data = vehicledyn.sweep(tmp_path / "study.yaml", save_to=tmp_path / "study.h5", workers=1)
    assert data["case.status"].values.tolist() == ["done", "driver_lost"]
    with open_study(tmp_path / "study.h5") as file:
        assert file.counts()["driver_lost"] == 1
        assert ("lost_at_time" in file.figures) is (figures == "true")


def followed(channel, values, ended_by=""):
    """A study of one channel, and its motion of two seconds."""
    e = SimpleNamespace(
        channels=[Channel(channel, "m", "")],
        events=[SimpleNamespace(name="body.overturned", outcome="overturned")],
    )

    def summarise(recording):
        far = recording.channels[PATH_ERROR] > LOST
        time = float(recording.time[np.argmax(far)])
        return list(entry("lost_at_time", time, "s", "When")) if far.any() else []

    subject = SimpleNamespace(summarise=summarise)
    study = SimpleNamespace(prepared=SimpleNamespace(equations=e, subject=subject), channels=[0])
    rows = np.array(values)[:, None]
    return study, SimpleNamespace(times=np.arange(len(values)), values=rows, ended_by=ended_by)


def test_a_followed_run_tells_how_it_lost_its_vehicle():
    assert driving_failure(*followed(PATH_ERROR, [0.0, 4.9, 1.0])) == ""
    assert driving_failure(*followed("body.x", [0.0, 9.0, 9.0])) == ""
    assert driving_failure(*followed(PATH_ERROR, [0.0, 5.1, 9.0])).startswith(
        "driver_lost: When: 1 s"
    )
    assert driving_failure(*followed("body.x", [0.0, 0.0], "body.overturned")).startswith(
        "overturned"
    )


def test_studies_take_no_run_that_lost_its_vehicle_for_an_ordinary_one(monkeypatch, tmp_path):
    """Samples of an uncertainty are told; a search does not take such a run, or begin with it."""
    laws = {"length": {"kind": "normal", "mean": "1 m", "deviation": "5 mm"}}
    for module in (motion, run_figures):
        monkeypatch.setattr(module, "driving_failure", lambda *_: "driver_lost: at 1 s")
    asked = ["final(upper.angle)"]
    found = vehicledyn.uncertainty(
        "double_pendulum", asked, laws, method="monte_carlo", number=2, duration="0.1 s"
    )
    assert "2 of 2 runs lost the vehicle" in found.notes[-1]
    with pytest.warns(AccuracyWarning, match="driver_lost: at 1 s"):
        vehicledyn.sensitivity("double_pendulum", asked, ["length"], duration="0.1 s")
    (tmp_path / "run.yaml").write_text(RUN)
    (tmp_path / "study.yaml").write_text(SEARCH)
    with pytest.raises(NumericalError, match="driver_lost: at 1 s"):
        vehicledyn.optimise(tmp_path / "study.yaml")


@pytest.mark.long
def test_an_optimisation_does_not_begin_with_a_car_that_its_driver_loses(tmp_path):
    (tmp_path / "run.yaml").write_text(TOO_FAST)
    search = SEARCH.replace("length: {from: 0.5 m, to: 2 m}", "body.mass: {from: 0.8 t, to: 1 t}")
    (tmp_path / "study.yaml").write_text(search.replace("upper.angle", "body.forward_speed"))
    with pytest.raises(NumericalError, match="driver_lost: When the driver lost the car, 5 m"):
        vehicledyn.optimise(tmp_path / "study.yaml")
