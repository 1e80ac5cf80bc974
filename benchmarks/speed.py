"""Measure how fast the Iltis is: ``python benchmarks/speed.py [--quick] [--json FILE]``.

Prints the median of several repetitions with the smallest and the largest; candidates that are
compared take turns, so that a busy machine slows all of them alike. Writes nothing but the
JSON file where one is asked for; caches and results go to temporary folders.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import vehicledyn
import vehicledyn.catalogue  # registers models, tyres, roads
from vehicledyn.analyses.preparation.prepare import equilibrium_point, prepare
from vehicledyn.files.scenario import load_scenario
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.derivatives import Derivatives
from vehicledyn.kernel.engine import Ledger

SCENARIOS = Path(__file__).resolve().parents[1] / "scenarios"
SLALOM, RAMP = (SCENARIOS / f"iltis_{name}.yaml" for name in ("slalom", "ramp_steer"))
DURATION = 12.0  # s of slalom
SELDOM = "output.interval=1 s"  # so that samples cost nothing beside the right-hand sides


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
        spread = f"{low:.3g} ... {high:.3g}" if len(self.values) > 1 else ""
        median = str(self.median) if isinstance(self.median, int) else f"{self.median:.3g}"
        return f"{self.name:62} {median:>8} {self.unit:4} {spread:20} {self.goal}"


def quiet(what, part):
    """Show no progress."""


class Car:
    """A prepared scenario at its start."""

    def __init__(self, path, *overrides, backend="auto"):
        self.scenario = load_scenario(path, overrides).scenario
        self.prepared = prepare(load_scenario(path, overrides), backend=backend, progress=quiet)
        self.start = self.balance()

    def balance(self):
        return equilibrium_point(
            self.prepared, self.scenario.speed, self.scenario.start or "steady"
        )

    def run(self, duration):
        """Return the wall time of a simulation without files [s]."""
        started = time.perf_counter()
        statistics_of_run = simulate(
            self.prepared.kernel,
            self.scenario.solver,
            start=0.0,
            stop=duration,
            state=self.start.state,
            unknowns=self.start.unknowns,
            interval=self.scenario.output.interval,
            sink=lambda t, x, z, y: None,
        )
        self.evaluations = statistics_of_run.evaluations
        return time.perf_counter() - started

    def operations(self):
        counts = self.prepared.kernel.report.operations
        return counts["rates"] + counts["blocks"]


def right_hand_sides(repeats):
    """Return the time of a complete right-hand side within the compiled loop, by tyre law."""
    cars = {
        "Magic Formula tyres, driver": Car(SLALOM, SELDOM),
        "benchmark tyres": Car(RAMP, SELDOM),
    }
    times = {words: [] for words in cars}
    for car in cars.values():
        car.run(0.5)
    for _ in range(repeats):
        for words, car in cars.items():
            wall = car.run(4.0)
            times[words].append(1e6 * wall / car.evaluations)
    figures = []
    for words, car in cars.items():
        figures.append(Figure(f"right-hand side, {words}", "us", times[words], "<= 4"))
        figures.append(Figure(f"its operations, {words}", "1", [car.operations()]))
    return figures


def slaloms(repeats, interpreted_duration):
    """Return wall times of the slalom, compiled and interpreted."""
    compiled, interpreted = Car(SLALOM), Car(SLALOM, backend="interpreted")
    compiled.run(0.5)
    fast, slow = [], []
    for k in range(repeats):
        fast.append(compiled.run(DURATION))
        if k < 3:
            slow.append(interpreted.run(interpreted_duration) * DURATION / interpreted_duration)
    ratio = statistics.median(slow) / statistics.median(fast)
    return [
        Figure(
            f"slalom of {DURATION:g} s, RK4 at 1 ms, {compiled.prepared.kernel.backend}", "s", fast
        ),
        Figure("the same, times real time", "1", [DURATION / t for t in fast], ">= 50"),
        Figure("the same, interpreted", "s", slow),
        Figure("interpreted to compiled", "1", [ratio]),
    ]


def statics(repeats):
    """Return times of balancing the car and of deriving what that needs."""
    car = Car(SLALOM)
    kernel, start = car.prepared.kernel, car.start
    unknowns = start.unknowns.copy()
    calls = 2000
    single, balances, jacobians = [], [], []
    for _ in range(repeats):
        ledger = Ledger()
        started = time.perf_counter()
        for _ in range(calls):
            kernel.evaluate(0.0, start.state, unknowns, ledger)
        single.append(1e6 * (time.perf_counter() - started) / calls)
        started = time.perf_counter()
        car.balance()
        balances.append(time.perf_counter() - started)
    for _ in range(min(repeats, 3)):
        started = time.perf_counter()
        Derivatives(car.prepared.equations)
        jacobians.append(time.perf_counter() - started)
    return [
        Figure("right-hand side called from Python", "us", single),
        Figure("equilibrium at speed", "s", balances),
        Figure("deriving the exact Jacobian", "s", jacobians),
    ]


def builds(repeats):
    """Return times of making the kernel, without and with an entry in the cache."""
    parts = {"derive and print the kernel, cold": [], "compile the kernel, cold": [], "warm": []}
    known = os.environ.get("VEHICLEDYN_CACHE")
    for _ in range(repeats):
        with tempfile.TemporaryDirectory() as folder:
            os.environ["VEHICLEDYN_CACHE"] = folder
            report = prepare(load_scenario(SLALOM), backend="auto", progress=quiet).kernel.report
            started = time.perf_counter()
            prepare(load_scenario(SLALOM), backend="auto", progress=quiet)
            parts["warm"].append(time.perf_counter() - started)
        parts["derive and print the kernel, cold"].append(report.generation_seconds)
        parts["compile the kernel, cold"].append(report.compilation_seconds)
    if known is None:
        del os.environ["VEHICLEDYN_CACHE"]
    else:
        os.environ["VEHICLEDYN_CACHE"] = known
    parts["derive the equations and load the kernel, warm"] = parts.pop("warm")
    return [Figure(words, "s", values) for words, values in parts.items()]


def commands(repeats):
    """Return wall times of whole commands in processes of their own."""
    figures = []
    with tempfile.TemporaryDirectory() as folder:
        run = ["run", str(SLALOM), "-o", str(Path(folder) / "slalom.h5")]
        cold = []
        for k in range(max(1, repeats // 2)):
            cold.append(_command(run, Path(folder) / f"cache_{k}"))
        cache = Path(folder) / "cache_0"
        figures.append(Figure("vehicledyn run slalom with plots, cold", "s", cold, "<= 6"))
        small = {
            "vehicledyn --help": ["--help"],
            "vehicledyn validate, Iltis": ["validate", str(SLALOM)],
            "vehicledyn validate, tram": ["validate", str(SCENARIOS / "tram2000_curve.yaml")],
            "vehicledyn validate, sedan": ["validate", str(SCENARIOS / "systems" / "sedan.yaml")],
            "vehicledyn schema": ["schema"],
        }
        times = {words: [] for words in ("run", *small)}
        for _ in range(repeats):
            times["run"].append(_command(run, cache))
            for words, arguments in small.items():
                times[words].append(_command(arguments, cache))
        figures.append(
            Figure("vehicledyn run slalom with plots, warm", "s", times.pop("run"), "<= 2")
        )
        figures += [Figure(words, "s", values, "<= 0.3") for words, values in times.items()]
    return figures


def changes(repeats):
    """Return how much longer the first run takes with a part that a warm vehicle has not had."""
    text = SLALOM.read_text(encoding="utf-8").replace("duration: 22 s", "duration: 0.5 s")
    driver = text[text.index("    kind: preview") : text.index("  speed_control")]
    hands = "".join(f"{line}\n" for line in driver.splitlines() if "lag" in line or "stop" in line)
    manoeuvre = text[text.index("  kind: slalom") : text.index("duration")]
    replaced = {
        "driver": (driver, f"    kind: stanley\n    gain: 2 1/s\n{hands}"),
        "manoeuvre": (manoeuvre, "  kind: straight\n"),
        "road": ("  kind: flat\n", "  kind: plane\n  slope_x: 1 %\n  slope_y: 1 %\n"),
    }
    added = {name: [] for name in replaced}
    for _ in range(repeats):
        with tempfile.TemporaryDirectory() as folder:
            file, result = (Path(folder, f"a.{end}") for end in ("yaml", "h5"))
            run = ["run", str(file), "-o", str(result), "--no-plots"]
            file.write_text(text, encoding="utf-8")
            warm = [_command(run, Path(folder)) for _ in range(3)][-1]
            for name, (old, new) in replaced.items():
                file.write_text(text.replace(old, new), encoding="utf-8")
                added[name].append(_command(run, Path(folder)) - warm)
    return [
        Figure(f"a new {name} on a warm vehicle, beside a warm run", "s", values, "<= 1")
        for name, values in added.items()
    ]


def _command(arguments, cache):
    environment = {**os.environ, "VEHICLEDYN_CACHE": str(cache)}
    started = time.perf_counter()
    subprocess.run(
        [sys.executable, "-m", "vehicledyn", *arguments],
        check=True,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    return time.perf_counter() - started


def main(arguments=None):
    """Measure, print and, if asked, write the figures as JSON."""
    parser = argparse.ArgumentParser(description="Measure the speed of the Iltis.")
    parser.add_argument("--quick", action="store_true", help="few repetitions")
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    options = parser.parse_args(arguments)
    repeats, duration = (2, 1.0) if options.quick else (7, 6.0)
    print(f"vehicledyn {vehicledyn.__version__}, {platform.machine()}, {os.cpu_count()} processors")
    print(f"{'median':>71} {'unit':4} {'smallest ... largest':20} goal")
    figures = []
    for measure in (
        lambda: right_hand_sides(repeats),
        lambda: slaloms(repeats, duration),
        lambda: statics(repeats),
        lambda: builds(max(1, repeats // 2)),
        lambda: commands(repeats),
        lambda: changes(max(1, repeats // 2)),
    ):
        found = measure()
        figures += found
        print("\n".join(figure.line() for figure in found), flush=True)
    if options.json:
        content = [{**asdict(f), "median": f.median} for f in figures]
        options.json.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
