"""Study files: what they may say, and every problem with its place."""

import numpy as np
import pytest
from small_study import PENDULUM, STUDY, written

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import kinds
from vehicledyn.studies import load_study

HEAD = STUDY.partition("cases:")[0]


def loaded(folder, cases, *overrides):
    return load_study(written(folder, f"{HEAD}cases:\n{cases}"), overrides)


def refused(folder, cases, *overrides):
    with pytest.raises(InputError) as caught:
        loaded(folder, cases, *overrides)
    return str(caught.value).replace(f"{folder}/", "")


def test_latin_hypercube(study):
    found = load_study(study)
    table = found.design.cases(0, 24)
    assert table.shape == (24, 2)
    length, mass = table.T
    assert sorted(np.floor((length - 0.5) / 1.5 * 24).astype(int)) == list(range(24))
    share = np.log(mass / 0.5) / np.log(4.0)
    assert sorted(np.floor(share * 24).astype(int)) == list(range(24))
    assert [axis.unit for axis in found.design.axes] == ["m", "kg"]
    assert np.array_equal(found.design.cases(7, 9), table[7:9])
    assert not np.array_equal(load_study(study, ["cases.seed=6"]).design.cases(0, 24), table)


def test_grid_with_quantities_and_choices(tmp_path):
    cases = """\
  kind: grid
  vary:
    solver: [{kind: rk4, step: 1 ms}, {kind: symplectic_euler, step: 1 ms}]
    parameters.mass: [1 kg, 2000 g]
    parameters.length: {from: 1 m, to: 4 m, count: 3, scale: log}
"""
    design = loaded(tmp_path, cases).design
    assert design.count == 12
    expected = [
        [solver, mass, length] for solver in (0, 1) for mass in (1, 2) for length in (1, 2, 4)
    ]
    assert design.cases(0, 12) == pytest.approx(np.array(expected), rel=1e-15)
    assert design.axes[0].is_choice
    assert design.axes[0].value(1.0) == {"kind": "symplectic_euler", "step": "1 ms"}


def test_rows_and_a_table_give_the_same_cases(tmp_path):
    rows = """\
  kind: list
  rows:
    - {parameters.mass: 1 kg, initial.upper.angle: 10 deg}
    - {parameters.mass: 500 g, initial.upper.angle: 0.2 rad}
"""
    heads = "parameters.mass [g], initial.upper.angle [rad]"
    table = f"# masses and angles\n{heads}\n1000, 10 deg\n\n500,0.2\n"
    (tmp_path / "cases.csv").write_text(table, encoding="utf-8")
    written_rows = loaded(tmp_path, rows).design.cases(0, 2)
    from_table = loaded(tmp_path, "  kind: list\n  file: cases.csv\n").design.cases(0, 2)
    assert written_rows == pytest.approx(np.array([[1.0, np.radians(10.0)], [0.5, 0.2]]))
    assert from_table == pytest.approx(written_rows, rel=1e-15)


@pytest.mark.parametrize(
    ("cases", "words"),
    [
        (
            "  kind: grid\n  vary:\n    parameters.lenght: [1 m]\n"
            "    parameters.mass: [1 kg, 3 s]\n",
            [
                "study.yaml:9:25: cases.vary.parameters.lenght[0]: no such parameter",
                "study.yaml:10:29: cases.vary.parameters.mass[1]: this is in s, the parameter",
                "2 problems in study.yaml",
            ],
        ),
        (
            "  kind: grid\n  vary: {parameters.mass: []}\n",
            ["no values; a study needs at least one case"],
        ),
        ("  kind: grid\n  vary: {}\n", ["nothing varies"]),
        ("  kind: list\n  rows: []\n", ["no rows; a study needs at least one case"]),
        ("  kind: list\n", ["either 'rows' or 'file'"]),
        ("  kind: list\n  file: none.csv\n", ["none.csv: there is no such file"]),
        (
            "  kind: list\n  rows: [{speed: 1}, {parameters.mass: 2 kg}]\n",
            ["not the keys of the first row: parameters.mass, speed"],
        ),
        (
            "  kind: random\n  number: 0\n  seed: 1\n  vary: {parameters.mass: {from: 1, to: 2}}\n",
            ["study.yaml:8:11: cases.number: must be at least 1, is 0"],
        ),
        (
            "  kind: random\n  number: 3\n  seed: 1\n  vary: {duration: {from: 1, to: 2}}\n",
            ["'duration' is the same for all cases; change it under 'set'"],
        ),
        (
            "  kind: random\n  number: 3\n  seed: 1\n  vary: {parameters.mass: {from: -1 kg, to: "
            "2 kg, scale: log}}\n",
            ["must be greater than 0 kg, is -1"],
        ),
        (
            "  kind: random\n  number: 3\n  seed: 1\n  vary: {solver.kind: {from: 1, to: 2}}\n",
            ["cases.vary.solver.kind.from", "no solver named"],
        ),
        ("  kind: gird\n", ["no cases named 'gird'; did you mean 'grid'?"]),
    ],
)
def test_wrong_cases_are_refused_with_their_place(tmp_path, cases, words):
    text = refused(tmp_path, cases)
    for word in words:
        assert word in text


def test_problems_of_a_table_name_its_line(tmp_path):
    (tmp_path / "cases.csv").write_text("parameters.mass [kg]\n1\n2, 3\n", encoding="utf-8")
    assert "cases.csv:3:1: 2 values for 1 columns" in refused(
        tmp_path, "  kind: list\n  file: cases.csv\n"
    )
    (tmp_path / "cases.csv").write_text("parameters.mass [m]\n1\n2\n", encoding="utf-8")
    assert "cases.csv" in (text := refused(tmp_path, "  kind: list\n  file: cases.csv\n"))
    assert "this is in m" in text


def test_problems_of_the_scenario_are_told(tmp_path):
    text = STUDY.replace("step: 1 ms", "step: 3 ms")
    with pytest.raises(InputError, match="does not divide"):
        load_study(written(tmp_path, text))
    with pytest.raises(InputError, match=r"scenario: .*no such file"):
        load_study(written(tmp_path, STUDY.replace("double_pendulum.yaml", "none.yaml")))
    with pytest.raises(InputError, match=r"study.yaml:1:1: scenario: missing"):
        load_study(written(tmp_path, "title: x\ncases: {kind: list, rows: [{a: 1}]}\n"))


def test_overrides_reach_the_study_and_its_scenario(study):
    found = load_study(study, ["cases.number=3", "duration=0.1 s", "output.precision=single"])
    assert found.design.count == 3
    assert found.base.scenario.duration == 0.1
    assert found.study.output.precision == "single"
    assert found.digests != load_study(study, ["cases.number=3"]).digests


EXAMPLES = {
    "grid": "vary: {parameters.mass: [1 kg, 2 kg]}",
    "list": "rows: [{parameters.mass: 1 kg}, {parameters.mass: 2 kg}]",
    "latin_hypercube": "number: 2\n  seed: 0\n  vary: {parameters.mass: {from: 1 kg, to: 2 kg}}",
    "random": "number: 2\n  seed: 0\n  vary: {parameters.mass: {from: 1 kg, to: 2 kg}}",
}


@pytest.mark.parametrize("kind", kinds("cases"))
def test_every_kind_gives_cases_inside_its_ranges(tmp_path, kind):
    design = loaded(tmp_path, f"  kind: {kind}\n  {EXAMPLES[kind]}\n").design
    values = design.cases(0, design.count)
    assert values.shape == (2, 1)
    assert values.min() >= 1.0
    assert values.max() <= 2.0


@pytest.mark.parametrize(
    ("set_", "vary", "words"),
    [
        ("{duration: 2}", "{parameters.mass: [1 kg]}", "set.duration: 2 has no unit"),
        ("{initial.upper.angle: 0.4}", "{parameters.mass: [1 kg]}", "upper.angle: 0.4 has no unit"),
        ("{}", "{parameters.mass: [1 kg, 2]}", "vary.parameters.mass[1]: 2 has no unit"),
        ("{}", "{parameters.length: {from: 1, to: 2 m, count: 3}}", "from: 1 has no unit"),
        ("{}", "{initial.upper.angle: [0.1 rad, 0.2]}", "0.2 has no unit; write '0.2 rad' or"),
    ],
)
def test_numbers_of_studies_need_their_unit(tmp_path, set_, vary, words):
    path = tmp_path / "s.yaml"
    text = f"title: x\nscenario: {PENDULUM}\nset: {set_}\ncases: {{kind: grid, vary: {vary}}}\n"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as refused:
        load_study(path)
    assert words in str(refused.value)
