"""The steering box: torque and twist of its column by hand, and the off-road truck on it."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd

SYSTEMS = Path(__file__).parents[3] / "systems"
RIG = """\
title: The steering box against its spring
model: steering_box
parameters:
  test: {amplitude: 0.3 m, frequency: 0.1 Hz}
duration: 5 s
solver: {kind: rk4, step: 0.5 ms}
output: {interval: 50 ms}
"""


@pytest.mark.long
def test_the_column_carries_spring_and_friction(tmp_path):
    """T = K r² β/i + M_f while the wheel turns away, and the column twists by T/k."""
    path = tmp_path / "rig.yaml"
    path.write_text(RIG)
    result = vd.simulate(path)
    wheel, arm, torque = (
        np.asarray(result[name]) for name in ("steering_wheel", "pitman_arm", "column_torque")
    )
    k = int(np.argmax(wheel)) - 5  # half a second before the hands turn back
    ratio, radius, spring, friction, column = 16.0, 0.129, 50e3, 0.6, 900.0
    assert torque[k] == pytest.approx(spring * radius**2 * arm[k] / ratio + friction, rel=5e-3)
    assert wheel[k] - ratio * arm[k] == pytest.approx(torque[k] / column, rel=1e-9)


@pytest.mark.long
def test_the_truck_turns_less_where_the_column_yields(tmp_path):
    """Its hands hold the arc of the rim; the road pushes the wheels back against the column."""
    assert (SYSTEMS / "steering_box.yaml").is_file()
    text = (SYSTEMS / "off_road_truck.yaml").read_text(encoding="utf-8")
    text = text.replace("file: pitman_steering.yaml", "file: steering_box.yaml")
    for name in ("link", "arm.length", "arm.pivot", "tilt"):
        text = text.replace(f"steering.{name}", f"steering.linkage.{name}")
    text = text.replace("steering.rack.displacement", "steering.hands.displacement")
    text = text.replace("-7.9 rad/m", "-0.318 rad/m").replace("file: ", f"file: {SYSTEMS}/")
    rates = []
    for stiffness in ("1 MN*m/rad", "900 N*m/rad"):
        path = tmp_path / "truck.yaml"
        path.write_text(text)
        scenario = tmp_path / "turn.yaml"
        scenario.write_text(
            f"title: A turn\nmodel: {path}\nwheel_spin: free\nspeed: 15 m/s\n"
            f"parameters: {{steering: {{column: {{stiffness: {stiffness}}}}}}}\n"
            "manoeuvre: {kind: ramp_steer, rate: -0.2 m/s, ramp_time: 0.5 s, begin: 0.5 s}\n"
            "duration: 2.5 s\nsolver: {kind: rk4, step: 0.5 ms}\noutput: {interval: 50 ms}\n"
        )
        rates.append(float(np.asarray(vd.simulate(scenario)["chassis.yaw_rate"])[-1]))
    assert 0.5 * rates[0] < rates[1] < 0.99 * rates[0]
