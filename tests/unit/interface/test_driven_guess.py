"""The drive along a path from which the search for an optimal manoeuvre begins."""

import numpy as np
import pytest

from vehicledyn.studies.manoeuvre_optimisation.file import load_manoeuvre
from vehicledyn.studies.manoeuvre_optimisation.guess import first_guess
from vehicledyn.studies.manoeuvre_optimisation.model import prepare_manoeuvre

CAR = """\
title: A small car runs straight
model: small_car
manoeuvre: {kind: straight}
wheel_spin: free
speed: 6 m/s
duration: 3 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""
LAP = """\
title: Round a circle
scenario: car.yaml
controls:
  drive:
    input: {"force:rear_left_wheel.spin": 0.5, "force:rear_right_wheel.spin": 0.5}
    from: -1200 N*m
    to: 1200 N*m
    rate: 6000 N*m/s
  wheels:
    input: road_wheel_angle
    from: -15 deg
    to: 15 deg
    rate: 30 deg/s
    acceleration: 400 deg/s^2
minimise: time
duration: {from: 1 s, to: 60 s}
start: {path.distance: 0, wheels: free, drive: free}
end: {path.distance: 94.2477796076938 m}
periodic: {"chassis.*": 0, chassis.yaw: 360 deg}
path: {arc: {radius: 15 m}, closed: true, right: 1 m, left: 2 m}
intervals: 20
"""


@pytest.mark.long
def test_a_car_is_driven_round_the_middle_of_a_closed_corridor(tmp_path):
    """The second round returns to its own start, half a metre inside the path, at its speed."""
    (tmp_path / "car.yaml").write_text(CAR, encoding="utf-8")
    (tmp_path / "lap.yaml").write_text(LAP, encoding="utf-8")
    manoeuvre = prepare_manoeuvre(load_manoeuvre(tmp_path / "lap.yaml"), lambda *_: None)
    guess, trouble = first_guess(manoeuvre)
    assert not trouble
    names = [s.name for s in manoeuvre.problem.equations.states]
    at = {name: guess.all_states[:, k] for k, name in enumerate(names)}
    radius = np.hypot(at["chassis.x"], at["chassis.y"] - 15.0)
    assert radius == pytest.approx(14.5, abs=0.6)
    assert np.hypot(at["chassis.x_rate"], at["chassis.y_rate"]) == pytest.approx(6.0, rel=0.02)
    for name in ("chassis.x", "chassis.y", "chassis.z", "chassis.roll", "chassis.yaw_rate"):
        assert at[name][-1] == pytest.approx(at[name][0], abs=0.05)
    assert at["chassis.yaw"][-1] - at["chassis.yaw"][0] == pytest.approx(2.0 * np.pi, abs=0.01)
    wheels = guess.values[:, 1]
    assert wheels == pytest.approx(wheels.mean(), rel=0.02)
    assert wheels.mean() > 0.05
    assert guess.values[:, 0].mean() > 0.0


@pytest.mark.long
def test_a_drive_that_fails_is_reported(tmp_path):
    """Wheels that hardly turn do not take a car round a circle."""
    text = LAP.replace("15 deg", "0.2 deg")
    (tmp_path / "car.yaml").write_text(CAR, encoding="utf-8")
    (tmp_path / "lap.yaml").write_text(text, encoding="utf-8")
    manoeuvre = prepare_manoeuvre(load_manoeuvre(tmp_path / "lap.yaml"), lambda *_: None)
    guess, trouble = first_guess(manoeuvre)
    assert trouble.startswith(
        "warning: driving along the path to begin with failed: the vehicle is 20 m beside the path"
    )
    assert guess.n_intervals == 20
