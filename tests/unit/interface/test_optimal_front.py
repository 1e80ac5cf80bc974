"""Fronts of two objectives against their closed form."""

import numpy as np
import pytest

import vehicledyn as vd

MODEL = """\
title: Functions of parameters
parameters: {x: 0.9, y: 0.4}
bodies:
  mass: {joints: [{kind: T1, name: slide}], mass: 1 kg, inertia: [0, 0, 0]}
sensors:
  one: {kind: expression, value: "x**2 + y**2", unit: "1"}
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


def test_a_front_that_begins_where_the_objective_vanishes(tmp_path):
    """Without a limit the objective is zero; (1 - sqrt(limit))² is the best with one."""
    for name, text in (("model", MODEL), ("run", RUN), ("study", STUDY)):
        (tmp_path / f"{name}.yaml").write_text(text, encoding="utf-8")
    found = vd.optimise(tmp_path / "study.yaml")
    expected = (1.0 - np.sqrt([0.81, 0.49, 0.09])) ** 2
    assert found["front_objective"].values == pytest.approx(expected, abs=1e-6)
    assert (found["front_optimality"].values < 1e-4).all()
