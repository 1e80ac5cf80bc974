"""Optima of functions of parameters: fronts in closed form, figures that are no number."""

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import UnfinishedWarning

MODEL = """\
title: Functions of parameters
parameters: {x: 0.9, y: 0.4}
bodies:
  mass: {joints: [{kind: T1, name: slide}], mass: 1 kg, inertia: [0, 0, 0]}
sensors:
  one: {kind: expression, value: "x**2 + y**2", unit: "1"}
  grown: {kind: expression, value: "log(x)**2 + y**2", unit: "1"}
  two: {kind: expression, value: "(x - 1)**2 + 2 * y**2", unit: "1"}
"""
RUN = """\
title: A moment
model: model.yaml
duration: 10 ms
solver: {kind: rk4, step: 10 ms}
output: {interval: 10 ms}
"""
STUDY = """\
scenarios: run.yaml
variables: {x: {from: -2, to: 2}, y: {from: -1, to: 1}}
minimise: final(one)
front: {figure: final(two), at_most: [0.81, 0.49, 0.09]}
"""


GROWN = """\
scenarios: run.yaml
variables: {x: {from: -1, to: 2, start: 1.9}, y: {from: -1, to: 1}}
minimise: final(grown)
"""


def written(folder, study):
    """Write a study with its model and scenario; return its path."""
    for name, text in (("model", MODEL), ("run", RUN), ("study", study)):
        (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    return folder / "study.yaml"


@pytest.mark.long
def test_a_front_that_begins_where_the_objective_vanishes(tmp_path):
    """Without a limit the objective is zero; (1 - sqrt(limit))² is the best with one."""
    found = vd.optimise(written(tmp_path, STUDY))
    expected = (1.0 - np.sqrt([0.81, 0.49, 0.09])) ** 2
    assert found["front_objective"].values == pytest.approx(expected, abs=1e-6)
    assert (found["front_optimality"].values < 1e-4).all()


def test_exploring_does_not_take_what_is_no_number_for_best(tmp_path):
    """A third of the bounds has no logarithm; the search began there, and had no motion."""
    found = vd.optimise(written(tmp_path, f"{GROWN}explore: 40\n"))
    assert found["variable_best"].values == pytest.approx([1.0, 0.0], abs=1e-3)


def test_a_search_by_ipopt_that_runs_out_says_nothing_else(tmp_path, capfd):
    """CasADi wrote a line for each evaluation that was not made any more."""
    with pytest.warns(UnfinishedWarning, match="stopped after 3 runs"):
        vd.optimise(written(tmp_path, f"{GROWN}optimiser: ipopt\nmost_runs: 3\n"))
    assert "CasADi" not in "".join(capfd.readouterr())
