"""The Iltis drives over edges with the contact of a disc, before the first sample."""

import warnings
from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd

pytestmark = pytest.mark.long

SCENARIO = """
title: Over an edge
model: iltis
tyres: {kind: magic_formula_1987}
road: {kind: profile, file: edge.csv, start: 1.12 m}
contact: disc
wheel_spin: free
speed: 5 m/s
start: nominal
manoeuvre: {kind: straight}
duration: 150 ms
solver: {kind: rk4, step: 1 ms}
output: {interval: 150 ms}
"""
EDGES = {"ramp": "0,0\n0.05,20\n2,20", "kerb": "0,0\n0.001,30\n2,30"}


@pytest.mark.parametrize("edge", EDGES)
def test_edge_before_the_first_sample_ends_the_run_with_a_reason(tmp_path: Path, edge):
    """Front wheels reach it after 30 ms, a fifth of the way to the first sample.

    The disc touches such an edge in two points: the run goes on, or says which wheel has none.
    """
    (tmp_path / "edge.csv").write_text(f"x [m],z [mm]\n-1,0\n{EDGES[edge]}\n")
    scenario = tmp_path / "over.yaml"
    scenario.write_text(SCENARIO)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", vd.UnfinishedWarning)
        warnings.simplefilter("ignore", vd.AccuracyWarning)  # the road has an edge
        motion = vd.simulate(scenario, backend="interpreted")
    load = motion["wheel_fl.tyre.normal_force"].values
    assert np.isfinite(load).all()
    if motion.status == "ok":
        assert len(load) == 2
    else:
        assert len(load) == 1
        assert "contact of 'wheel_f" in motion.status_message
        assert "no point of contact is found here" in motion.status_message
