"""Measure what the compiled Jacobian gains: ``python benchmarks/stiff.py [--quick] [MODEL ...]``.

Each implicit method runs the same motion twice over, with rates and Jacobian compiled and with
those that CasADi derives and interprets. The two take turns; printed are processor times of a run
whose integrator is made already and of the first one, steps, and how far the ends lie apart. A
compiler's own time is a process of its own and does not count; libraries come from the cache.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import chains
import numpy as np

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.base.registry import find
from vehicledyn.files.scenario import load_scenario
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, Attachment, Body, Joint, ParameterTable, PointForce, System
from vehicledyn.multibody import derive as derive_equations

SCENARIOS = Path(__file__).resolve().parents[1] / "scenarios"
METHODS = ("rosenbrock", "cvodes", "idas")


def quiet(what, part):
    """Show no progress."""


def scenario(name):
    """Return kernel, state and unknowns at the start of a scenario."""
    prepared, start = prepare_run(
        load_scenario(SCENARIOS / f"{name}.yaml"), backend="auto", progress=quiet
    )
    return prepared.kernel, start.state, start.unknowns


def of_system(system):
    """Return the same of a system at its start values."""
    kernel = compile_kernel(derive_equations(system))
    e = kernel.equations
    return kernel, [item.start for item in e.states], [item.start for item in e.unknowns]


def row(n=40, stiffness=1e6, damping=2e3):
    """Return masses of 1 kg in a row between stiff springs with dampers."""
    ends = [Attachment(GROUND, (0.0, 0.0, 0.0))]
    bodies = []
    for k in range(n):
        joint = Joint("T1", f"m{k}.x", float(k + 1), start_rate=np.sin(0.3 * k))
        bodies.append(Body(f"m{k}", GROUND, joints=(joint,), mass=1.0))
        ends.append(Attachment(f"m{k}", (0.0, 0.0, 0.0)))

    def law(length, rate):
        return stiffness * (length - 1.0) + damping * rate

    springs = tuple(PointForce(f"s{k}", a, b, law) for k, (a, b) in enumerate(pairwise(ends)))
    return System("row", ParameterTable(), tuple(bodies), (), springs, (0.0, 0.0, 0.0))


def chain():
    """Return thirty bodies in a row, each turning on the one before."""
    return chains.build("chain", 30, chains.serial)


CASES = {
    "slalom of the Iltis": (lambda: scenario("iltis_slalom"), 1.0, 0.01, 1e-6),
    "wheelset on elastic contacts": (lambda: scenario("systems/rail_wheelset"), 0.2, 0.01, 1e-7),
    "tram in a curve": (lambda: scenario("tram2000_curve"), 0.5, 0.01, 1e-6),
    "twenty four-bar linkages": (lambda: scenario("systems/four_bar_chain"), 0.5, 0.05, 1e-6),
    "forty masses between stiff dampers": (lambda: of_system(row()), 1.0, 0.05, 1e-6),
    "chain of thirty joints": (
        lambda: of_system(chains.build("chain", 30, chains.serial)),
        0.5,
        0.05,
        1e-6,
    ),
}


def run(start, method, case):
    """Return processor time, statistics and the states at the end of a run."""
    kernel, state, unknowns = start
    _, stop, interval, tolerance = CASES[case]
    ends = []
    begun = time.process_time()
    statistics = simulate(
        kernel,
        find("solver", method)(relative_tolerance=tolerance, absolute_tolerance=tolerance),
        start=0.0,
        stop=stop,
        state=state,
        unknowns=unknowns,
        interval=interval,
        sink=lambda t, x, z, y: ends.append(x[-1]),
    )
    return time.process_time() - begun, statistics, ends[-1]


def measure(case, repetitions):
    """Print a line for each method that can integrate a case."""
    kernel, *point = CASES[case][0]()
    n, m = len(kernel.equations.states), len(kernel.equations.unknowns)
    print(f"{case}: {n} states, {m} unknowns, {kernel.report.operations['rates']} operations")
    for method in METHODS:
        if m and method == "cvodes":
            continue
        kinds = {
            "compiled": replace(kernel, made={}),
            "interpreted": replace(kernel, key="", made={}),
        }
        run((kinds["compiled"], *point), method, case)
        kinds["compiled"].made.clear()
        first = {kind: run((k, *point), method, case) for kind, k in kinds.items()}
        best = dict.fromkeys(kinds, np.inf)
        for _ in range(repetitions):
            for kind, own in kinds.items():
                best[kind] = min(best[kind], run((own, *point), method, case)[0])
        apart = np.abs(first["compiled"][2] - first["interpreted"][2]).max()
        steps = [first[kind][1].steps for kind in kinds]
        print(
            f"  {method:11} {best['compiled']:8.3f} s against {best['interpreted']:7.3f} s: "
            f"{best['interpreted'] / best['compiled']:5.1f} times;  first run "
            f"{first['compiled'][0]:.2f} s against {first['interpreted'][0]:.2f} s;  "
            f"steps {steps[0]} and {steps[1]}, ends {apart:.1g} apart"
        )


def main():
    """Measure the cases that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("case", nargs="*", help="cases whose name holds one of these words")
    parser.add_argument("--quick", action="store_true", help="one repetition")
    given = parser.parse_args()
    for case in CASES:
        if not given.case or any(word in case for word in given.case):
            measure(case, 1 if given.quick else 5)


if __name__ == "__main__":
    main()
