"""Measure the accuracy watch: ``python benchmarks/accuracy_watch.py [--number 100] [--seed 1]``.

Scenarios that come with the program, or those of them that are named, run with random methods and
steps, from a half of their own step to two hundred times it. The truth is a run with RK4 or ``rkc``
at an eighth of their step. Printed are, per run, how far its worst key figure is off, what the
watch says and what it costs; and in the end how many bad runs (more than 5 % off, or ended early)
it finds, how many good ones (less than 1 % off) it warns of, and what it says of those between.
``--coarse 10`` draws steps from ten times the scenario's own upwards, of which most are bad;
``--coarsest 10`` none beyond ten times it, of which most are good. ``--jumping`` takes random
masses on forces that jump in place of the scenarios; there a curve counts, too, that is off by more
than a tenth of its range and does not only come a little late. ``--cost`` measures the
processor time of integrations with and without the watch, which take turns, and compares it with
that of the whole run: from the scenario in memory, its kernel compiled, to the closed file. It
visits all scenarios that come with the program and have a fixed step, or those that are named.
"""

from __future__ import annotations

import argparse
import time
from contextlib import ExitStack
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import patch

import numpy as np
from jumping_systems import jumping_systems

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.analyses.simulation.judgement import judged_by
from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.registry import find
from vehicledyn.files.scenario import load_scenario
from vehicledyn.integrate.accuracy.curves import curves_apart
from vehicledyn.integrate.channel_ranges import Ranges
from vehicledyn.integrate.judged_quantities import FigureSizes, figure_errors

SCENARIOS = Path(__file__).resolve().parents[1] / "scenarios"
NAMES = (
    "bogie_hunting",
    "iltis_bump_anti_phase",
    "iltis_ramp_steer",
    "iltis_sine_steer",
    "iltis_slalom",
    "iltis_standstill",
    "wheelset_limit_cycle",
    "systems/all_wheel_drive_sedan",
    "systems/assembled_car",
    "systems/automatic_sedan",
    "systems/ball_in_tube",
    "systems/ball_in_tube_dependent",
    "systems/bicycle",
    "systems/cam_follower",
    "systems/car_and_caravan",
    "systems/car_of_parts",
    "systems/coach_of_two_bogies",
    "systems/cooperrider_classic",
    "systems/double_pendulum",
    "systems/double_spring_mass",
    "systems/double_wishbone_suspension",
    "systems/five_link_suspension",
    "systems/flexible_axle_wheelset",
    "systems/four_bar",
    "systems/geneva_drive",
    "systems/jeep",
    "systems/jeep_suspension",
    "systems/macpherson_suspension",
    "systems/manchester_bogie",
    "systems/manual_sedan",
    "systems/mecanum_cart",
    "systems/merry_go_round",
    "systems/motorcycle",
    "systems/off_road_truck_rough",
    "systems/off_road_truck_sand",
    "systems/off_road_truck_slope",
    "systems/omni_cart",
    "systems/parallelogram",
    "systems/quarter_car",
    "systems/radial_wheelset",
    "systems/radiation_counter",
    "systems/rail_wheelset",
    "systems/roller_pendulum",
    "systems/rolling_disk",
    "systems/screw_jack",
    "systems/sedan",
    "systems/simple_wheelset",
    "systems/slider_crank",
    "systems/slider_crank_flexible",
    "systems/slider_crank_two_angles",
    "systems/small_car",
    "systems/small_cart",
    "systems/small_cart_2",
    "systems/t_handle",
    "systems/testset_wheelset",
    "systems/tractor_semitrailer",
    "systems/tricycle",
    "systems/upright_disk",
    "systems/valve_train",
)
"""Scenarios with key figures whose truth takes seconds; that of the others takes minutes."""
WATCHES = (
    "vehicledyn.integrate.fixed_step.watch_of",
    "vehicledyn.analyses.simulation.partitions.repartitioning._Pieces.accuracy_watch",
)
"""Where the watch comes into a run."""
BAD, GOOD = 0.05, 0.01
"""Errors of a key figure from which a run is bad, and up to which it is good."""
ENOUGH = 20.0
"""Processor time after which the cost of a scenario is not measured once more [s]."""
ELSEWHERE = 0.1
"""Distance of curves, in parts of their ranges, from which a run is bad."""
METHODS = ("rk4", "rk4", "symplectic_euler")
IMPLICIT = ("newmark", "hht", "generalised_alpha")
FINE = 4
"""Steps of the truth in the step of a scenario, or in a tenth of its sampling interval."""


@dataclass(frozen=True)
class Finding:
    """What is true of a run, and what the watch said: "accurate", "inaccurate" or "failed"."""

    error: float
    worst: str
    verdict: str
    told: str
    extra: float


@cache
def prepared(name):
    """Return the scenario with its equations and start."""
    loaded = load_scenario(SCENARIOS / f"{name}.yaml")
    return loaded, *prepare_run(loaded, backend="auto", progress=quiet)


def own_step(loaded):
    """Return the step of a scenario, or a tenth of its sampling interval [s]."""
    return getattr(loaded.scenario.solver, "step", None) or loaded.scenario.output.interval / 10.0


def record(name, solver, interval):
    """Run a scenario; return statistics or the reason of a failure, its times and channels."""
    loaded, made, start = prepared(name)
    judged = judged_by(made.subject, made.equations)
    times, values = [], []

    def take(t, x, z, y):
        times.append(t.copy())
        values.append(y[:, judged.channels])

    with np.errstate(all="ignore"):
        try:
            outcome = simulate_monitored(
                made.subject.system,
                made.kernel,
                solver,
                start=0.0,
                stop=loaded.scenario.duration,
                state=start.state,
                unknowns=start.unknowns,
                interval=interval,
                sink=take,
                progress=quiet,
                happened=quiet,
                watch=lambda: made.watch,
                judged=judged,
            )
        except NumericalError as error:
            outcome = str(error)
        samples = np.concatenate(times), np.vstack(values)
        figures = judged.figures(*samples)
        balance = None if judged.balance is None else judged.balance(*samples)
    ranges = Ranges.of(made.equations, judged.channels)
    ranges.take(np.vstack(values))
    return outcome, figures, ranges, balance, np.vstack(values)


@cache
def truth(name, interval):
    """Return figures and sizes of a fine run, None where half its step leads elsewhere."""
    loaded, made, _ = prepared(name)
    own = loaded.scenario.solver
    kind = "rkc" if own.kind == "rkc" else "rk4"
    more = {"stages": own.stages} if kind == "rkc" else {}
    count = np.ceil(interval / own_step(loaded) * FINE)
    channels = judged_by(made.subject, made.equations).channels
    found = []
    for divided in (1, 2):
        step = interval / (divided * count)
        outcome, figures, ranges, balance, values = record(
            name, find("solver", kind)(step=step, **more), interval
        )
        sizes = FigureSizes.of(made.equations, channels, ranges)
        found.append((figures, sizes, balance, values, ranges.scales()))
    errors = figure_errors(found[0][0], *found[1][:2])
    settled = not isinstance(outcome, str) and max(errors.values(), default=0.0) < 0.5 * GOOD
    return found[1] if settled and outcome.ended_by is None and errors else None


def judge(name, solver, interval):
    """Return how a run is off and what the watch says, None where the truth is not known."""
    known = truth(name, interval)
    if known is None:
        return None
    outcome, figures, _, balance, values = record(name, solver, interval)
    errors = figure_errors(figures, *known[:2])
    if Path(name).is_absolute() and len(values) == len(known[3]):
        distance = float((curves_apart(values, known[3]) / known[4]).max())
        errors |= {"curve": distance} if distance > ELSEWHERE else {}
    if balance and known[2] and solver.kind != "symplectic_euler":
        errors["energy_drift"] = balance.distance(known[2])
    worst = max(errors, key=errors.get)
    if isinstance(outcome, str):
        return Finding(errors[worst], worst, "failed", outcome, 0.0)
    said = outcome.accuracy
    error = np.inf if outcome.ended_by else errors[worst]
    told = said.warning or f"{said.error:.1e} {said.worst}"
    return Finding(error, worst, said.verdict, told, said.extra_steps / outcome.steps)


def draw(random, names, coarse, coarsest):
    """Return a scenario, a method with a step, and the sampling interval [s]."""
    name = names[random.integers(len(names))]
    loaded, _, _ = prepared(name)
    s = loaded.scenario
    wanted = own_step(loaded) * 10.0 ** random.uniform(*np.log10((coarse, coarsest)))
    whole = round(s.duration / s.output.interval)
    multiples = [m for m in range(1, whole // 20) if whole % m == 0]
    times = min(multiples, key=lambda m: abs(np.log(m * s.output.interval / max(wanted, 1e-9))))
    interval = s.output.interval * (times if wanted > s.output.interval else 1)
    step = interval / max(1, round(interval / wanted))
    if s.solver.kind == "rkc":
        return name, find("solver", "rkc")(step=step, stages=s.solver.stages), interval
    kinds = (*METHODS, *IMPLICIT) if Path(name).is_absolute() else METHODS
    kind = kinds[random.integers(len(kinds))]
    return name, find("solver", kind)(step=step), interval


def campaign(number, seed, names=NAMES, coarse=0.5, coarsest=200.0):
    """Run and print so many combinations; return the findings."""
    random, found = np.random.default_rng(seed), []
    while len(found) < number:
        name, solver, interval = draw(random, names, coarse, coarsest)
        finding = judge(name, solver, interval)
        if finding is None:
            continue
        found.append(finding)
        print(
            f"{name.split('/')[-1]:26s} {solver.kind[:5]:5s} {solver.step * 1e3:9.4f} ms  "
            f"{class_of(finding):4s} {finding.error:8.1e} {finding.worst[:28]:28s} "
            f"{finding.verdict:10s} {finding.extra:6.3f}  {finding.told[:90]}",
            flush=True,
        )
    return found


def class_of(finding):
    """Return "bad", "good", or "grey" for what lies between."""
    if not finding.error <= BAD:
        return "bad"
    return "good" if finding.error < GOOD else "grey"


def summary(found):
    """Return lines that count the findings."""
    lines = []
    for name in ("bad", "grey", "good"):
        chosen = [finding for finding in found if class_of(finding) == name]
        warned = sum(finding.verdict != "accurate" for finding in chosen)
        lines.append(f"{name}: {len(chosen)} runs, {warned} warned of or failed")
    return lines


def cost(repetitions, names):
    """Print the processor time of runs with and without the watch, and of whole commands."""
    worst = 0.0
    for path in [
        *sorted(SCENARIOS.glob("*.yaml")),
        *sorted((SCENARIOS / "systems").glob("*.yaml")),
    ]:
        if not names or path.stem in names:
            worst = max(worst, cost_of(path.relative_to(SCENARIOS).with_suffix(""), repetitions))
    print(f"at most {100.0 * worst:.2f} % of a run")


def cost_of(name, repetitions):
    """Print the same of one scenario; return the watch's part of the whole run."""
    if not hasattr(load_scenario(SCENARIOS / f"{name}.yaml").scenario.solver, "fixed_method"):
        return 0.0
    loaded, _, _ = prepared(name)
    spent, begun = {True: [], False: []}, time.process_time()
    while len(spent[False]) < repetitions and time.process_time() - begun < ENOUGH:
        for watched in (True, False):
            seconds, outcome = integration(name, loaded.scenario, watched=watched)
            spent[watched].append(seconds)
            if watched:
                share = outcome.accuracy.extra_steps / outcome.steps
    seen, unseen = (min(spent[key]) for key in (True, False))
    part = (seen - unseen) / min(whole_run(loaded) for _ in range(2))
    print(
        f"{name.name:28s} {unseen * 1e3:8.1f} ms without, {seen * 1e3:8.1f} ms with: "
        f"{(seen - unseen) * 1e3:6.2f} ms, {100.0 * (seen / unseen - 1.0):5.1f} % of the "
        f"integration, {100.0 * share:5.2f} % of its steps, {100.0 * part:5.2f} % of the run",
        flush=True,
    )
    return part


def integration(name, scenario, *, watched):
    """Integrate with or without the watch; return the processor time [s] and the outcome."""
    with ExitStack() as stack:
        for place in () if watched else WATCHES:
            stack.enter_context(patch(place, lambda *_: None))
        begun = time.process_time()
        outcome, *_ = record(name, scenario.solver, scenario.output.interval)
        return time.process_time() - begun, outcome


def whole_run(loaded):
    """Return the processor time of a run from the scenario in memory to its closed file [s]."""
    with TemporaryDirectory() as folder:
        begun = time.process_time()
        run_scenario(loaded, output=Path(folder) / "run.h5", backend="auto", progress=quiet)
        return time.process_time() - begun


def quiet(*_):
    """Tell nobody."""


def main():
    """Run the campaign, or measure what the watch costs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--number", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--coarse", type=float, default=0.5, help="smallest multiple of the own step"
    )
    parser.add_argument(
        "--coarsest", type=float, default=200.0, help="largest multiple of the own step"
    )
    parser.add_argument("--jumping", action="store_true", help="masses on forces that jump")
    parser.add_argument("--cost", type=int, metavar="REPETITIONS", default=0)
    parser.add_argument("names", nargs="*", help="scenarios, all if none")
    arguments = parser.parse_args()
    if arguments.cost:
        cost(arguments.cost, arguments.names)
        return
    names = [n for n in NAMES if not arguments.names or Path(n).name in arguments.names]
    with TemporaryDirectory() as folder:
        if arguments.jumping:
            names = jumping_systems(Path(folder), arguments.number, arguments.seed)
        chosen = arguments.number, arguments.seed, names, arguments.coarse, arguments.coarsest
        print("\n".join(summary(campaign(*chosen))))


if __name__ == "__main__":
    main()
