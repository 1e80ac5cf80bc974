"""``validate`` reads each kind of study with what runs it."""

import numpy as np
import pytest
import typer

from vehicledyn.cli.verbs import validate

SCENARIO = """\
title: A quarter car on a shaker
model: quarter_car
duration: 0.5 s
solver: {kind: rk4, step: 5 ms}
output: {interval: 10 ms}
"""
STUDIES = {
    "identify": """\
title: Strut of a quarter car
experiments:
  first:
    scenario: run.yaml
    data: first.csv
    signals: {body.height: {column: height, noise: 1 mm}}
parameters:
  body.stiffness: {from: 5 kN/m, to: 60 kN/m}
""",
    "uncertainty": """\
title: Comfort of a quarter car
scenario: run.yaml
of: max(body.height)
parameters:
  body.stiffness: {kind: normal, mean: 18 kN/m, deviation: 500 N/m}
""",
    "optimise-manoeuvre": """\
title: A push
model: quarter_car
controls: {push: {input: "force:body.height", from: -4 N, to: 4 N}}
minimise: time
duration: 1 s
""",
    "optimise": """\
title: A soft strut
scenarios: {bump: run.yaml}
variables:
  body.stiffness: {from: 5 kN/m, to: 60 kN/m}
minimise: bump/rms(body.height)
""",
}
STUDIES["optimise by least squares"] = STUDIES["optimise"].replace(
    "minimise: rms(body.height)",
    "least_squares: {rms(body.height): {target: 0.9 m, size: 1 cm}}",
)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "run.yaml").write_text(SCENARIO)
    rows = (f"{t:.3f}, {np.sin(t):.6f}" for t in np.linspace(0.0, 0.5, 11))
    (tmp_path / "first.csv").write_text("time [s], height [mm]\n" + "\n".join(rows) + "\n")
    return tmp_path


@pytest.mark.parametrize(
    ("kind", "given", "wrong", "words"),
    [
        ("uncertainty", "max(body.height)", "[max(body.height), max(body.hight)]", "study.yaml:3:"),
        ("uncertainty", "max(body.height)", "largest_comfort", "neither a key figure nor"),
        ("uncertainty", "max(body.height)", "body.height", "is a curve"),
        (
            "optimise",
            "minimise: bump/rms(body.height)",
            "minimise: bump/energy_drifts",
            "'energy_drift'",
        ),
        ("optimise", "minimise: bump/rms(body.height)", "minimise: bump/body.height", "is a curve"),
    ],
)
def test_figures_that_no_run_has_are_named(folder, kind, given, wrong, words, capsys):
    path = folder / "study.yaml"
    path.write_text(STUDIES[kind].replace(given, wrong))
    with pytest.raises(typer.Exit) as ended:
        validate([path])
    assert ended.value.exit_code == 2
    assert words in capsys.readouterr().err


MISTAKES = {
    "optimise": (
        """\
title: A soft strut
colour: blue
scenarios: {bump: run.yaml}
variables:
  body.stifness: {from: 5 kN/m, to: 60 kN/m}
  body.damping: {from: 9 kN*s/m, to: 200 N*s/m}
  wheel.stiffness: {from: 9 kg, to: .inf}
  parameters.body.mass: {from: 0 kg, to: 500 kg}
  body.mass: {from: 100 kg, to: 500 kg}
minimise: {bump/rms(body.hight): 1, bmp/rms(body.height): 1}
constraints:
  bump/rms(strut.rate): {at_least: 2 m/s, at_most: 1 m/s}
  bump/max(strut.force): {at_most: 3 m}
scatter: {wheel.mas: {kind: normal}, wheel.mass: {kind: norml}}
""",
        "2:1 5:3 6:17 7:27 7:37 8:25 9:3 10:12 10:37 12:25 13:36 14:11 14:50",
    ),
    "identify": (
        """\
experiments:
  first:
    scenario: run.yaml
    set: {body.mas: 3 kg}
    data: first.csv
    signals: {body.height: {noise: 1 mm}}
  second:
    scenario: run.yaml
    data: first.csv
    signals:
      body.height: {column: hight, noise: 1 mm}
      body.hight: {column: height, noise: 1 mm}
      strut.force: {column: height, noise: 1 kg}
  third: {scenario: none.yaml, data: first.csv, signals: {body.height: {noise: 1 mm}}}
parameters:
  body.stifness: {from: 5 kN/m, to: 60 kN/m}
  body.damping: {from: 9 kN*s/m, to: 200 N*s/m, prior: 1 kN*s/m}
""",
        "11:20 12:19 13:44 14:21 16:3 17:17 17:17 4:21",
    ),
    "uncertainty": (
        """\
scenario: run.yaml
of: [max(body.height), max(body.hight), rms(strut.forse)]
parameters:
  body.stifness: {kind: normal, mean: 18 kN/m, deviation: 500 N/m}
  body.damping: {kind: uniform, from: 2 kN*s/m, to: 1 kN*s/m}
  wheel.mass: {kind: normal, mean: 18 N, deviation: 1 m}
method: sequence
limits: {max(body.height): {at_most: 1 kg}, max(body.speed): {at_most: 1 m}}
""",
        "2:24 2:41 4:3 5:17 6:36 6:53 8:38 8:45",
    ),
}


@pytest.mark.parametrize("kind", MISTAKES)
def test_all_mistakes_of_a_study_are_reported_at_once_with_their_places(folder, kind, capsys):
    path, (text, places) = folder / "study.yaml", MISTAKES[kind]
    path.write_text(text)
    with pytest.raises(typer.Exit) as ended:
        validate([path])
    *lines, count = capsys.readouterr().err.splitlines()
    assert ended.value.exit_code == 2
    found = [line.removeprefix(f"{path}:").partition(": ")[0] for line in lines]
    assert found == places.split(), lines
    assert count == f"{len(found)} problems in {path}"


@pytest.mark.parametrize("kind", STUDIES)
def test_a_good_study_is_ok_and_an_unknown_key_is_named(folder, kind, capsys):
    path = folder / "study.yaml"
    path.write_text(STUDIES[kind])
    with pytest.raises(typer.Exit) as ended:
        validate([path])
    assert (ended.value.exit_code, capsys.readouterr().out) == (0, f"{path}: ok\n")
    path.write_text(STUDIES[kind] + "colour: blue\n")
    with pytest.raises(typer.Exit) as ended:
        validate([path])
    text = capsys.readouterr().err
    assert ended.value.exit_code == 2
    assert "colour" in text and "unknown key" in text and f"{path}:" in text
    assert "solver" not in text
