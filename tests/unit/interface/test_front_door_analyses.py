"""Every analysis returns a value in memory from Python, and its messages name arguments."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from small_systems import pendulum

import vehicledyn as vd
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.hunt_table import CycleRow, HuntTable, write_hunt

PACKAGE = Path(vd.__file__).parent
QUICK = {"backend": "interpreted"}
FREQUENCY = math.sqrt(1.5 * 9.81 / 1.0)
"""Of small motions of a rod of 1 m that hangs at its end [rad/s]."""


def test_equilibrium_by_name():
    found = vd.equilibrium("quarter_car", **QUICK)
    # The tyre carries wheel and body: 340 kg over 180 kN/m.
    assert float(found["wheel.height"]) == pytest.approx(-340.0 * 9.81 / 180e3, rel=1e-9)
    assert found["tyre.force"].unit == "N"
    assert found.attributes["stability"] == "stable"
    assert found.to_dataframe().loc["wheel.height", "coordinate_nominal"] == 0.0
    assert found.kind == "equilibrium" and found.model == "quarter_car"


def test_modes_of_cases():
    found = vd.modes(pendulum(0.0), cases={"short": {}, "long": {"length": "4 m"}}, **QUICK)
    rates = 2.0 * np.pi * found["frequency"].values[:, 0]
    assert rates == pytest.approx([FREQUENCY, FREQUENCY / 2.0], rel=1e-9)
    assert found["case"].values.tolist() == ["short", "long"]
    assert np.iscomplexobj(found["eigenvalue"].values)
    assert found.to_dataframe().index.names == ["case", "mode"]


def test_response_of_a_driven_car():
    found = vd.response("quarter_car", "road.height", "body.height", points=5, last="10 Hz")
    assert found["static_gain"].values == pytest.approx(np.ones((1, 1)))
    assert found["magnitude"].dims == ("frequency", "input", "output")
    assert found["frequency"].values[[0, -1]] == pytest.approx([0.1, 10.0])


def test_kinematics_of_a_pendulum():
    found = vd.kinematics(pendulum(), {"rod.angle": ("0 deg", "90 deg", 3)})
    assert found["rod.angle"].values == pytest.approx(np.radians([0.0, 30.0, 60.0, 90.0]))
    assert found["rod.angle"].dims == ("sample",)


def test_inverse_dynamics_of_a_simulated_motion():
    swing = vd.simulate(pendulum(), duration="0.2 s", **QUICK)
    forces = vd.inverse(pendulum(), motion=swing, duration="0.2 s", **QUICK)
    # The motion is free: it needs no torque, but for the interpolation of its samples.
    torque = forces["rod.angle_force"]
    assert torque.unit == "N*m"
    assert np.abs(torque).max() < 1e-3


def test_contact_geometry_of_cones():
    found = vd.contact_geometry(
        "cone:1/20", "60E1", inclination=0.0, shifts=["-2 mm", "0 mm", "2 mm"], amplitudes=[1e-3]
    )
    assert found["conicity"].values == pytest.approx([0.05], rel=1e-3)
    assert found["shift"].values == pytest.approx([-2e-3, 0.0, 2e-3])


def test_sweep_of_a_scenario_in_memory():
    short = vd.load("quarter_car").changed(duration="0.1 s")
    study = vd.sweep(
        short, vary={"parameters.body.mass": ["200 kg", "300 kg"]}, channels=["body.*"],
        workers=1, **QUICK,
    )  # fmt: skip
    assert study["parameters.body.mass"].values.tolist() == [200.0, 300.0]
    assert study["body.height"].dims == ("case", "time")
    single = vd.simulate(short.changed({"parameters.body.mass": "200 kg"}), **QUICK)
    assert study["body.height"][0] == pytest.approx(single["body.height"].values, abs=1e-9)
    assert study.to_dataframe().shape[0] == 2
    assert len(study.plot("body.height").axes[0].lines) == 2


def test_sweep_of_a_system_file_beside_which_one_stands(tmp_path, monkeypatch):
    """Its usual run is no file, whatever is called like it."""
    monkeypatch.chdir(tmp_path)
    text = "title: T\nparameters: {k: {value: 9 N/m}}\nbodies: {a: {joints: [T1 x], mass: 1 kg}}\n"
    force = "springs: {s: {coordinate: a.x, law: {kind: spring_damper, stiffness: k}}}\n"
    (tmp_path / "own.yaml").write_text(f"{text}{force}initial: {{a.x: 1 m}}\n", encoding="utf-8")
    found = vd.sweep(
        "own.yaml", vary={"k": ["1 N/m", "4 N/m"]}, duration="0.1 s", workers=1,
        backend="interpreted",
    )  # fmt: skip
    assert found["a.x"].values[:, -1] == pytest.approx(np.cos([0.1, 0.2]), rel=1e-6)


def test_limit_cycles_with_critical_values_in_their_units(tmp_path):
    row = CycleRow(1, 50.0, 0.2, True, "", 1.0, np.ones(2), np.array([-1.0]), np.array([1.0]),
                   np.zeros((3, 1)))  # fmt: skip
    speed, channel = Quantity("speed", "m/s", "Speed"), Quantity("y", "m", "Lateral")
    write_hunt(
        tmp_path / "hunt.h5",
        HuntTable(
            "Hunting", "wheelset", speed, (channel,), np.array([40.0]), np.ones((1, 2)) * 1j,
            (row, row), (), {"linear_critical": 61.0}, "ok", "",
        ),
    )  # fmt: skip
    found = vd.open_result(tmp_path / "hunt.h5")
    assert (found.summary["linear_critical"].value, found.summary["linear_critical"].unit) == (
        61.0, "m/s",
    )  # fmt: skip
    assert found["cycle_greatest"].dims == ("cycle", "channel")
    assert found["eigenvalue"].values.tolist() == [[1j, 1j]]
    assert found.to_dataframe()["cycle_parameter"].tolist() == [50.0, 50.0]


def test_comparison_of_values():
    one, two = (vd.simulate(pendulum(a), duration="0.1 s", **QUICK) for a in (0.5, 0.6))
    assert vd.compare(one, one).is_equal
    found = vd.compare(two, one, channels="rod.*")
    assert not found
    assert repr(found).startswith("different:")
    with pytest.raises(vd.InputError, match="no such file"):
        vd.compare(one, "nothing.h5")


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: vd.equilibrium("quarter_car", speed="3 kg"), "speed='3 kg': '3 kg' has the wrong"),
        (lambda: vd.modes("quarter_car", speed=[-1.0]), "speed=-1.0: must not be negative"),
        (lambda: vd.response("quarter_car", "road", "body.height"), "inputs='road': the model has"),
        (lambda: vd.response("quarter_car", [], "body.height"), "inputs=[]: give one name or more"),
        (
            lambda: vd.response("quarter_car", "road.height", "body.height", first=9, last=3),
            "first=9.0 last=3.0: give a range",
        ),
        (lambda: vd.kinematics("four_bar", {"x": (1, 2)}), "drives={'x': (1, 2)}: write"),
        (lambda: vd.kinematics(pendulum()), "nothing is driven; give drives"),
        (lambda: vd.hunt("rail_wheelset", "9 m/s", "5 m/s"), "first='9 m/s' last='5 m/s': the fir"),
        (lambda: vd.sweep("quarter_car", workers=1), "no study named 'quarter_car'"),
        (lambda: vd.sweep(pendulum()), "vary: missing: say what varies"),
        (lambda: vd.sweep(pendulum(), vary={"width": ["1 m"]}), "width"),
        (lambda: vd.sweep("quarter_car", vary={"x": [1]}, cases={}), "vary and cases: give one"),
        (lambda: vd.contact_geometry("S1002", "60E1", gauge="0 m"), "gauge='0 m': must be above"),
        (lambda: vd.contact_geometry("S1002", "60E1", inclination="x"), "inclination='x': write"),
    ],
)
def test_messages_name_the_argument(call, words):
    with pytest.raises(vd.InputError) as caught:
        call()
    assert words in str(caught.value)
    assert not re.search(r"(^|[\s'(])--?[a-z]", str(caught.value))


def test_nothing_below_the_command_line_names_an_option():
    option = re.compile(r"""["'`(\s]--[a-z][a-z-]+""")
    allowed = ("cli", "toolchain")
    found = [
        f"{path.relative_to(PACKAGE)}: {line.strip()}"
        for path in PACKAGE.rglob("*.py")
        if not set(allowed) & set(path.relative_to(PACKAGE).parts)
        for line in path.read_text(encoding="utf-8").splitlines()
        if option.search(line) and "--fmad" not in line
    ]
    assert found == []
