"""Implicit steps on vehicles beside the other methods: ``python benchmarks/equal_error.py [NAME]``.

Each method runs a scenario with several steps or tolerances. The error of a run is the root mean
square of each state's distance from a run of ``rk4`` with a quarter of its step, as a part of the
state's range; nine of ten states are below what is printed. Times are processor times of the run
alone, the least of three. The last lines compare, for some errors, the fastest run of each family
that stays below: what a user pays for that error.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.registry import find
from vehicledyn.files.scenario import load_scenario
from vehicledyn.integrate.simulate import simulate

SCENARIOS = Path(__file__).resolve().parents[1] / "scenarios"
GOALS = (3e-2, 1e-2, 3e-3, 1e-3, 3e-4)
ADAPTIVE = [("idas", 1e-3), ("idas", 1e-4), ("dop853", 1e-5)]
LONG = 2.0  # s, runs of which are not repeated


def steps(method, *sizes, **more):
    """Return a method with several steps in ms."""
    return [(method, size * 1e-3, more) for size in sizes]


def implicit(*sizes):
    """Return generalised-alpha with several steps in ms."""
    return steps("generalised_alpha", *sizes)


CASES = {
    "tram2000_curve": (
        9.0,
        0.01,
        steps("rk4", 0.15625, 0.2, 0.25) + steps("rkc", 0.3125, 0.5, stages=5),
        implicit(2.0, 1.0, 0.5, 0.25),
    ),
    "bas2000_curve": (
        3.0,
        0.01,
        steps("rk4", 0.15625, 0.2, 0.25, 0.3125) + steps("rkc", 0.3125, 0.5, stages=5),
        implicit(2.0, 1.0, 0.5, 0.25),
    ),
    "systems/off_road_truck_rough": (
        4.5,
        0.01,
        steps("rk4", 1.0, 5 / 3, 2.0, 2.5) + steps("rkc", 2.0, 2.5, stages=5),
        implicit(10.0, 5.0, 2.5, 5 / 3),
    ),
    "systems/tractor_semitrailer": (
        6.0,
        0.05,
        steps("rk4", 1.0, 1.25, 5 / 3, 2.0) + steps("rkc", 2.0, 2.5, stages=5),
        implicit(10.0, 5.0, 2.5, 1.25, 1.0),
    ),
    "systems/jeep_leaf_springs": (
        3.0,
        0.01,
        steps("rk4", 0.25, 0.5, 0.625, 1.0) + steps("rkc", 0.625, 1.0, stages=5),
        implicit(10.0, 5.0, 2.5, 1.25, 5 / 6, 0.5),
    ),
    "systems/truck_flexible_frame": (
        3.0,
        0.01,
        steps("rk4", 1.0, 2.0, 2.5, 10 / 3) + steps("rkc", 2.0, 5.0, stages=5),
        implicit(10.0, 5.0, 2.0, 1.0),
    ),
}


class Case:
    """A scenario, prepared, and the states of a fine run of it."""

    def __init__(self, name):
        self.stop, self.interval, present, own = CASES[name]
        # Contacts of rails make the explicit pair take a minute.
        adaptive = [(m, t, None) for m, t in ADAPTIVE if m == "idas" or "systems" in name]
        self.families = {"others": present + adaptive, "implicit": own}
        loaded = load_scenario(SCENARIOS / f"{name}.yaml")
        prepared, start = prepare_run(loaded, backend="auto", progress=lambda *_: None)
        self.kernel, self.start = prepared.kernel, start
        fine = min(size for method, size, _ in present if method == "rk4") / 4.0
        self.exact = self.run("rk4", fine, {})[1]
        self.ranges = np.ptp(self.exact, axis=0)

    def run(self, method, size, more):
        """Return processor time [s], states and statistics of a run."""
        tolerances = {"relative_tolerance": size, "absolute_tolerance": size}
        settings = tolerances if more is None else {"step": size, **more}
        states = []
        begun = time.process_time()
        took = simulate(
            self.kernel, find("solver", method)(**settings), start=0.0, stop=self.stop,
            state=self.start.state, unknowns=self.start.unknowns, interval=self.interval,
            sink=lambda t, x, z, y: states.append(x.copy()), watched=False,
        )  # fmt: skip
        return time.process_time() - begun, np.concatenate(states), took

    def error(self, states):
        """Return what nine of ten states are below."""
        moves = self.ranges > 1e-9 * (1.0 + np.abs(self.exact).max(axis=0))
        apart = np.sqrt(((states - self.exact) ** 2).mean(axis=0))[moves] / self.ranges[moves]
        return float(np.quantile(np.nan_to_num(apart, nan=np.inf, posinf=np.inf), 0.9))


def measure(name):
    """Print the runs of a scenario and what each error costs."""
    case = Case(name)
    print(f"{name}: {len(case.ranges)} states, {case.stop:g} s")
    found = {}
    for family, ways in case.families.items():
        found[family] = []
        for method, size, more in ways:
            try:
                runs = [case.run(method, size, more)]
                if runs[0][0] < LONG:
                    runs += [case.run(method, size, more) for _ in range(2)]
            except NumericalError as error:
                print(f"  {method:18} {size:9.3g}  fails: {str(error)[:60]}")
                continue
            seconds, error = min(run[0] for run in runs), case.error(runs[0][1])
            took = runs[0][2]
            label = f"{method} {size:.3g}"
            found[family].append((error, seconds, label))
            print(
                f"  {method:18} {size:9.3g}  error {error:8.1e}  {1e3 * seconds:8.1f} ms  "
                f"{took.steps} steps, {took.evaluations} evaluations"
            )
    for goal in GOALS:
        best = {
            family: min((item[1:] for item in items if item[0] <= goal), default=None)
            for family, items in found.items()
        }
        if all(best.values()):
            (others, one), (own, other) = best["others"], best["implicit"]
            print(
                f"  error {goal:.0e}: {one} {1e3 * others:.1f} ms, {other} {1e3 * own:.1f} ms: "
                f"{others / own:.2f} times"
            )


def main():
    """Measure the scenarios that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("name", nargs="*", help="scenarios whose name holds one of these words")
    given = parser.parse_args()
    for name in CASES:
        if not given.name or any(word in name for word in given.name):
            measure(name)


if __name__ == "__main__":
    main()
