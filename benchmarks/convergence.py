"""Measure how far scenarios are from convergence: ``python benchmarks/convergence.py [NAME ...]``.

Each scenario runs at its own step and at a half and a quarter of it; methods with step-size
control run with tolerances a tenth and a hundredth of their own. Printed are, per scenario, the
channel that moves most in parts of its range, when it does, and what the run costs. ``--json``
keeps the differences of all channels, ``--set`` changes scenarios as in ``vehicledyn run``.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.files.scenario import load_scenario

SCENARIOS = Path(__file__).resolve().parents[1] / "scenarios"
BAND = 0.01
"""Part of its range that a channel may move by at half the step [1]."""
NOISE = 1e-9
"""Range below this part of the largest value of its unit that is rounding [1]."""
RESIDUALS = "constraints."
"""Channels that tell how well the constraints are met: rounding, whatever the step."""


@dataclass(frozen=True)
class Recorded:
    """A run in memory."""

    times: np.ndarray
    names: list[str]
    units: list[str]
    values: np.ndarray
    seconds: float


def refined(solver, parts):
    """Return the method with its step divided by ``parts``, or tolerances a tenth per halving."""
    if hasattr(solver, "step"):
        return solver.model_copy(update={"step": solver.step / parts})
    share = 10.0 ** -np.log2(parts)
    return solver.model_copy(
        update={
            name: max(getattr(solver, name) * share, 1e-13)
            for name in ("relative_tolerance", "absolute_tolerance")
        }
    )


def ready(path, changes=()):
    """Return a scenario, what it runs and the point it starts from."""
    loaded = load_scenario(path, overrides=list(changes))
    return loaded.scenario, *prepare_run(loaded, backend="auto", progress=quiet)


def record(s, prepared, start, parts=1):
    """Return the run of a scenario that is ready, with its step divided by ``parts``."""
    e = prepared.equations
    times, values = [], []

    def take(t, x, z, y):
        times.append(t.copy())
        values.append(y.copy())

    begun = time.process_time()
    simulate_monitored(
        prepared.subject.system,
        prepared.kernel,
        refined(s.solver, parts),
        start=0.0,
        stop=s.duration,
        state=start.state,
        unknowns=start.unknowns,
        interval=s.output.interval,
        sink=take,
        progress=quiet,
        happened=lambda name, at: None,
        watch=lambda: prepared.watch,
    )
    return Recorded(
        np.concatenate(times),
        [c.name for c in e.channels],
        [c.unit for c in e.channels],
        np.vstack(values),
        time.process_time() - begun,
    )


def quiet(what, part):
    """Show no progress."""


def differences(coarse, fine):
    """Return per channel how far it moves in parts of its range, and when it moves most [s].

    A value that is no number in one run only moves without bounds, as all do behind the end of the
    shorter run.
    """
    n = min(len(coarse.times), len(fine.times))
    apart = distances(coarse.values[:n], fine.values[:n])
    if len(coarse.times) != len(fine.times):
        apart[-1] = np.inf
    known = np.ma.masked_invalid(fine.values)
    spans, sizes = (part.filled(0.0) for part in (np.ma.ptp(known, axis=0), abs(known).max(axis=0)))
    largest = {}
    for unit, value in zip(fine.units, sizes, strict=True):
        largest[unit] = max(largest.get(unit, 0.0), value)
    found = {}
    for k, (name, unit) in enumerate(zip(fine.names, fine.units, strict=True)):
        scale = max(spans[k], NOISE * largest[unit])
        if scale and not name.startswith(RESIDUALS):
            at = int(np.argmax(apart[:, k]))
            found[name] = (float(apart[at, k] / scale), float(coarse.times[at]))
    return found


def distances(one, other):
    """Return how far values lie apart, nothing where both are no numbers."""
    same = (one == other) | (np.isnan(one) & np.isnan(other))
    with np.errstate(invalid="ignore"):
        apart = np.abs(one - other)
    return np.where(same, 0.0, np.where(np.isnan(apart), np.inf, apart))


def worst(found):
    """Return the channel that moves most: name, part of its range, time."""
    name = max(found, key=lambda key: found[key][0])
    return name, *found[name]


def paths(names):
    """Return the scenarios of these names, all if there are none."""
    known = [*sorted(SCENARIOS.glob("*.yaml")), *sorted((SCENARIOS / "systems").glob("*.yaml"))]
    return [path for path in known if not names or path.stem in names]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="scenarios, all if none")
    parser.add_argument("--set", action="append", default=[], dest="changes", metavar="KEY=VALUE")
    parser.add_argument("--json", type=Path, help="write the differences of all channels")
    parser.add_argument("--parts", type=int, default=4, help="finest step, in parts of the own one")
    chosen = parser.parse_args()
    kept = {}
    for path in paths(chosen.names):
        try:
            scenario = ready(path, chosen.changes)
            runs = [record(*scenario, parts) for parts in (1, 2, chosen.parts)]
        except Exception as error:
            print(f"{path.stem:32} {type(error).__name__}: {error}", flush=True)
            continue
        halves, quarters = differences(runs[0], runs[1]), differences(runs[0], runs[2])
        kept[path.stem] = {"half": halves, "quarter": quarters}
        count = sum(part > BAND for part, _ in halves.values())
        print(
            f"{path.stem:32} {runs[0].seconds:7.2f} s  "
            f"half {worst(halves)[1]:8.1e} {worst(halves)[0]} at {worst(halves)[2]:.3f} s  "
            f"quarter {worst(quarters)[1]:8.1e} {worst(quarters)[0]}  "
            f"{count} of {len(halves)} channels above {BAND:.0%}",
            flush=True,
        )
    if chosen.json:
        chosen.json.write_text(json.dumps(kept, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
