"""Optimisation studies whose constraints exclude each other, or are hard to reach."""

import json

import numpy as np
import pytest
import yaml

import vehicledyn as vd
from vehicledyn.analyse.objective import Evaluated
from vehicledyn.analyse.optimise import optimise
from vehicledyn.cli import main

SYSTEM = """\
title: Functions of parameters
parameters: {x: 0.9 m, y: 0.5}
bodies:
  mass: {joints: [{kind: T1, name: slide}], mass: 1 kg, inertia: [0, 0, 0]}
sensors:
  gain: {kind: expression, value: x, unit: m}
  twin: {kind: expression, value: x, unit: m}
  other: {kind: expression, value: y, unit: "1"}
"""
SCENARIO = """\
title: Functions
model: functions.yaml
duration: 10 ms
solver: {kind: rk4, step: 10 ms}
output: {interval: 10 ms}
"""
LIMITS = """\
  final(gain): {at_least: 3 m}
  final(twin): {at_most: 2 m}
"""
STUDY = f"""\
title: Contradiction
scenarios: run.yaml
variables: {{x: {{from: 0 m, to: 4 m}}, y: {{from: 0, to: 1}}}}
minimise: final(other)
constraints:
{LIMITS}"""


def study(folder, text=STUDY):
    """Write a study of functions of parameters; return its path."""
    (folder / "functions.yaml").write_text(SYSTEM, encoding="utf-8")
    (folder / "run.yaml").write_text(SCENARIO, encoding="utf-8")
    path = folder / "study.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_an_infeasible_study_ends_with_a_negative_answer(tmp_path, capsys, monkeypatch):
    """Half way between 2 m and 3 m both limits are missed by 0.5 m; the file says so."""
    monkeypatch.chdir(tmp_path)
    command = ["optimise", str(study(tmp_path)), "-o", "out.h5", "--system", "best.yaml"]
    monkeypatch.setattr("sys.argv", ["vehicledyn", *command])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 1
    text = capsys.readouterr().out
    assert "final(gain) is 2.5 m, at least 3 m is asked for: missed by 0.5 m" in text
    assert "final(twin) is 2.5 m, at most 2 m is asked for: missed by 0.5 m" in text
    assert "loosen" in text
    assert "starts: 8" in text
    kept = vd.open_result("out.h5")
    assert (kept.status, kept.is_whole) == ("infeasible", False)
    assert "missed by 0.5 m" in kept.status_message
    assert not (tmp_path / "best.yaml").exists()


def test_an_infeasible_study_warns_in_python(tmp_path):
    with pytest.warns(vd.UnfinishedWarning, match=r"infeasible.*missed by 0.5 m"):
        found = vd.optimise(study(tmp_path))
    missed = found.report.as_dict()["missed"]
    assert [item["by"] for item in missed] == pytest.approx([0.5, 0.5], abs=1e-6)
    assert json.dumps(found.report.as_dict())


@pytest.mark.parametrize("optimiser", ["slsqp", "ipopt"])
def test_the_least_violation_is_found_from_a_start_that_is_far_from_it(tmp_path, optimiser):
    """Limits within the bounds but for one: it alone is missed, by its distance to the bound."""
    text = STUDY.replace(LIMITS, "  final(gain): {at_least: 5 m}\n")
    text = f"{text}  final(other): {{at_least: 0.7}}\noptimiser: {optimiser}\n"
    with pytest.warns(vd.UnfinishedWarning, match="infeasible"):
        found = vd.optimise(study(tmp_path, text))
    (missed,) = found.report.as_dict()["missed"]
    assert missed["figure"] == "final(gain)"
    assert missed["by"] == pytest.approx(1.0, abs=1e-6)
    assert "widen the bounds of 'x'" in " ".join(found.notes)


def test_a_search_that_ends_before_the_constraints_goes_on_from_near_them():
    """SLSQP leaves along a flat constraint, from where linear constraints exclude each other."""

    def evaluate(x):
        a, b = x
        off, slope, hill = np.arctan(a) - np.arctan(0.5), 1.0 / (1.0 + a**2), np.exp(-(a**2))
        constraints = np.array([0.01 - off, 0.01 + off, b - hill])
        rows = np.array([[-slope, 0.0], [slope, 0.0], [2.0 * a * hill, 1.0]])
        return Evaluated(float(a + b), np.ones(2), constraints, rows)

    found = optimise(
        evaluate,
        start=np.array([-1.787, 2.627]),
        bounds=(np.full(2, -10.0), np.full(2, 10.0)),
        tolerance=1e-10,
        most_runs=200,
    )
    a, b = found.variables
    assert found.is_feasible
    assert a == pytest.approx(np.tan(np.arctan(0.5) - 0.01), abs=1e-4)
    assert b == pytest.approx(np.exp(-(a**2)), abs=1e-4)


def test_files_of_feasible_optima_are_whole(tmp_path):
    text = STUDY.replace(LIMITS, "  final(gain): {at_least: 2 m, at_most: 3 m}\n")
    found = vd.optimise(study(tmp_path, text), system_file=tmp_path / "best.yaml")
    assert found.is_whole
    assert "missed" not in found.report.as_text()
    best = yaml.safe_load((tmp_path / "best.yaml").read_text(encoding="utf-8"))
    assert "parameters" in best
