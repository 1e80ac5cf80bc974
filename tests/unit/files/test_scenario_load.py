import re
from pathlib import Path

import pytest
from small_catalogue import SCENARIO, BrokenCart, Preview, Rigid

from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_model, load_scenario


def problems(path, overrides=()):
    """Return the lines of the refusal without the file's name; check the last line."""
    with pytest.raises(InputError) as refused:
        load_scenario(path, overrides)
    *lines, last = str(refused.value).splitlines()
    count = "1 problem" if len(lines) == 1 else f"{len(lines)} problems"
    assert last == f"{count} in {path}"
    return [line.removeprefix(f"{path}:") for line in lines]


def line_of(text, needle):
    return text[: text.index(needle)].count("\n") + 1


def test_good_scenario_is_resolved_to_si(write):
    path = write()
    loaded = load_scenario(path)
    assert loaded.text == SCENARIO
    assert loaded.scenario.speed == pytest.approx(10.0, rel=1e-15)
    assert loaded.scenario.manoeuvre.driver == Preview(preview=0.5)
    assert loaded.scenario.tyres.front is loaded.scenario.tyres.rear
    assert loaded.written.parameters.chassis.mass == 1200.0
    assert loaded.written.parameters.chassis.centre == (0.1, 0.0, 0.5)
    assert loaded.resolved["solver"] == {"kind": "fixed", "step": 0.001}
    assert loaded.resolved["parameters"]["chassis"]["mass"] == 1200.0
    assert loaded.units["parameters.chassis.mass"] == "kg"
    assert loaded.units["tyres.rear.stiffness"] == "N"


def test_every_quantity_in_the_resolved_scenario_has_a_unit(write):
    loaded = load_scenario(write())

    def numbers(value, name):
        if isinstance(value, dict):
            for key, item in value.items():
                yield from numbers(item, f"{name}.{key}" if name else key)
        elif isinstance(value, float) or (isinstance(value, list) and name.endswith("centre")):
            yield name

    named = set(numbers(loaded.resolved, ""))
    assert {"parameters.chassis.centre", "manoeuvre.driver.preview", "speed"} <= named
    assert named <= set(loaded.units)


def test_tyres_by_axle(write):
    tyres = "tyres: {front: {kind: rigid}, rear: {kind: linear, stiffness: 1 N}}"
    loaded = load_scenario(write(("tyres: {kind: linear, stiffness: 30 kN}", tyres)))
    assert loaded.scenario.tyres.front == Rigid()
    assert loaded.scenario.tyres.rear.stiffness == 1.0


def test_optional_parts_may_be_absent(write):
    path = write(
        ("tyres: {kind: linear, stiffness: 30 kN}\n", ""),
        ("road:\n  kind: flat\n", ""),
        ("wheel_spin: free\n", ""),
        ("parameters:\n  chassis:\n    mass: 1.2 t\n", "parameters:\n"),
    )
    scenario = load_scenario(path).scenario
    assert (scenario.tyres, scenario.road, scenario.wheel_spin) == (None, None, None)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("speed: 36", "sped: 36", ["1:1: speed: missing: Speed at the start, in m/s",
         "16:1: sped: unknown key; did you mean 'speed'?"]),
        ("speed: 36 km/h", "speed: 36 kg", ["16:8: speed: '36 kg' has the wrong unit: "
         "a quantity in m/s is needed here"]),
        ("speed: 36 km/h", "speed: -1", ["16:8: speed: must be at least 0 m/s, is -1.0"]),
        ("speed: 36 km/h", "speed: .nan", ["16:8: speed: expected a finite number, found 'nan'"]),
        ("speed: 36 km/h", "speed: 1e999", ["16:8: speed: expected a finite number, found 'inf'"]),
        ("model: cart", "model: [cart]", ["2:8: model: expected a text, found a list"]),
        ("kind: slalom", "kind: slalm", ["10:9: manoeuvre.kind: no manoeuvre named 'slalm'; "
         "did you mean 'slalom'? Known: slalom"]),
        ("  kind: slalom\n", "", ["9:1: manoeuvre.kind: missing: the kind of manoeuvre. "
         "Known: slalom"]),
        ("kind: preview", "kind: fixed_whel", ["13:11: manoeuvre.driver.kind: no driver named "
         "'fixed_whel'; did you mean 'fixed_wheel'? Known: fixed_wheel, preview"]),
        ("{kind: linear, stiffness: 30 kN}", "{kind: lineer, stiffness: 3}",
         ["6:15: tyres.kind: no tyre named 'lineer'; did you mean 'linear'? "
          "Known: linear, rigid"]),
        ("{kind: linear, stiffness: 30 kN}", "{front: {kind: rigid}}",
         ["6:1: tyres.rear: missing: Tyres of the rear axle"]),
        ("{kind: linear, stiffness: 30 kN}", "{kind: linear, stiffness: 30 N, rear: 1}",
         ["6:1: tyres.front: missing: Tyres of the front axle",
          "6:9: tyres.kind: unknown key. Known: front, rear",
          "6:23: tyres.stiffness: unknown key. Known: front, rear",
          "6:46: tyres.rear: expected a mapping with 'kind', found '1'"]),
        ("wheel_spin: free", "wheel_spin: fre", ["15:13: wheel_spin: must be 'free' or "
         "'prescribed', is 'fre'; did you mean 'free'?"]),
        ("mass: 1.2 t", "mass: -1", ["5:11: parameters.chassis.mass: must be greater than 0 kg, "
         "is -1.0"]),
        ("mass: 1.2 t", "mas: 1", ["5:5: parameters.chassis.mas: unknown key; "
         "did you mean 'mass'?"]),
        ("mass: 1.2 t", "inertia: [1, 1, 3]", ["4:3: parameters.chassis: the inertia breaks the "
         "triangle inequality"]),
        ("mass: 1.2 t", "centre: {y: 1 kg}", ["5:17: parameters.chassis.centre[1]: '1 kg' has "
         "the wrong unit: a quantity in m is needed here"]),
        ("mass: 1.2 t", "centre: {w: 1}", ["5:14: parameters.chassis.centre.w: unknown "
         "component. Known: x, y, z"]),
        ("step: 1 ms", "step: 3 ms", ["20:9: solver.step: 0.003 s does not divide the output "
         "interval of 0.01 s; take 0.0025 s"]),
        ("interval: 10 ms", "interval: 13 s", ["22:13: output.interval: 13 s is longer than the "
         "duration of 12 s"]),
        ("duration: 12 s", "duration: 12.004 s", ["17:11: duration: 12.004 s is no whole number "
         "of output intervals of 0.01 s; take 12 s"]),
        ("duration: 12 s", "duration: 12 s\nduration: 13 s", ["18:1: duration: given twice; the "
         "first is in line 17"]),
        ("[chassis.*]", "chassis.*", ["23:13: output.channels: expected a list, found "
         "'chassis.*'"]),
    ],
)  # fmt: skip
def test_each_problem_has_its_line(write, old, new, told):
    assert problems(write((old, new))) == told


def test_an_unknown_model_is_told_with_those_of_catalogue_and_library(write):
    (line,) = problems(write(("model: cart", "model: card")))
    assert line.startswith("2:8: model: no model named 'card'; did you mean 'cart'? Known: ")
    assert {"cart", "broken_cart", "bicycle"} <= set(line.partition("Known: ")[2].split(", "))


def test_lines_are_those_of_the_file(write):
    """The lines above are counted by hand; count two of them from the text."""
    assert line_of(SCENARIO, "speed:") == 16
    assert line_of(SCENARIO, "interval:") == 22


def test_all_problems_come_at_once_sorted_by_position(write):
    path = write(
        ("title: A", "titel: A"),
        ("mass: 1.2 t", "mass: 0"),
        ("stiffness: 30 kN", "stiffness: 30 m"),
        ("preview: 0.5 s", "preview: 0"),
        ("wheel_spin: free", "wheel_spin: loose"),
        ("step: 1 ms", "step: 3 ms"),
        ("channels:", "chanels:"),
    )
    found = problems(path)
    fields = [re.match(r"(\d+):(\d+): ([\w.]+): ", line).groups() for line in found]
    assert [name for *_, name in fields] == [
        "title", "titel", "parameters.chassis.mass", "tyres.stiffness",
        "manoeuvre.driver.preview", "wheel_spin", "solver.step", "output.chanels",
    ]  # fmt: skip
    places = [(int(line), int(column)) for line, column, _ in fields]
    assert places == sorted(places)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "the file is empty"),
        ("# nothing\n", "the file is empty"),
        ("[1, 2]", "the file holds a list"),
        ("scenario", "the file holds 'scenario'"),
    ],
)
def test_a_scenario_is_a_mapping(write, text, told):
    (line,) = problems(write(text=text))
    assert line.startswith(f"1:1: file: {told}; a scenario is a mapping")


def test_problems_of_the_default_parameters_point_to_their_file(write, tmp_path):
    own = tmp_path / "own.yaml"
    own.write_text(
        "chassis:\n  mass: 0\n  centre: [0, 0, 0]\n  inertia: [1, 1, 1]\n"
        "controller: {kind: fixed_wheel, angle: 0}\n"
    )
    BrokenCart.parameter_file = own
    path = write(
        ("model: cart", "model: broken_cart"),
        ("mass: 1.2 t", "centre: {x: 1 s}"),
    )
    with pytest.raises(InputError) as refused:
        load_scenario(path)
    assert str(refused.value).splitlines() == [
        f"{path}:5:17: parameters.chassis.centre[0]: '1 s' has the wrong unit: "
        "a quantity in m is needed here",
        f"{own}:1:1: wheel_radius: missing: Radius of the wheels, in m",
        f"{own}:2:9: chassis.mass: must be greater than 0 kg, is 0.0",
        f"3 problems in {path}",
    ]


def test_a_part_of_another_kind_replaces_the_default(write):
    change = "controller: {kind: preview, preview: 1 s}\n  chassis:"
    loaded = load_scenario(write(("chassis:", change)))
    assert loaded.written.parameters.controller == Preview(preview=1.0)


def test_overrides_win_and_are_applied_in_order(write):
    overrides = [
        "speed=20 m/s", "speed = 30 m/s", "parameters.chassis.centre.z=0.7 m",
        "parameters.chassis.inertia=[3 kg m^2, 3 kg m^2, 3 kg m^2]", "output.channels.0=wheel.*",
        "manoeuvre.driver={kind: fixed_wheel, angle: 90 deg}", "road=", "title=1'",
        "parameters.wheel_radius=31 cm",
    ]  # fmt: skip
    loaded = load_scenario(write(), overrides)
    assert loaded.scenario.speed == 30.0
    assert loaded.written.parameters.chassis.centre == (0.1, 0.0, 0.7)
    assert loaded.written.parameters.chassis.inertia == (3.0, 3.0, 3.0)
    assert loaded.written.parameters.wheel_radius == pytest.approx(0.31, rel=1e-15)
    assert loaded.scenario.output.channels == ("wheel.*",)
    assert loaded.scenario.manoeuvre.driver.angle == pytest.approx(1.5707963, abs=1e-7)
    assert loaded.scenario.road is None
    assert loaded.overrides == tuple(overrides)
    assert loaded.text == SCENARIO


def test_defaults_of_the_model_stay_as_they_are(write):
    load_scenario(write(), ["parameters.chassis.centre.z=0.7 m"])
    assert load_scenario(write()).written.parameters.chassis.centre == (0.1, 0.0, 0.5)


@pytest.mark.parametrize(
    ("override", "told"),
    [
        ("speed", "speed: write key=value, such as speed='36 km/h'"),
        ("=3", "=3: write key=value, such as speed='36 km/h'"),
        ("speed=-1", "speed: must be at least 0 m/s, is -1.0"),
        ("speed=[", "speed: '[' is not a YAML value; put a text in quotes"),
        ("sped=1", "sped: unknown key; did you mean 'speed'?"),
        ("title.x=1", "title.x: 'title' is 'A cart drives around cones' and has no 'x'"),
        ("solver.kind=fixd", "solver.kind: no solver named 'fixd'; did you mean 'fixed'? "
         "Known: adaptive, fixed"),
        ("solver={kind: adaptive}", "solver: solver.relative_tolerance: missing: "
         "Relative tolerance"),
        ("solver.step=7", "solver.step: 7 has no unit; write '7 s'"),
        ("solver.step=7 ms", "solver.step: 0.007 s does not divide the output interval of "
         "0.01 s; take 0.005 s"),
        ("parameters.chasis.mass=1", "parameters.chasis.mass: parameters.chasis: "
         "unknown key; did you mean 'chassis'?"),
        ("parameters.chassis.mass=1 N", "parameters.chassis.mass: '1 N' has the wrong "
         "unit: a quantity in kg is needed here"),
        ("parameters.chassis.centre.y=1 N", "parameters.chassis.centre.y: '1 N' has the "
         "wrong unit: a quantity in m is needed here"),
        ("parameters.chassis.inertia.x=99", "parameters.chassis.inertia.x: "
         "parameters.chassis: the inertia breaks the triangle inequality"),
        ("parameters.controller.angle=x", "parameters.controller.angle: expected a number "
         "with a unit of rad, found 'x'"),
    ],
)  # fmt: skip
def test_problems_of_overrides_name_the_key(write, override, told):
    assert problems(write(), [override]) == [told]


def test_an_override_repairs_the_file(write):
    path = write(("speed: 36 km/h", "speed: fast"))
    assert load_scenario(path, ["speed=3 m/s"]).scenario.speed == 3.0


def test_problems_of_the_file_come_before_those_of_options(write):
    found = problems(write(("duration: 12 s", "duration: 0")), ["speed=-1"])
    assert [line.partition(" ")[0] for line in found] == ["17:11:", "speed:"]


@pytest.mark.parametrize("step", ["1e-300", "1e-12"])
def test_absurd_steps_are_refused(write, step):
    (line,) = problems(write(("step: 1 ms", f"step: {step} s")))
    assert "too short" in line


def test_model_on_its_own(catalogue):
    loaded = load_model("cart", ["parameters.chassis.mass=2 t"])
    assert loaded.written.parameters.chassis.mass == 2000.0


@pytest.mark.parametrize(
    ("name", "overrides", "words"),
    [
        ("card", [], "did you mean 'cart'"),
        ("cart", ["speed=3"], "speed: only 'parameters' of a model can be set"),
        ("cart", ["parameters.chassis.mass=0"], "must be greater than 0 kg"),
        ("cart", ["parameters=3"], "parameters: expected a mapping, found '3'"),
    ],
)
def test_model_on_its_own_refuses(catalogue, name, overrides, words):
    with pytest.raises(InputError) as refused:
        load_model(name, overrides)
    assert words in str(refused.value)


@pytest.mark.parametrize("key", ["tyres.front.lateral.a2", "parameters.tyres.front.lateral.a2"])
def test_tyres_are_set_by_the_names_that_models_show_prints(key):
    """Tyres that a file gives once for both axles are parted."""
    slalom = Path(__file__).parents[3] / "scenarios" / "iltis_slalom.yaml"
    tyres = load_scenario(slalom, (f"{key}=900 N/kN",)).scenario.tyres
    before = load_scenario(slalom).scenario.tyres
    assert tyres.front.lateral.a2 == pytest.approx(900.0)
    assert tyres.rear == before.rear
    assert tyres.front.lateral.a1 == before.front.lateral.a1
    with pytest.raises(InputError, match=r"tyres.front.lateral.nosuch: unknown key"):
        load_scenario(slalom, (f"{key.replace('a2', 'nosuch')}=1",))


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("speed: 36 km/h", "speed: 72", "16:8: speed: 72 has no unit; "
         "write '72 m/s' or '72 km/h'"),
        ("speed: 36 km/h", "speed: '72'", "16:8: speed: 72 has no unit; "
         "write '72 m/s' or '72 km/h'"),
        ("mass: 1.2 t", "mass: 1200", "4:13: parameters.chassis.mass: 1200 has no unit; "
         "write '1200 kg'"),
        ("mass: 1.2 t", "centre: {y: 0.1}", "5:17: parameters.chassis.centre.y: 0.1 has no unit; "
         "write '0.1 m'"),
        ("step: 1 ms", "step: 1e-3", "20:9: solver.step: 0.001 has no unit; write '0.001 s'"),
    ],
)  # fmt: skip
def test_numbers_need_their_unit(write, old, new, told):
    """A speed of 72 would be taken as m/s by the program and read as km/h by a person."""
    (line,) = problems(write((old, new)))
    assert line.partition(": ")[2] == told.partition(": ")[2]


def test_numbers_of_options_need_their_unit_too(write):
    assert problems(write(), ["speed=72"]) == ["speed: 72 has no unit; write '72 m/s' or '72 km/h'"]
    with pytest.raises(InputError, match=r"^chassis\.mass: 1200 has no unit; write"):
        load_model("cart", ["chassis.mass=1200"])


def test_zero_and_pure_numbers_need_none(write):
    loaded = load_scenario(write(), ["speed=0", "parameters.chassis.centre=[0, 0, 0]"])
    assert loaded.scenario.speed == 0.0


PENDULUM = """\
title: x
model: double_pendulum
duration: 1 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ("initial: {upper.angle: 0.3}", "6:24: initial.upper.angle: 0.3 has no unit; "
         "write '0.3 rad' or '0.3 deg'"),
        ("initial: {upper: {angle: 0.3}}", "6:26: initial.upper.angle: 0.3 has no unit; "),
        ("initial: {lower.angle_rate: 2}", "6:29: initial.lower.angle_rate: 2 has no unit; "
         "write '2 rad/s' or '2 deg/s'"),
        ("motion: {upper.angle: 0.5}", "6:23: motion.upper.angle: 0.5 has no unit; "),
        ("motion: {upper.angle: {kind: ramp, last: 2, begin: 0 s, duration: 1 s}}",
         "6:23: motion.upper.angle: 2 has no unit; write '2 rad' or '2 deg'"),
    ],
)  # fmt: skip
def test_starts_and_motions_need_their_unit(tmp_path, section, words):
    path = tmp_path / "s.yaml"
    path.write_text(f"{PENDULUM}{section}\n", encoding="utf-8")
    (found,) = problems(path)
    assert found.startswith(words)
    path.write_text(f"{PENDULUM}initial: {{upper.angle: 0, lower.angle_rate: 0.2 rad/s}}\n")
    assert load_scenario(path).scenario.initial["lower.angle_rate"] == "0.2 rad/s"


def test_numbers_without_units_are_reported_beside_what_else_is_wrong(write):
    found = problems(write(("duration: 12 s", "duration: -1")), ["speed=3", "road.kind=flatt"])
    assert sorted(re.sub(r"^[\d:]+ ", "", line).partition(":")[0] for line in found) == [
        "duration",
        "road.kind",
        "speed",
    ]
    assert any("3 has no unit; write '3 m/s'" in line for line in found)
