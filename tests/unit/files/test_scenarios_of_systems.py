"""Scenarios that name a system file: what goes with it, what does not, and how runs start."""

import json
from pathlib import Path

import numpy as np
import programs
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.linear.eigenmodes import find_modes
from vehicledyn.analyses.linear.equilibrium import find_equilibrium
from vehicledyn.analyses.mechanism.kinematics import Request, sweep_kinematics
from vehicledyn.analyses.preparation.prepare import prepare, start_point
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import is_system_file, load_model, load_scenario
from vehicledyn.files.system.read import read_system
from vehicledyn.results.store.reader import open_result

SYSTEM = """\
title: A slider-crank
parameters: {radius: 0.1 m, rod: 0.3 m}
bodies:
  crank: {joints: [R2 angle], mass: 1 kg, inertia: [0.1 kg*m^2, 0.1 kg*m^2, 0.1 kg*m^2]}
  rod: {parent: crank, at: [radius, 0, 0], joints: [R2 angle], mass: 1 kg, com: [rod / 2, 0, 0],
        inertia: [0, 0.01 kg*m^2, 0.01 kg*m^2]}
  slider: {joints: [{kind: T1, name: x, role: independent}], mass: 1 kg}
cuts: {pin: {kind: ball, a: {body: rod, point: [rod, 0, 0]}, b: slider}}
initial: {slider.x: 0.3 m, crank.angle: 70 deg, rod.angle: -90 deg}
"""
SCENARIO = """\
title: It moves
model: sub/system.yaml
duration: 0.1 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""


@pytest.fixture
def write(tmp_path):
    def write_files(scenario=SCENARIO, system=SYSTEM):
        (tmp_path / "sub").mkdir(exist_ok=True)
        (tmp_path / "sub" / "system.yaml").write_text(system, encoding="utf-8")
        path = tmp_path / "scenario.yaml"
        path.write_text(scenario, encoding="utf-8")
        return path

    return write_files


def refusal(path, overrides=()):
    with pytest.raises(InputError) as refused:
        load_scenario(path, overrides)
    return str(refused.value).replace(f"{path.parent}/", "").splitlines()


def test_model_is_found_from_the_scenario_and_its_parameters_are_told(write):
    loaded = load_scenario(write(), ["radius=0.12 m", "initial.slider.x=0.31 m"])
    assert loaded.written.name == "system"
    assert loaded.resolved["parameters"] == {"radius": 0.12, "rod": 0.3}
    assert loaded.units["parameters.radius"] == "m"
    assert loaded.resolved["system"] == SYSTEM
    assert is_system_file(loaded.written.path) and not is_system_file(loaded.path)


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("speed: 3 m/s", "6:1: speed: system.yaml has no wheels on a road; leave"),
        ("road: {kind: flat}", "6:1: road: system.yaml has no wheels on a road; leave"),
        ("tyres: {kind: linear, nominal_load: 1, cornering_stiffness: 1}", "6:1: tyres"),
        ("manoeuvre: {kind: straight}", "6:1: manoeuvre: system.yaml has no section 'vehicle'"),
        ("start: steady", "6:1: start: 'steady' is for vehicles; take 'nominal' or 'static'"),
        ("initial: {slider.y: 1}", "6:21: initial.slider.y: no coordinate named 'slider.y'"),
        ("parameters: {radious: 1 m}", "6:14: parameters.radious: no such parameter; did you"),
        ("parameters: {radius: 1 kg}", "6:22: parameters.radius: this is in kg, the parameter"),
    ],
)
def test_what_does_not_go_with_a_system_is_told_with_its_line(write, line, told):
    lines = refusal(write(SCENARIO + line + "\n"))
    assert any(text.startswith(f"scenario.yaml:{told}") for text in lines), lines


def test_a_speed_of_its_own_is_named(write):
    system = SYSTEM.replace("rod: 0.3 m", "rod: 0.3 m, speed: 2 m/s")
    lines = refusal(write(SCENARIO + "speed: 3 m/s\n", system))
    assert any(line.endswith("its own is 'parameters.speed'") for line in lines), lines


def test_problems_of_both_files_come_at_once(write):
    path = write(SCENARIO.replace("0.1 s", "fast"), SYSTEM.replace("at: [radius", "at: [raduis"))
    lines = refusal(path)
    assert lines[0].startswith("scenario.yaml:3:11: duration: ")
    assert lines[1].startswith("sub/system.yaml:5:28: bodies.rod.at: no quantity named 'raduis'")
    assert lines[-1] == "2 problems in scenario.yaml"


def test_missing_file_and_initial_of_a_vehicle(write):
    (line, _) = refusal(write(SCENARIO.replace("sub/", "")))
    assert line.startswith("scenario.yaml:2:8: model: ")
    assert "there is no such file" in line
    lines = refusal(write(SCENARIO.replace("sub/system.yaml", "iltis") + "initial: {a: 1}\n"))
    assert any("initial: only for system files" in text for text in lines)
    assert any("manoeuvre: missing: What the vehicle does" in text for text in lines)


def ready(path, *overrides):
    loaded = load_scenario(path, overrides)
    prepared = prepare(loaded, backend="interpreted", progress=lambda *_: None)
    return loaded, prepared


def channels(prepared, point):
    values = prepared.kernel.outputs(0.0, point.state, point.unknowns)
    return dict(zip((c.name for c in prepared.equations.channels), values, strict=True))


def test_rates_may_be_given_to_dependent_coordinates(write):
    loaded, prepared = ready(write(), "initial.crank.angle_rate=5 rad/s")
    point = start_point(prepared, 0.0, loaded.scenario.start)
    seen = channels(prepared, point)
    assert prepared.equations.structure["independent"] == ["slider.x"]
    assert seen["slider.x"] == 0.3
    assert seen["crank.angle_rate"] == pytest.approx(5.0, rel=1e-12)
    crank, rod = seen["crank.angle"], seen["crank.angle"] + seen["rod.angle"]
    assert 0.1 * np.sin(crank) + 0.3 * np.sin(rod) == pytest.approx(0.0, abs=1e-12)
    rod_rate = -0.1 * np.cos(crank) * 5.0 / (0.3 * np.cos(rod))
    wanted = -0.1 * np.sin(crank) * 5.0 - 0.3 * np.sin(rod) * rod_rate
    assert seen["slider.x_rate"] == pytest.approx(wanted, rel=1e-10)


def test_rates_that_contradict_the_constraints_are_named(write):
    rates = ["initial.crank.angle_rate=5 rad/s", "initial.slider.x_rate=3 m/s"]
    loaded, prepared = ready(write(), *rates)
    with pytest.raises(InputError, match=r"'crank.angle' is given 286.5 deg/s, the constraints"):
        start_point(prepared, 0.0, loaded.scenario.start)


def test_static_start_is_an_equilibrium_with_the_given_rates(write):
    text = SYSTEM + "springs: {s: {coordinate: slider.x, law: {kind: spring_damper, "
    path = write(system=text + "stiffness: 900 N/m, free_length: 0.32 m}}}\n")
    loaded, prepared = ready(path, "start=static", "initial.slider.x_rate=0.2 m/s")
    point = start_point(prepared, 0.0, loaded.scenario.start)
    assert point.residual < 1e-9
    assert channels(prepared, point)["slider.x_rate"] == pytest.approx(0.2, rel=1e-12)
    assert channels(prepared, point)["slider.x"] != pytest.approx(0.3, abs=1e-3)


HANGING = """\
title: A double pendulum on a cart
bodies:
  cart: {joints: [T1 x], mass: 2 kg}
  upper: {parent: cart, joints: [R2 angle], mass: 1 kg, com: [0, 0, -0.3 m],
          inertia: [0.03 kg*m^2, 0.03 kg*m^2, 0]}
  lower: {parent: upper, at: [0, 0, -0.6 m], joints: [R2 angle], mass: 1 kg, com: [0, 0, -0.3 m],
          inertia: [0.03 kg*m^2, 0.03 kg*m^2, 0]}
sensors: {hook: {kind: reaction, body: upper, axes: world, shows: [force]}}
initial: {upper.angle: 60 deg, lower.angle: 40 deg, upper.angle_rate: 5 rad/s}
"""


def test_the_equilibrium_of_pendulums_is_the_near_one_and_at_rest(write):
    model = load_model(str(write(system=HANGING).parent / "sub" / "system.yaml"))
    found = find_equilibrium(model, speed=None, backend="interpreted", progress=lambda *_: None)
    angles = {row.name: row.equilibrium for row in found.coordinates}
    assert angles == pytest.approx(dict.fromkeys(angles, 0.0), abs=1e-9)
    force = {row.name: row.equilibrium for row in found.forces}
    assert force["hook.force_z"] == pytest.approx(2.0 * 9.81, rel=1e-12)


def test_modes_of_a_system_tell_no_speed(write):
    model = load_model(str(write(system=HANGING).parent / "sub" / "system.yaml"))
    found = find_modes(model, speeds=[], backend="interpreted", progress=lambda *_: None)
    assert found.as_text().startswith("system: 2 zeros, 2 undamped\n")


def test_a_system_in_place_of_a_scenario_says_what_to_write(write):
    told = refusal(write().parent / "sub" / "system.yaml")
    assert told == [
        "system.yaml:1:1: file: this is a system; name it in a scenario as 'model: system.yaml', "
        "with duration and solver",
        "1 problem in system.yaml",
    ]


def test_kinematics_knows_switches(write, tmp_path):
    text = (
        SYSTEM.replace(", role: independent", "")
        + "switches: {held: 1}\nforces: {f: {coordinate: slider.x, force: 2 N * held}}\n"
    )
    model = load_model(str(write(system=text).parent / "sub" / "system.yaml"))
    wish = Request({"crank.angle": "60 deg:70 deg:2"})
    sweep_kinematics(model, wish, output=tmp_path / "k.h5", progress=lambda *_: None)
    with open_result(tmp_path / "k.h5") as result:
        found = np.degrees(result.channel("crank.angle").values)
    assert found == pytest.approx([60.0, 65.0, 70.0])


def test_verbs_on_a_system_file(write):
    system = write().parent / "sub" / "system.yaml"

    def call(*arguments):
        done = programs.call(["vehicledyn", *arguments], system.parent)
        return done.returncode, done.stdout, done.stderr

    assert call("validate", str(system))[:2] == (0, f"{system}: ok\n")
    code, out, _ = call("models", "show", str(system), "--json", "--backend", "interpreted")
    shown = json.loads(out)
    assert (code, shown["degrees_of_freedom"], shown["summary"]) == (0, 1, "A slider-crank")
    code, out, _ = call("models", "show", str(system), "--yaml", "--set", "radius=0.2 m")
    assert code == 0 and "radius: 0.2 m" in out
    assert call("schema", "--of", "system")[1].startswith("{")
    code, out, err = call("validate", str(system), "--set", "radius=1 kg")
    assert code == 2 and "--set radius: this is in kg" in err


def test_model_on_its_own_refuses_other_changes(write):
    system = write().parent / "sub" / "system.yaml"
    with pytest.raises(InputError, match="duration: only 'parameters' of a model"):
        load_model(str(system), ["duration=3"])
    assert load_model(str(system), ["parameters.rod=0.4 m"]).written.resolved["rod"] == 0.4


def test_a_change_keeps_the_unit_of_its_parameter():
    """Another unit of the same quantity makes no other equations, and results compare."""
    path = Path(__file__).parents[3] / "systems" / "four_bar.yaml"
    for text in ("1 N*m*s", "1 N*m*s/rad", "1000 N*mm*s/deg"):
        system, problems = read_system(path, {"parameters": {"damping": text}})
        assert not problems
        assert system.units["damping"] == "N*m*s/rad"
