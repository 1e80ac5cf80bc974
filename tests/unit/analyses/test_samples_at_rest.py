"""Samples that meet a motion where it stands still say nothing of its energy."""

import vehicledyn as vd
from vehicledyn.results.store.reader import open_result

SYSTEM = """\
title: A mass on a spring
bodies:
  mass: {joints: [{kind: T1, name: x}], mass: 1 kg}
forces:
  spring: {coordinate: mass.x, force: "-39.47841760435743 N/m * position"}
"""
SCENARIO = """\
title: Sampled where it stands still
model: mass.yaml
duration: 10 s
initial: {mass.x: 1 m}
solver: {kind: rk4, step: 5 ms}
output: {interval: 500 ms}
"""


def test_an_oscillation_sampled_every_half_period_raises_no_alarm(tmp_path, needs_compiler):
    """x = cos 2πt: rates and power are zero at all samples, to the error of the phase."""
    (tmp_path / "mass.yaml").write_text(SYSTEM, encoding="utf-8")
    path = tmp_path / "run.yaml"
    path.write_text(SCENARIO, encoding="utf-8")
    found = vd.simulate(path, save_to=tmp_path / "run.h5")
    assert abs(found["mass.x"].values[-1] - 1.0) < 1e-6
    with open_result(tmp_path / "run.h5") as result:
        assert result.solver["accuracy"] == "accurate"
        assert result.solver["accuracy_steps"] < 10 * result.solver["steps"]
