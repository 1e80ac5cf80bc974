"""Limit cycles with flange contact, closed as periodic orbits, against simulations."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from reference_cases.comparison import Group, exactly, figure
from reference_cases.system_files import FOLDER, quiet

SPEEDS = (48.0, 47.0, 46.0)
"""Speeds at which cycles are compared [m/s]."""

LOWEST, RESOLUTION, STEP = 45.0, 0.05, 0.2
"""Speed below that at which the cycle dies, how finely that is searched for in simulations, and
the largest step of the continuation [m/s]."""

SIMULATED = "simulation until it repeats"
DISTURBANCE = 8e-3
WATCHED = "wheelset.lateral"


class Found(NamedTuple):
    """Amplitude [m] and period [s] of a cycle by simulation and as a periodic orbit.

    ``unlike`` is by how much its three largest multipliers differ from those by half of its motion.
    """

    amplitudes: tuple[float, float]
    periods: tuple[float, float]
    trivial: float
    unlike: float


class Lowest(NamedTuple):
    """The speed at which the cycle dies, by simulation and as the fold of its branch [m/s]."""

    simulated: float
    fold: float


def compare():
    """Return the comparisons."""
    note = (
        "rail_wheelset on S1002 wheels and 60E1 rails: a stable cycle in which both flanges touch, "
        "as a simulation settles to it whose speed is lowered in steps, and as the periodic orbit "
        "that shooting closes there; then the speed at which the simulated cycle dies, and the "
        "fold of the branch that is followed from the cycle at 46 m/s. Bands: 0.5 %, and 1e-3 for "
        "the trivial Floquet multiplier."
    )
    found, lowest = study()
    rows = []
    for speed, cycle in zip(SPEEDS, found, strict=True):
        amplitudes = [1e3 * a for a in cycle.amplitudes]
        place = f"limit cycle with flange contact at {speed:g} m/s"
        rows += [
            figure(
                SIMULATED, f"{place}, lateral amplitude",
                reference=amplitudes[0], computed=amplitudes[1], band=0.03, unit="mm", digits=2,
            ),
            figure(
                SIMULATED, f"{place}, period",
                reference=cycle.periods[0], computed=cycle.periods[1], band=7e-4, unit="s",
                digits=4,
            ),
        ]  # fmt: skip
    rows.append(
        figure(
            SIMULATED, "speed down to which the cycle lives, fold of its branch",
            reference=lowest.simulated, computed=lowest.fold, band=0.2, unit="m/s", digits=2,
        )
    )  # fmt: skip
    off = max(abs(cycle.trivial - 1.0) for cycle in found)
    rows.append(
        exactly(
            "theory", "cycles whose trivial multiplier is 1 within 1e-3", "all",
            "all" if off < 1e-3 else f"one is off by {off:.1e}",
        )
    )  # fmt: skip
    unlike = max(cycle.unlike for cycle in found)
    rows.append(
        exactly(
            "the whole of the motion",
            "cycles whose multipliers by half of the motion, the other half its mirror image, are "
            "those by the whole within 1e-3",
            "all", "all" if unlike < 1e-3 else f"one is off by {unlike:.1e}",
        )
    )  # fmt: skip
    return Group("Limit cycles with flange contact", note, tuple(rows))


@cache
def study():
    """Return the cycles at all speeds, and the speed at which they die."""
    from vehicledyn.analyse.periodic.autonomous import AutonomousField
    from vehicledyn.analyse.periodic.critical import follow_balance
    from vehicledyn.analyse.settling.parameter_rampdown import balances_near, lower
    from vehicledyn.analyse.settling.simulated_cycles import Runner
    from vehicledyn.analyses.preparation.prepare import prepare, reference_point
    from vehicledyn.files.scenario import load_model

    overrides = [f"parameters.speed={SPEEDS[0]} m/s"]
    target = load_model(str(FOLDER / "rail_wheelset.yaml"), overrides)
    prepared = prepare(target, backend="auto", progress=quiet)
    point = reference_point(prepared, SPEEDS[0], None)
    model = AutonomousField(prepared.equations, "speed", prepared.kernel.parameters)
    speeds = (*SPEEDS, LOWEST)
    known = follow_balance(model, speeds, model.reduced(point.state), point.unknowns)
    watched = [c.name for c in prepared.equations.channels].index(WATCHED)
    runner, settled = Runner(prepared.kernel, model, watched), []
    lowered = lower(
        runner, speeds, balances_near(model, known), DISTURBANCE,
        resolution=RESOLUTION, report=settled.append,
    )  # fmt: skip
    cycles = settled[: len(SPEEDS)]
    return [_closed(model, c) for c in cycles], Lowest(
        0.5 * sum(lowered.between), _fold(model, cycles[-1])
    )


def _fold(model, settled):
    """Return the speed at which the branch of a simulated cycle folds below it [m/s]."""
    from vehicledyn.analyse.periodic.branch import follow_cycles
    from vehicledyn.analyse.periodic.cycle_points import Limits

    start = settled.orbit(model, intervals=30, degree=4)
    limits = Limits(LOWEST, settled.value + STEP, STEP, points=40)
    branch = follow_cycles(model, start, None, limits, upwards=False)
    (fold,) = (p for p in branch.special if p.kind == "fold")
    return float(fold.orbit.parameter)


def _closed(model, settled):
    """Return the numbers of a simulated cycle and of the periodic orbit there."""
    from vehicledyn.analyse.periodic.multiple_shooting import closed

    found = closed(model, settled.orbit(model, intervals=30, degree=4))
    motion = found.orbit.sample(np.linspace(0.0, 1.0, 4000, endpoint=False))[0]
    amplitude = 0.5 * float(np.ptp(motion[:, model.names.index(WATCHED)]))
    return Found(
        (settled.amplitude, amplitude),
        (settled.period, found.orbit.period),
        found.passages.trivial,
        _unlike(model, found),
    )


def _unlike(model, found):
    """Return by how much the largest multipliers by half of a motion differ from its own."""
    from vehicledyn.analyse.periodic.cycle_points import Limits
    from vehicledyn.analyse.periodic.floquet import multipliers_of
    from vehicledyn.analyse.periodic.orbit_steps import BranchSteps

    value = found.orbit.parameter
    limits = Limits(value - STEP, value + STEP, STEP)
    point = BranchSteps(model, limits, found.orbit.intervals).first_at(found.orbit, 1.0)
    if point.passages.mirror is None:
        return np.inf
    pairs = multipliers_of(found.passages).others[:3], point.multipliers.others[:3]
    return float(np.abs(np.subtract(*map(np.sort_complex, pairs))).max())
