"""Impossible systems and unreadable files from the command line: message, place, exit code."""

import re
import sys

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.mass_checks import nearly_singular_mass
from vehicledyn.analyses.preparation.prepare import nominal_point, prepare
from vehicledyn.cli import main
from vehicledyn.files.scenario import load_scenario

SCENARIO = """\
title: t
model: system.yaml
duration: 50 ms
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""
ARM = "title: t\nbodies:\n  a: {joints: [R2 q], mass: 1 kg, com: [0, 0, 1 m]}\n"
BARS = """\
title: t
bodies:
  crank: {joints: [R2 q], mass: 1 kg, com: [0.1 m, 0, 0]}
  coupler: {parent: crank, at: [0.3 m, 0, 0], joints: [R2 q], mass: 1 kg, com: [0.1 m, 0, 0]}
  rocker: {at: [0.8 m, 0, 0], joints: [R2 q], mass: 1 kg, com: [0.1 m, 0, 0]}
cuts:
  pin:
    kind: ball
    a: {body: coupler, point: [0.9 m, 0, 0]}
    b: {body: rocker, point: [0.7 m, 0, 0]}
"""
START = "initial: {crank.q: -60 deg, coupler.q: 35 deg, rocker.q: -80 deg}\n"
TURNS = "title: t\nbodies:\n  a:\n    joints: [R3 a, R2 b, R3 c]\n    mass: 1 kg\n"
TURNS += "    inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]\n"
RAMP = "law: {kind: ramp, last: 1 rad, duration: 1 s}"


@pytest.fixture
def call(monkeypatch, capsys, tmp_path):
    """Write a system and its scenario and run a verb; return exit code, output and error."""
    monkeypatch.chdir(tmp_path)

    def run(verb, system, scenario=SCENARIO, *options):
        (tmp_path / "scenario.yaml").write_text(scenario)
        data = system if isinstance(system, bytes) else system.encode()
        (tmp_path / "system.yaml").write_bytes(data)
        file = "scenario.yaml" if verb == "run" else "system.yaml"
        more = ("--backend", "interpreted") if verb != "validate" else ()
        more += ("--no-plots", "-o", "result.h5") if verb == "run" else ()
        monkeypatch.setattr(sys, "argv", ["vehicledyn", verb, file, *more, *options])
        with pytest.raises(SystemExit) as end:
            main()
        captured = capsys.readouterr()
        return end.value.code, captured.out, captured.err

    return run


@pytest.mark.parametrize(
    ("system", "code", "start", "words"),
    [
        (ARM + "  b: {parent: a, at: [0, 1 m, 0], joints: [R2 q]}\n  c: {parent: b, at: "
         "[0, 1 m, 0], mass: 1 kg}\n", 2, "system.yaml:4:3: bodies.b: ",
         "the mass matrix is singular: nothing resists 'b.q' of body 'b'"),
        (TURNS, 2, "system.yaml:4:14: bodies.a.joints[0]: ",
         "singular at the start: nothing resists 'a.a' and 'a.c' of body 'a' moving together"),
        (BARS + "  rod: {kind: rod, a: ground, b: {body: coupler, point: [0.4 m, 0, 0]}, "
         "length: 0.6 m}\n" + START, 2, "system.yaml:7:3: cuts.pin: ",
         "the loop of 'pin' and 'rod' has no freedom"),
        (BARS.replace("0.9 m", "0.01 m").replace("0.7 m", "0.01 m") + START, 3,
         "system.yaml:7:3: cuts.pin: ", "the loops cannot be assembled: 'pin' by"),
        (ARM + "constraints:\n  one: {kind: expression, zero: a.q - 1}\n"
         "  two: {kind: expression, zero: a.q - 2}\n", 2, "system.yaml:5:3: constraints.one: ",
         "contradictory constraints: 'one' by 0.5 and 'two' by 0.5"),
        (BARS + f"drives:\n  d: {{coordinate: crank.q, {RAMP}}}\n"
         f"  e: {{coordinate: rocker.q, {RAMP}}}\n", 2, "system.yaml:7:3: cuts.pin: ",
         "as 'crank.q' and 'rocker.q' are driven"),
        (ARM + f"drives: {{d: {{coordinate: a.q, {RAMP}}}}}\n"
         "constraints: {hold: {kind: expression, zero: a.q}}\n", 2,
         "system.yaml:5:15: constraints.hold: ",
         "'a.q' is driven, but the constraints 'hold' leave it no freedom"),
        (BARS + START[:-2] + ", crank.q_rate: 1 rad/s, coupler.q_rate: 5 rad/s, "
         "rocker.q_rate: 7 rad/s}\n", 2,
         "system.yaml:11:67: initial.crank.q_rate: ", "'rocker.q' is given 401.1 deg/s"),
        (ARM + "sensors:\n  s: {kind: point, body: a}\n  s.x: {kind: expression, value: a.q, "
         "unit: rad}\n", 2, "system.yaml:6:3: sensors.s.x: ", "two parts give a channel"),
    ],
)  # fmt: skip
def test_impossible_systems_are_refused_with_their_lines(
    call, tmp_path, system, code, start, words
):
    found, out, err = call("run", system)
    assert (found, out) == (code, "")
    assert err.startswith(start) and words in err
    assert not (tmp_path / "result.h5").exists()


def test_every_part_in_question_has_a_line(call):
    system = BARS + "  pin_2: {kind: ball, a: {body: coupler, point: [0.9 m, 0, 0]}, "
    system += "b: {body: rocker, point: [0.75 m, 0, 0]}}\n" + START
    _, _, err = call("run", system)
    assert err.startswith("system.yaml:7:3: cuts.pin: contradictory constraints")
    assert err.endswith("('pin_2' is in line 11)\n")


@pytest.mark.parametrize("verb", ["eig", "equilibrium"])
def test_a_singular_start_of_an_equilibrium(call, verb):
    code, _, err = call(verb, TURNS)
    assert code == 2 and "nothing resists 'a.a' and 'a.c'" in err


def test_a_frame_without_freedom_has_an_equilibrium(call):
    code, out, _ = call("equilibrium", BARS + START + "constraints: {hold: {kind: expression, "
                        "zero: crank.q + 60 deg}}\n")  # fmt: skip
    assert code == 0 and "pin.force_x" in out


def test_redundant_constraints_are_told(call):
    system = ARM + "constraints:\n  one: {kind: expression, zero: a.q - 1}\n"
    code, _, err = call("run", system + "  two: {kind: expression, zero: 2 * a.q - 2}\n")
    assert code == 0
    assert re.search(r"redundant: 'one\.multiplier' follows from 'two\.multiplier'", err)


@pytest.mark.parametrize(
    ("scenario", "options", "lines"),
    [
        (SCENARIO.replace("interval: 10 ms", "interval: 10 ms, channels: [a.q, a.qq, b.*]"), (),
         ["scenario.yaml:5:43: output.channels[1]: 'a.qq' matches no channel; did you mean 'a.q'?",
          "scenario.yaml:5:49: output.channels[2]: 'b.*' matches no channel; there are 5, in a.*, "
          "energy.*, power.*"]),
        (SCENARIO.replace("interval: 10 ms", "interval: 10 ms, plots: [coordnates]"), (),
         ["scenario.yaml:5:35: output.plots[0]: no plot named 'coordnates'; did you mean "
          "'coordinates'? Known: coordinates, energy, rates"]),
        (SCENARIO, ("--set", "output.channels=[x]"),
         ["--set output.channels: output.channels[0]: 'x' matches no channel; there are 5, in a.*, "
          "energy.*, power.*"]),
    ],
)  # fmt: skip
def test_unknown_names_of_the_output_have_their_lines(call, tmp_path, scenario, options, lines):
    code, _, err = call("run", ARM, scenario, *options)
    assert code == 2 and not (tmp_path / "result.h5").exists()
    assert err.splitlines()[:-1] == lines


def test_a_failed_run_tells_what_hardly_resists(tmp_path):
    (tmp_path / "system.yaml").write_text(TURNS + "initial: {a.b: 0.5 rad}\n")
    path = tmp_path / "scenario.yaml"
    path.write_text(SCENARIO)
    prepared = prepare(load_scenario(path), backend="interpreted", progress=lambda *_: None)
    point = nominal_point(prepared, 0.0)
    assert nearly_singular_mass(prepared, 0.0, point.state, point.unknowns) == ""
    near = np.where(point.state == 0.5, 1e-4, point.state)
    told = nearly_singular_mass(prepared, 0.25, near, point.unknowns)
    assert told.startswith("near t = 0.25 s the mass matrix is almost singular: hardly anything")
    assert "'a.a' and 'a.c'" in told


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("title: t\nbodies:\n\ta: {}\n", "3:1: syntax: a tab cannot indent YAML"),
        (ARM + " b: {}\n", "4:2: syntax: expected <block end>"),
        (ARM + "  a: {}\n", "4:3: bodies.a: given twice; the first is in line 3"),
        ("", "1:1: file: the file is empty"),
        ("- a\n", "1:1: file: the file holds a list"),
        ("title: t\nbodies: [a]\n", "2:9: bodies: expected a mapping, found a list"),
        (ARM.replace("1 kg", ".nan"), "3:29: bodies.a.mass: expected a finite number"),
        (ARM.replace("1 kg", "1e400 kg"), "3:29: bodies.a.mass: expected a finite number"),
        (ARM.replace("1 kg", "1 m"), "3:29: bodies.a.mass: this is in m, a quantity in kg"),
        ("title: t # caf\u00e9".encode("latin-1"), "1:15: syntax: the byte 0xe9 is not UTF-8"),
        (ARM.encode("utf-16"), "1:1: syntax: the byte 0xff is not UTF-8"),
        ("bodies: &a\n  a: *a\n", "an alias repeats itself"),
        ("x0: &x0 [1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
            f"x{k}: &x{k} [{', '.join([f'*x{k - 1}'] * 9)}]\n" for k in range(1, 9)),
         "too many values"),
        ("bodies: !!python/object/apply:os.system [true]\n", "the tag 'os.system' is not allowed"),
        ("a: " + "[" * 3000, "nested too deeply"),
    ],
)  # fmt: skip
def test_files_that_are_no_systems(call, content, words):
    code, out, err = call("validate", content)
    assert (code, out) == (2, "")
    assert words in err and "problem" in err.splitlines()[-1]


@pytest.mark.parametrize("tyres", ["{kind: calspam}", "{front: {kind: calspam}, rear: {}}"])
def test_a_wrong_tyre_is_corrected(call, tyres, tmp_path, monkeypatch, capsys):
    path = tmp_path / "drive.yaml"
    path.write_text(f"title: t\nmodel: iltis\ntyres: {tyres}\n")
    monkeypatch.setattr(sys, "argv", ["vehicledyn", "validate", str(path)])
    with pytest.raises(SystemExit):
        main()
    assert "no tyre named 'calspam'; did you mean 'calspan'?" in capsys.readouterr().err


def test_a_missing_compiler_is_told_once(call, monkeypatch):
    monkeypatch.setenv("VEHICLEDYN_CC", "/no/such/compiler")
    code, _, err = call("run", ARM, SCENARIO, "--backend", "auto")
    assert code == 0
    (kernel,) = [line for line in err.splitlines() if line.startswith("kernel: CasADi")]
    assert "no C compiler" not in kernel  # the log has said it
