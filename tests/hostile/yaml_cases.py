"""Spoilt scenarios, systems and studies, and options and expressions that change whole ones."""

import functools
import re
from pathlib import Path

import mutations
from harness import Case

ROOT = Path(__file__).parents[2]
SYSTEMS = [
    "double_pendulum", "quarter_car", "four_bar", "slider_crank", "double_spring_mass",
    "bicycle", "rail_wheelset", "radiation_counter", "parallelogram", "rolling_disk",
    "ball_in_tube", "small_cart", "upright_disk", "simple_wheelset",
]  # fmt: skip
VEHICLES = ["iltis_ramp_steer", "iltis_slalom", "iltis_bump_in_phase", "s1002_uic60_geometry"]
SLOW = {
    *(f"scenarios/{name}.yaml" for name in VEHICLES),
    "systems/rail_wheelset.yaml",
    "scenarios/systems/rail_wheelset.yaml",
}
"""Files whose equations take a second: mostly checked, and computed once in a while."""

STUDY = """\
title: Pendulums
scenario: scenarios/systems/double_pendulum.yaml
set: {solver: {kind: rk4, step: 1 ms}, duration: 20 ms}
cases:
  kind: latin_hypercube
  number: 6
  seed: 5
  vary:
    parameters.length: {from: 0.5 m, to: 2 m}
    parameters.mass: {from: 500 g, to: 2 kg, scale: log}
output: {interval: 10 ms, channels: [upper.*]}
"""
GRID = """\
title: Roads and speeds
scenario: scenarios/iltis_ramp_steer.yaml
set: {duration: 10 ms}
cases:
  kind: grid
  vary:
    road: [{kind: flat}, {kind: plane, slope_x: 0, slope_y: 3 %}]
    speed: {from: 10 m/s, to: 20 m/s, count: 2}
output: {channels: [accelerometer.lateral], precision: single}
"""
LISTED = """\
title: Pendulums of a list
scenario: scenarios/systems/double_pendulum.yaml
set: {solver: {kind: rk4, step: 1 ms}, duration: 20 ms}
cases:
  kind: list
  rows:
    - {parameters.length: 1 m, initial.upper.angle: 3 deg}
    - {parameters.length: 2 m, initial.upper.angle: 0.1}
output: {channels: []}
"""
SHORT = [
    *("--set", "duration=20 ms", "--set", "output.interval=5 ms"),
    *("--set", "solver={kind: rk4, step: 1 ms}", "--backend", "interpreted", "--no-plots", "-q"),
]
RUN = ["run", "{}", "-o", "out.h5", *SHORT]
OUTPUTS = ("out.h5", "out.h5.checkpoint")
_ILTIS = re.compile(rb'(model"?: "?)iltis\b')


@functools.cache
def scenario_texts():
    names = [f"systems/{name}" for name in SYSTEMS] + VEHICLES
    return {f"scenarios/{n}.yaml": _text(f"scenarios/{n}.yaml") for n in names}


@functools.cache
def system_texts():
    return {f"systems/{name}.yaml": _text(f"systems/{name}.yaml") for name in SYSTEMS}


def study_texts():
    return {"study.yaml": STUDY, "grid.yaml": GRID, "listed.yaml": LISTED}


def _text(name):
    return (ROOT / name).read_text(encoding="utf-8")


@functools.cache
def _data(text):
    from vehicledyn.base.yaml import parse_yaml

    return parse_yaml(text, "seed").data


def _command(file, commands, rng):
    """Return one of the commands; for slow files mostly one that only checks."""
    command = rng.choice(commands)
    return ["validate", "{}"] if file in SLOW and rng.random() < 0.8 else command


@functools.cache
def _whole():
    whole = {**scenario_texts(), **system_texts()}
    return {name: text.encode() for name, text in whole.items()}


def around(files):
    """Return files with all whole scenarios and systems beside them."""
    return _whole() | files


def lighter(scenario, command):
    """Return a scenario on the Iltis on a smaller car where it is run: half the time."""
    is_run = command[0] in ("run", "sweep")
    return _ILTIS.sub(rb"\1small_car", scenario) if is_run else scenario


def _spoilt(texts, name, rng):
    way = rng.random()
    if way < 0.6:
        data = mutations._copy(_data(texts[name]))
        others = [_data(text) for text in texts.values()]
        for _ in range(rng.choice([1, 1, 2, 3])):
            if isinstance(data, dict):
                mutations.spoil_data(data, others, rng)
        return mutations.dump(data).encode("utf-8", "surrogatepass")
    if way < 0.85:
        return mutations.spoil_lines(texts[name], rng).encode("utf-8", "surrogatepass")
    return mutations.spoil_bytes(texts[name].encode(), rng)


def scenario(rng, name):
    texts = scenario_texts()
    file = rng.choice(list(texts))
    commands = [["validate", "{}"], ["validate", "{}"], RUN, RUN, ["eig", "{}"],
                ["equilibrium", "{}"]]  # fmt: skip
    command = _command(file, commands, rng)
    files = around({file: _spoilt(texts, file, rng)})
    return Case(name, files, [word.format(file) if "{}" in word else word for word in command],
                OUTPUTS)  # fmt: skip


def system(rng, name):
    texts = system_texts()
    file = rng.choice(list(texts))
    command = _command(file, [["validate", "{}"], ["validate", "{}"], ["eig", "{}"], RUN], rng)
    user = f"scenarios/{file}" if command is RUN else file
    files = around({file: _spoilt(texts, file, rng)})
    return Case(name, files, [word.format(user) if "{}" in word else word for word in command],
                OUTPUTS)  # fmt: skip


def study(rng, name):
    texts = study_texts()
    file = rng.choice(list(texts))
    sweep = ["sweep", file, "-o", "out.h5", "--workers", "1", "--backend", "interpreted", "-q",
             *SHORT[:6]]  # fmt: skip
    content = _spoilt(texts, file, rng)
    many = re.search(rb'(number|count)"?: *[0-9.e+]{4}', content)  # a sound study of a million
    command = ["validate", file] if many else rng.choice([["validate", file], sweep])
    car = "scenarios/iltis_ramp_steer.yaml"
    files = {file: content, car: lighter(scenario_texts()[car].encode(), command)}
    return Case(name, around(files), command, OUTPUTS)


def option(rng, name):
    """A whole scenario with hostile ``--set`` options."""
    texts = scenario_texts()
    file = rng.choice(list(texts))
    data = _data(texts[file])
    sets = []
    for _ in range(rng.choice([1, 1, 2, 4])):
        place = rng.choice(list(mutations.places(data)))
        key = ".".join(map(str, place)) if rng.random() < 0.8 else mutations.text(rng)
        item = mutations.value(rng) if rng.random() < 0.5 else mutations.near(
            mutations.get(data, place), rng
        )  # fmt: skip
        given = mutations.dump(item) if rng.random() < 0.6 else str(item)
        joint = rng.choice(["=", "=", "=", "", "=="])
        sets += ["--set", f"{key}{joint}{given}".replace("\0", "")]
    command = _command(file, [["validate", "{}"], RUN, ["eig", "{}"]], rng)
    command = [*(file if word == "{}" else word for word in command[:2]), *sets, *command[2:]]
    return Case(name, around({}), command, OUTPUTS)


ATOMS = ["1", "0", "2.5", "time", "length", "mass", "1 m", "3 deg", "1e308", "1e-308", "pi", "x",
         "upper.angle", "gravity", "upper.angle_rate"]  # fmt: skip
FUNCTIONS = ["sin", "cos", "tan", "sqrt", "exp", "log", "abs", "atan2", "min", "max", "tanh",
             "sign", "where", "floor", "asin", "smooth_abs", "eval", "step"]  # fmt: skip


def _expression(rng, depth):
    way = rng.random()
    if depth == 0 or way < 0.25:
        return rng.choice(ATOMS)
    if way < 0.6:
        first, second = (_expression(rng, depth - 1) for _ in range(2))
        return f"{first} {rng.choice(['+', '-', '*', '/', '^', '**', '%', '//'])} {second}"
    if way < 0.8:
        parts = ", ".join(_expression(rng, depth - 1) for _ in range(rng.choice([0, 1, 2, 3])))
        return f"{rng.choice(FUNCTIONS)}({parts})"
    return f"{rng.choice(['-', '(', '((', ''])}{_expression(rng, depth - 1)}" + rng.choice(
        ["", ")", "))"]
    )


def expression(rng, name):
    """A whole system, some of whose numbers are expressions that nobody would write."""
    texts = system_texts()
    file = rng.choice(list(texts))
    data = mutations._copy(_data(texts[file]))
    places = [p for p in mutations.places(data) if isinstance(mutations.get(data, p), str)]
    for _ in range(rng.choice([1, 2])):
        formula = _expression(rng, rng.choice([1, 2, 3, 4]))
        if rng.random() < 0.05:
            formula = rng.choice(
                [
                    "(" * 5000 + formula,
                    f"{formula}+" * 20_000 + "1",
                    "-" * 20_000 + "1",
                    "sin(" * 3000 + "1" + ")" * 3000,
                ]
            )
        mutations.put(data, rng.choice(places), formula)
    command = _command(file, [["validate", "{}"], ["eig", "{}"], RUN], rng)
    user = f"scenarios/{file}" if command is RUN else file
    files = around({file: mutations.dump(data).encode("utf-8", "surrogatepass")})
    return Case(name, files, [word.format(user) if "{}" in word else word for word in command],
                OUTPUTS)  # fmt: skip
