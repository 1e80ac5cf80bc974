"""Measure cases side by side: ``python benchmarks/lanes.py [--quick] [--json FILE]``.

Look-ups of tables, chains, a right-hand side of the Iltis and its slalom, and implicit steps, one
case alone and several in SIMD lanes, and the starting points of many cases. Candidates take turns;
times are processor times, of which the median of several repetitions is printed with the smallest
and the largest. Writes nothing but the JSON file where one is asked for.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import tempfile
import time
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path

import chains
import numpy as np

import vehicledyn.catalogue  # noqa: F401 - registers models, tyres, solvers
from vehicledyn.analyses.preparation.prepare import prepare
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.base.registry import find
from vehicledyn.codegen.toolchain.compiler import suitable_lanes
from vehicledyn.files.scenario import load_scenario
from vehicledyn.integrate.batch import Cases, make_batch, run_batch
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import (
    GROUND,
    BasePart,
    Body,
    Joint,
    Loads,
    ParameterTable,
    System,
    derive,
)
from vehicledyn.studies.starts import find_reference, start_of
from vehicledyn.symbolic.tables import CurveTable

SCENARIOS = Path(__file__).resolve().parents[1] / "scenarios"
STAGES = 4  # right-hand sides of a Runge-Kutta step
STEP = 1e-3  # s
LOOK_UPS = 100
STARTS = 200
SPREAD = 0.05  # of the masses of cases, to either side


@dataclass(frozen=True)
class Figure:
    """A measured quantity over its repetitions; ``goal`` is what the project asks for."""

    name: str
    unit: str
    values: list[float]
    goal: str = ""

    @property
    def median(self) -> float:
        return statistics.median(self.values)

    def line(self) -> str:
        low, high = min(self.values), max(self.values)
        return (
            f"{self.name:56} {self.median:>9.4g} {self.unit:4} {low:.4g} ... {high:.4g} {self.goal}"
        )


class Track:
    """Cases of one kernel, run alone and in lanes from the same starts."""

    def __init__(self, kernel, cases, span, channels=(), step=STEP, method="rk4"):
        self.kernel, self.cases, self.span, self.channels = kernel, cases, span, list(channels)
        self.solver = find("solver", method)(step=step)
        self.batches = {1: make_batch(kernel, lanes=1)}
        for lanes in (4, 8):
            if lanes <= suitable_lanes():
                self.batches[lanes] = make_batch(kernel, lanes=lanes)
        self.times = {lanes: [] for lanes in self.batches}
        self.steps = round((span["stop"] - span["start"]) / step)

    def measure(self, repeats):
        """Let the candidates take turns; return the processor time of a case by lanes [s]."""
        for repeat in range(repeats + 1):
            for lanes, batch in self.batches.items():
                n = 2 * lanes if lanes > 1 else 2
                cases = self.cases.part(slice(0, n))
                started = time.process_time()
                result = run_batch(batch, self.solver, cases, channels=self.channels, **self.span)
                seconds = time.process_time() - started
                if any(end.failed or end.ended_by for end in result.ends):
                    raise SystemExit(f"a case did not come to its end: {result.ends}")
                if repeat:
                    self.times[lanes].append(seconds / n)
        return self.times


def words(lanes):
    return "alone" if lanes == 1 else f"{lanes} lanes"


def chain_figures(lengths, repeats):
    """Return nanoseconds of forward dynamics of chains, a case."""
    figures = []
    for joints in lengths:
        equations = derive(chains.build(f"chain_{joints}", joints, chains.serial))
        kernel = compile_kernel(equations, backend="compiled")
        factor = 1.0 + SPREAD * np.linspace(-1.0, 1.0, 16)
        cases = Cases(
            np.outer(factor, kernel.parameters),
            np.tile([s.start for s in equations.states], (16, 1)),
            np.zeros((16, 0)),
        )
        intervals = max(1, 300 // joints)  # so that small systems run as long as large ones
        span = {"start": 0.0, "stop": 200 * intervals * chains.STEP, "interval": 200 * chains.STEP}
        track = Track(kernel, cases, span, step=chains.STEP)
        for lanes, times in track.measure(repeats).items():
            values = [1e9 * t / (STAGES * track.steps) for t in times]
            figures.append(
                Figure(f"chain of {joints}, forward dynamics, {words(lanes)}", "ns", values)
            )
    return figures


class Iltis:
    """A prepared Iltis and sets of parameters with masses of their own."""

    def __init__(self, name):
        self.loaded = load_scenario(SCENARIOS / f"{name}.yaml")
        self.prepared = prepare(self.loaded, backend="compiled", progress=lambda what, part: None)
        scenario = self.loaded.scenario
        self.start = scenario.speed, scenario.start
        self.reference = find_reference(self.prepared, *self.start)
        entries = self.prepared.equations.parameters
        masses = [k for k, p in enumerate(entries) if p.unit in ("kg", "kg*m^2")]
        self.parameters = np.tile(self.prepared.kernel.parameters, (STARTS, 1))
        rng = np.random.default_rng(0)
        self.parameters[:, masses] *= 1.0 + SPREAD * rng.uniform(-1.0, 1.0, (STARTS, len(masses)))

    def cases(self, count):
        """Return the first cases with the points they start from."""
        points, parameters = [], []
        for values in self.parameters[:count]:
            own = replace(self.prepared, kernel=self.prepared.kernel.with_parameters(values))
            points.append(start_of(own, *self.start, self.reference))
            parameters.append(own.kernel.parameters)
        states, unknowns = ([getattr(p, k) for p in points] for k in ("state", "unknowns"))
        return Cases(*map(np.array, (parameters, states, unknowns)))


def iltis_figures(repeats):
    """Return right-hand sides of the Iltis, times real time of its slalom, and starts."""
    figures = []
    goals = {1: "<= 1.3", 8: "<= 0.3"}
    car = Iltis("iltis_ramp_steer")
    span = {"start": 0.0, "stop": 2.0, "interval": 1.0}
    track = Track(car.prepared.kernel, car.cases(16), span)
    for lanes, times in track.measure(repeats).items():
        values = [1e6 * t / (STAGES * track.steps) for t in times]
        name = f"Iltis, right-hand side, benchmark tyres, {words(lanes)}"
        figures.append(Figure(name, "us", values, goals.get(lanes, "")))
    car = Iltis("iltis_slalom")
    started = []
    for _ in range(repeats):
        clock = time.process_time()
        car.cases(STARTS)
        started.append((time.process_time() - clock) * 1000 / STARTS)
    figures.append(Figure("Iltis, starts of 1,000 slaloms", "s", started, "<= 2"))
    goals = {1: ">= 150", 8: ">= 800"}
    span = {"start": 0.0, "stop": 2.0, "interval": 0.01}
    track = Track(car.prepared.kernel, car.cases(16), span, channels=range(20))
    for lanes, times in track.measure(repeats).items():
        values = [span["stop"] / t for t in times]
        name = f"Iltis, slalom, 20 channels at 100 Hz, {words(lanes)}"
        figures.append(Figure(name, "x", values, goals.get(lanes, "")))
    return figures


def implicit_figures(repeats):
    """Return milliseconds of implicit steps on a car with leaf springs, a case."""
    loaded = load_scenario(SCENARIOS / "systems" / "jeep_leaf_springs.yaml")
    prepared, start = prepare_run(loaded, backend="compiled", progress=lambda what, part: None)
    kernel = prepared.kernel
    parameters = np.tile(kernel.parameters, (16, 1))
    masses = [k for k, p in enumerate(kernel.equations.parameters) if p.unit == "kg"]
    parameters[:, masses] *= 1.0 + SPREAD * np.linspace(-1.0, 1.0, 16)[:, None]
    points = (np.tile(item, (16, 1)) for item in (start.state, start.unknowns))
    cases, span = Cases(parameters, *points), {"start": 0.0, "stop": 2.0, "interval": 0.1}
    figures = []
    for method, step in (("generalised_alpha", 2.5e-3), ("rk4", 5e-4)):
        track = Track(kernel, cases, span, step=step, method=method)
        for lanes, times in track.measure(repeats).items():
            name = f"jeep on leaf springs, 2 s by {method}, {words(lanes)}"
            figures.append(Figure(name, "ms", [1e3 * t for t in times]))
    return figures


@dataclass(frozen=True)
class Curves(BasePart):
    """A force that sums values and slopes of a curve at many places, none without a curve."""

    curve: CurveTable | None = None

    def loads(self, situation):
        x = situation.kinematics.coordinate("x")
        force = 0.0
        for k in range(LOOK_UPS):
            place = x * (1.0 + k / LOOK_UPS)
            if self.curve is None:
                force += place
            else:
                force += self.curve.value(place) + self.curve.slope(place)
        return Loads(joint_forces={"x": force})


def table_figures(repeats):
    """Return nanoseconds of a look-up of a cubic, index, value and slope, a case."""
    found = {}
    values = np.sin(np.linspace(0.0, 10.0, 1001))
    for curve in (None, CurveTable.through("curve", -5.0, 0.01, values)):
        body = Body("mass", GROUND, joints=(Joint("T1", "x", start=0.3),), mass=1e3)
        system = System("curves", ParameterTable(), (body,), parts=(Curves("curves", curve),))
        kernel = compile_kernel(derive(system), backend="compiled")
        starts = np.linspace(-2.0, 2.0, 16)[:, None] * [[1.0, 0.0]]
        cases = Cases(np.tile(kernel.parameters, (16, 1)), starts, np.zeros((16, 0)))
        track = Track(kernel, cases, {"start": 0.0, "stop": 2.0, "interval": 1.0})
        found[curve is None] = track.measure(repeats)
    return [
        Figure(
            f"look-up of a cubic, value and slope, {words(lanes)}",
            "ns",
            [
                1e9 * (t - min(found[True][lanes])) / (STAGES * track.steps * LOOK_UPS)
                for t in times
            ],
        )
        for lanes, times in found[False].items()
    ]


def main(arguments=None):
    """Measure, print and, if asked, write the figures as JSON."""
    parser = argparse.ArgumentParser(description="Measure cases side by side in SIMD lanes.")
    parser.add_argument("--quick", action="store_true", help="few repetitions, short chains")
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    options = parser.parse_args(arguments)
    repeats, lengths = (3, (6, 12)) if options.quick else (9, (6, 12, 30, 100))
    known = os.environ.get("VEHICLEDYN_CACHE")
    with tempfile.TemporaryDirectory() as folder:
        os.environ["VEHICLEDYN_CACHE"] = known or folder
        figures = []
        for measure in (
            partial(table_figures, repeats),
            partial(chain_figures, lengths, repeats),
            partial(iltis_figures, repeats),
            partial(implicit_figures, repeats),
        ):
            found = measure()
            figures += found
            print("\n".join(figure.line() for figure in found), flush=True)
    if known is None:
        del os.environ["VEHICLEDYN_CACHE"]
    if options.json:
        content = [{**asdict(f), "median": f.median} for f in figures]
        options.json.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
