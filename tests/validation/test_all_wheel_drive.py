"""The centre differential of the sedan with all-wheel drive, open and locked, by closed forms."""

from pathlib import Path

import numpy as np
import pytest
from reference_cases.motions import quiet, recorded

from vehicledyn.analyses.preparation.prepare import start_point
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.files.scenario import load_scenario

pytestmark = [pytest.mark.validation, pytest.mark.long, pytest.mark.xdist_group("all_wheel_drive")]

SYSTEM = Path(__file__).parents[2] / "systems" / "all_wheel_drive_sedan.yaml"
WHEELBASE, RATIO = 2.776, 5.0
PROPELLER, SHAFT = 0.5 + 0.6 / RATIO**2, 0.2
INPUT, GRAVITY = 0.1, 9.81
SCENARIO = """\
title: The sedan with all-wheel drive
model: SYSTEM
road: {kind: flat}
wheel_spin: free
speed: SPEED
start: static
parameters: {centre: {clutch: {torque: 0 N*m}}, car: {driveline: {clutch: {torque: 0 N*m}}}}
manoeuvre: MANOEUVRE
duration: DURATION
solver: {kind: rk4, step: 1 ms}
output: {interval: 1 ms}
"""
START = {
    "SPEED": "0 m/s",
    "MANOEUVRE": "{kind: acceleration, torque: 400 N*m, begin: 0.1 s}",
    "DURATION": "0.9 s",
}
CIRCLE = {
    "SPEED": "4 m/s",
    "MANOEUVRE": "{kind: open_loop, times: [0.1 s, 0.8 s], angles: [0 deg, 200 deg]}",
    "DURATION": "2.5 s",
}


class Driven:
    """The car of a scenario, derived once for all torques of its centre clutch."""

    def __init__(self, words, path):
        text = SCENARIO.replace("SYSTEM", str(SYSTEM))
        for word, value in words.items():
            text = text.replace(word, value)
        path.write_text(text, encoding="utf-8")
        loaded = load_scenario(path)
        self.scenario = loaded.scenario
        self.prepared, _ = prepare_run(loaded, backend="auto", progress=quiet)

    def __call__(self, torque):
        names = [p.name for p in self.prepared.equations.parameters]
        kernel = self.prepared.kernel
        values = kernel.parameters.copy()
        values[names.index("centre.clutch.torque")] = torque
        kernel.set_parameters(values)
        start = start_point(self.prepared, self.scenario.speed, self.scenario.start)
        return recorded(self.scenario, self.prepared, start)


@pytest.fixture(scope="module")
def started(tmp_path_factory):
    return Driven(START, tmp_path_factory.mktemp("start") / "run.yaml")


@pytest.fixture(scope="module")
def circling(tmp_path_factory):
    return Driven(CIRCLE, tmp_path_factory.mktemp("circle") / "run.yaml")


def passed(run, drive):
    """Return the torque that a propeller shaft takes from the centre differential [N m]."""

    def rate(name):
        return np.gradient(np.asarray(run[f"{drive}.{name}.angle_rate"]), run.time)

    torque = sum(
        np.asarray(run[f"{drive}.{side}_half_shaft.torque"]) + SHAFT * rate(f"{side}_shaft")
        for side in ("left", "right")
    )
    return PROPELLER * rate("propeller") + torque / RATIO


def speeds(run):
    return [np.asarray(run[f"{d}.propeller.angle_rate"]) for d in ("front_drive", "car.driveline")]


@pytest.mark.parametrize("clutch", [0.0, 80.0, 5e3])
def test_the_centre_shares_torque_alike_but_for_its_clutch(started, clutch):
    """T_front = T/2 - T_c and T_rear = T/2 + T_c, and the input turns at the mean of both."""
    run = started(clutch)
    front, rear = passed(run, "front_drive"), passed(run, "car.driveline")
    coupled = np.asarray(run["centre.clutch.torque"])
    late = (run.time > 0.3) & (run.time < 0.85)
    size = np.abs(front + rear)[late].max()
    assert size > 500.0
    assert (rear - front)[late] == pytest.approx(2.0 * coupled[late], abs=5e-3 * size)
    turned = speeds(run)
    given = np.asarray(run["centre.input.angle_rate"])
    assert given == pytest.approx(0.5 * (turned[0] + turned[1]), abs=1e-9)
    if clutch == 0.0:
        assert np.abs(coupled).max() == 0.0
    elif clutch < 1e3:
        assert np.abs(coupled).max() <= clutch * (1.0 + 1e-9)
    else:
        assert turned[0][late] == pytest.approx(turned[1][late], rel=2e-2)


def test_on_a_circle_an_open_centre_turns_by_the_paths_and_a_locked_one_alike(circling):
    """The front axle goes round on √(R² + L²), R of the rear axle, a locked centre slips both."""
    found = []
    for clutch in (0.0, 5e3):
        run = circling(clutch)
        late = run.time > 2.0
        front, rear = (v[late].mean() for v in speeds(run))
        rate = np.asarray(run["body.yaw_rate"])[late].mean()
        ahead = np.asarray(run["body.forward_speed"])[late].mean()
        found.append((front / rear, np.hypot(1.0, WHEELBASE * rate / ahead)))
    (opened, paths), (locked, needed) = found
    assert paths > 1.015
    assert opened == pytest.approx(paths, abs=0.1 * (paths - 1.0))
    assert needed > 1.015
    assert locked == pytest.approx(1.0, abs=1e-3)
