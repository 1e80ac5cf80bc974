"""How often 95 % intervals hold the truth: ``python benchmarks/coverage.py [SEEDS] [MODEL]``.

Parameters are identified from a model's own signals, to which noise of five per cent of their
deviation is added, anew for each seed: five of a quarter car on its shaker (``quarter_car``), ten
of an Iltis in a slalom on a wavy road (``iltis``).
"""

from __future__ import annotations

import sys
from dataclasses import dataclass

import numpy as np
from scipy.stats import f as fisher

import vehicledyn.catalogue  # noqa: F401 - registers models, tyres, solvers
from vehicledyn.analyses.sensitivity.motion_study import MotionStudy
from vehicledyn.base.step_memory import Memory, Shelf
from vehicledyn.interface.targets import read_scenario
from vehicledyn.studies.identification import experiments
from vehicledyn.studies.identification.experiments import Experiment, Fitting, MeasuredChannel
from vehicledyn.studies.identification.identify import identify_from

NOISE = 0.05


@dataclass(frozen=True)
class Case:
    """A scenario with its changes, the channels measured and the parameters identified.

    The search begins at ``start`` times the truth.
    """

    scenario: str
    settings: tuple[str, ...]
    channels: tuple[str, ...]
    names: tuple[str, ...]
    start: float


CASES = {
    "quarter_car": Case(
        "quarter_car",
        ("duration=2 s", "solver={kind: rk4, step: 5 ms}", "output.interval=10 ms"),
        ("body.height", "strut.force"),
        ("body.stiffness", "body.damping", "wheel.stiffness", "body.mass", "wheel.mass"),
        1.5,
    ),
    "iltis": Case(
        "iltis_slalom",
        (
            "duration=5 s",
            "road={kind: sine, amplitude_x: 8 mm, wavelength_x: 4 m, amplitude_y: 8 mm, "
            "wavelength_y: 3 m}",
            "solver={kind: rk4, step: 2 ms}",
            "output.interval=10 ms",
        ),
        (
            "chassis.roll_rate", "chassis.pitch_rate", "body.yaw_rate", "accelerometer.vertical",
            "accelerometer.lateral", "suspension_fl.a_arm_angle_rate",
            "suspension_rr.a_arm_angle_rate",
        ),
        (
            "chassis.mass", "chassis.inertia_roll", "chassis.inertia_pitch", "chassis.inertia_yaw",
            "leaf_spring.stiffness", "wheel.mass", "wheel.vertical_stiffness",
            "shock_absorber.damping_c1", "tyres.front.lateral.a3", "tyres.rear.lateral.a3",
        ),
        1.0,
    ),
}  # fmt: skip


def quiet(*_: object) -> None:
    """Report nothing."""


def main() -> None:
    """Identify with each seed and count."""
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    case = CASES[sys.argv[2] if len(sys.argv) > 2 else "quarter_car"]
    names = case.names
    loaded = read_scenario(case.scenario, list(case.settings))
    study = MotionStudy.of(loaded, list(case.channels), quiet)
    experiments.MotionStudy.of = staticmethod(lambda *_, **__: study)  # prepared once for all
    Fitting.unconfirmed = lambda *_: []  # derivatives are not in doubt here
    kept = Memory(Shelf())  # all seeds begin with the same run
    e, motion = study.prepared.equations, study.plain(quiet)
    pairs = zip(e.parameters, study.prepared.kernel.parameters, strict=True)
    values = {p.name: float(v) for p, v in pairs}
    truth = np.array([values[name] for name in names])
    bounds = {n: {"from": 0.3 * values[n], "to": 3.0 * values[n]} for n in names}
    for name in names:
        bounds[name]["start"] = case.start * values[name]
    own = [e.channels[k].name for k in study.channels]
    clean = {name: motion.values[:, own.index(name)] for name in case.channels}
    inside, together, region, runs = np.zeros(len(names), dtype=int), 0, 0, 0
    for seed in range(seeds):
        rng, measured = np.random.default_rng(seed), []
        for name, y in clean.items():
            noise = NOISE * float(np.std(y))
            noisy = y + noise * rng.normal(size=len(y))
            measured.append(MeasuredChannel(name, motion.times, noisy, noise))
        measurement = [Experiment("", loaded, tuple(measured))]
        found = identify_from("", measurement, bounds, progress=quiet, runs=kept).found
        held = (found.intervals[:, 0] <= truth) & (truth <= found.intervals[:, 1])
        free = sum(len(m.times) for m in measured) - len(names)
        at_truth = sum(
            float(np.sum(((clean[m.channel] - m.values) / m.noise) ** 2)) for m in measured
        )
        ratio = (at_truth / found.variance - free) / len(names)
        inside += held
        together += bool(held.all())
        region += bool(ratio <= fisher.ppf(0.95, len(names), free))
        runs += found.n_runs
        print(f"seed {seed}: {int(held.sum())} of {len(names)} inside", file=sys.stderr, flush=True)
        if seed == 0:
            widths = 0.5 * np.diff(found.intervals)[:, 0] / truth
    print(f"{seeds} seeds, {runs / seeds:.1f} runs each; the truth lies")
    for name, count, width in zip(names, inside, widths, strict=True):
        print(f"  inside the interval of {name}: {count} (+- {width:.2%})")
    print(f"  inside an interval: {inside.mean():.1f} of {seeds} on average")
    print(f"  inside all intervals at once: {together}")
    print(f"  inside the 95 % region of the likelihood ratio: {region}")


if __name__ == "__main__":
    main()
