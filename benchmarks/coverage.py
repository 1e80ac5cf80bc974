"""How often 95 % intervals hold the truth: ``python benchmarks/coverage.py [SEEDS]``.

Five parameters of a quarter car on its shaker are identified from its own height and strut force,
to which noise of five per cent of their root mean square is added, anew for each seed.
"""

from __future__ import annotations

import sys

import numpy as np
from scipy.stats import f as fisher

import vehicledyn.catalogue  # noqa: F401 - registers models, tyres, solvers
from vehicledyn.analyses.sensitivity.motion_study import MotionStudy
from vehicledyn.interface.targets import read_scenario
from vehicledyn.studies.identification import experiments
from vehicledyn.studies.identification.experiments import Measured
from vehicledyn.studies.identification.identify import identify

CHANNELS = ("body.height", "strut.force")
NAMES = ("body.stiffness", "body.damping", "wheel.stiffness", "body.mass", "wheel.mass")
SETTINGS = ("duration=2 s", "solver={kind: rk4, step: 5 ms}", "output.interval=10 ms")
NOISE = 0.05


def quiet(*_: object) -> None:
    """Report nothing."""


def main() -> None:
    """Identify with each seed and count."""
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    loaded = read_scenario("quarter_car", list(SETTINGS))
    study = MotionStudy.of(loaded, list(CHANNELS), quiet)
    experiments.MotionStudy.of = staticmethod(lambda *_, **__: study)  # prepared once for all
    e, motion = study.prepared.equations, study.plain(quiet)
    pairs = zip(e.parameters, study.prepared.kernel.parameters, strict=True)
    values = {p.name: float(v) for p, v in pairs}
    truth = np.array([values[name] for name in NAMES])
    bounds = {n: {"from": 0.3 * values[n], "to": 3.0 * values[n]} for n in NAMES}
    for name in NAMES:
        bounds[name]["start"] = 1.5 * values[name]
    own = [e.channels[k].name for k in study.channels]
    clean = {name: motion.values[:, own.index(name)] for name in CHANNELS}
    inside, together, region, runs = np.zeros(len(NAMES), dtype=int), 0, 0, 0
    for seed in range(seeds):
        rng, measured = np.random.default_rng(seed), []
        for name, y in clean.items():
            noise = NOISE * float(np.std(y))
            noisy = y + noise * rng.normal(size=len(y))
            measured.append(Measured(name, motion.times, noisy, noise))
        found = identify(loaded, measured, bounds, quiet).found
        held = (found.intervals[:, 0] <= truth) & (truth <= found.intervals[:, 1])
        free = sum(len(m.times) for m in measured) - len(NAMES)
        at_truth = sum(
            float(np.sum(((clean[m.channel] - m.values) / m.noise) ** 2)) for m in measured
        )
        ratio = (at_truth / found.variance - free) / len(NAMES)
        inside += held
        together += bool(held.all())
        region += bool(ratio <= fisher.ppf(0.95, len(NAMES), free))
        runs += found.n_runs
    print(f"{seeds} seeds, {runs / seeds:.1f} runs each; the truth lies")
    for name, count in zip(NAMES, inside, strict=True):
        print(f"  inside the interval of {name}: {count}")
    print(f"  inside all intervals at once: {together}")
    print(f"  inside the 95 % region of the likelihood ratio: {region}")


if __name__ == "__main__":
    main()
