"""Measure cars in the lane change of ISO 3888-1: ``benchmarks/lane_change.py [--quick] [MODEL]``.

Whether the driver keeps the cones at 80 km/h and how exact the run is; then a right-hand side, and
a run without samples alone and in SIMD lanes, times real time on one core; cases in lanes have
masses of their own. Tyres are Magic Formula 6.1, the driveline that of the model; the bushed sedan
has its lower arms on bushings. Candidates take turns; times are processor times, of which the
median is printed with the smallest and the largest, with the load of the machine, which slows a
shared core. Writes nothing.
"""

from __future__ import annotations

import argparse
import os
import tempfile
from pathlib import Path

import numpy as np
from lanes import SPREAD, STAGES, Figure, Track, words

import vehicledyn as vd
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
  driver: {{kind: macadam, preview_time: 0.65 s, points: 5, speed: 80 km/h, mass: {mass},
    yaw_inertia: {yaw_inertia}, front_distance: {axle}, rear_distance: {axle},
    front_stiffness: 130 kN/rad, rear_stiffness: 130 kN/rad, lag_frequency: 30 rad/s,
    lag_damping: 0.8, rack_stop: 60 mm}}
  speed_control: {{proportional_gain: 1000 N*s, integral_gain: 100 N}}
duration: 8 s
solver: {{kind: rk4, step: {step} s}}
output: {{interval: 20 ms}}
"""
SEDAN = {"mass": "1750 kg", "yaw_inertia": "3300 kg*m^2", "axle": "1.39 m"}
DRIVERS = {
    "small_car": {"mass": "1000 kg", "yaw_inertia": "1500 kg*m^2", "axle": "1.1 m"},
    "sedan": SEDAN,
    "bushed_sedan": SEDAN,
}
"""What the driver of a model takes its car for."""
GOALS = {1: ">= 150", 4: ">= 400", 8: ">= 400"}
CASES = 16


def figures_of(model, repeats, step):
    """Return microseconds of a right-hand side and runs times real time, alone and in lanes."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "lane_change.yaml"
        text = SCENARIO.format(model=model, step=step, **DRIVERS[model])
        file.write_text(text, encoding="utf-8")
        summary = vd.simulate(file).summary
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
    gates = [summary[f"clearance_{section}"].value for section in (1, 3, 5)]
    figures = [
        Figure(f"{name}, smallest clearance of the sections", "m", gates, "> 0"),
        Figure(f"{model}, operations of a right-hand side", "1", [operations]),
    ]
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
    parser.add_argument("--step", type=float, default=2e-3, help="step in s")
    parser.add_argument("models", nargs="*", default=list(DRIVERS))
    options = parser.parse_args()
    for model in options.models:
        for figure in figures_of(model, 2 if options.quick else 5, options.step):
            print(figure.line(), flush=True)
    load = " ".join(f"{value:.1f}" for value in os.getloadavg())
    print(f"load of the machine {load}, {os.cpu_count()} cores")


if __name__ == "__main__":
    main()
