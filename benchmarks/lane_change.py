"""Measure the sedan in the lane change of ISO 3888-1: ``benchmarks/lane_change.py [--quick]``.

A right-hand side, and a run without samples alone and in SIMD lanes, times real time on one core;
cases in lanes have masses of their own. Tyres are Magic Formula 6.1, the driveline that of the
model. Candidates take turns; times are processor times, of which the median is printed with the
smallest and the largest, with the load of the machine, which slows a shared core. Writes nothing.
"""

from __future__ import annotations

import argparse
import os
import tempfile
from pathlib import Path

import numpy as np
from lanes import SPREAD, STAGES, Figure, Track, words

import vehicledyn.catalogue  # noqa: F401 - registers models, tyres, solvers
from vehicledyn.analyses.preparation.prepare import equilibrium_point, prepare
from vehicledyn.files.scenario import load_scenario
from vehicledyn.integrate.batch import Cases

SCENARIO = """\
title: The sedan changes lanes twice
model: {model}
tyres: {{file: passenger_R0394_mf61.tir}}
speed: 80 km/h
wheel_spin: free
manoeuvre:
  kind: double_lane_change
  driver: {{kind: preview, preview_time: 0.65 s, lag_frequency: 25 rad/s, lag_damping: 0.8,
    rack_stop: 60 mm}}
  speed_control: {{proportional_gain: 1000 N*s, integral_gain: 100 N}}
duration: 8 s
solver: {{kind: rk4, step: 1 ms}}
output: {{interval: 20 ms}}
"""
MODELS = ("small_car", "sedan")
GOALS = {1: ">= 150", 4: ">= 400", 8: ">= 400"}
CASES = 16


def figures_of(model, repeats, step):
    """Return microseconds of a right-hand side and runs times real time, alone and in lanes."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "lane_change.yaml"
        file.write_text(SCENARIO.format(model=model), encoding="utf-8")
        loaded = load_scenario(file)
        prepared = prepare(loaded, backend="compiled", progress=lambda what, part: None)
    scenario, entries = loaded.scenario, prepared.equations.parameters
    start = equilibrium_point(prepared, scenario.speed, scenario.start or "steady")
    masses = [k for k, p in enumerate(entries) if p.unit == "kg"]
    parameters = np.tile(prepared.kernel.parameters, (CASES, 1))
    parameters[:, masses] *= 1.0 + SPREAD * np.linspace(-1.0, 1.0, CASES)[:, None]
    cases = Cases(
        parameters, *(np.tile(part, (CASES, 1)) for part in (start.state, start.unknowns))
    )
    span = {"start": 0.0, "stop": scenario.duration, "interval": scenario.output.interval}
    track = Track(prepared.kernel, cases, span, step=step)
    counts = prepared.kernel.report.operations
    operations = counts["rates"] + counts["blocks"]
    name = f"{model}, rk4 at {1e3 * step:g} ms"
    figures = [Figure(f"{model}, operations of a right-hand side", "1", [operations])]
    for lanes, times in track.measure(repeats).items():
        sides = [1e6 * t / (STAGES * track.steps) for t in times]
        goal = "<= 3" if lanes == 1 else ""
        figures.append(Figure(f"{name}, a right-hand side, {words(lanes)}", "us", sides, goal))
        faster = [scenario.duration / t for t in times]
        figures.append(
            Figure(f"{name}, times real time, {words(lanes)}", "1", faster, GOALS[lanes])
        )
    return figures


def main():
    """Print a line for each figure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few repetitions")
    parser.add_argument("--step", type=float, default=1e-3, help="step in s")
    parser.add_argument("models", nargs="*", default=MODELS)
    options = parser.parse_args()
    for model in options.models:
        for figure in figures_of(model, 2 if options.quick else 5, options.step):
            print(figure.line(), flush=True)
    load = " ".join(f"{value:.1f}" for value in os.getloadavg())
    print(f"load of the machine {load}, {os.cpu_count()} cores")


if __name__ == "__main__":
    main()
