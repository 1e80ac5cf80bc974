"""Limit cycles with flange contact by continuation against simulations of the same wheelset."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from reference_cases.comparison import Group, exactly, figure
from reference_cases.system_files import FOLDER, quiet

FIRST, LAST, COMPARED = 48.0, 45.0, 46.0
"""Speeds between which the wheelset is slowed down, and where cycles are compared [m/s]."""

SIMULATED = "simulation, slowed down"
DISTURBANCE = 8e-3
RESOLUTION = 5e-3
WATCHED = "wheelset.lateral"


class Found(NamedTuple):
    """Amplitudes [m] and periods [s] at one speed and fold speeds [m/s], first by simulation."""

    amplitudes: tuple[float, float]
    periods: tuple[float, float]
    folds: tuple[float, float]
    trivial: float


def compare():
    """Return the comparisons."""
    note = (
        "rail_wheelset on S1002 wheels and 60E1 rails: a stable cycle in which both flanges touch, "
        "followed by continuation through the fold at which it ends, and by simulations whose "
        "speed falls in steps, halved until the last cycle lives within 5 mm/s of the value at "
        "which it dies. Bands: 0.5 %, and 1e-3 for the trivial Floquet multiplier."
    )
    found = study()
    amplitudes, periods, folds = (
        (1e3 * a for a in found.amplitudes), found.periods, found.folds
    )  # fmt: skip
    simulated, continued = amplitudes
    rows = (
        figure(
            SIMULATED, f"limit cycle with flange contact at {COMPARED:g} m/s, lateral amplitude",
            reference=simulated, computed=continued, band=0.03, unit="mm", digits=2,
        ),
        figure(
            SIMULATED, "the same, period",
            reference=periods[0], computed=periods[1], band=7e-4, unit="s", digits=4,
        ),
        figure(
            SIMULATED, "lowest speed of that cycle (fold)",
            reference=folds[0], computed=folds[1], band=0.2, unit="m/s", digits=2,
        ),
        exactly(
            "theory",
            "cycles of the branch, through the fold, whose trivial multiplier is 1 within 1e-3",
            "all",
            "all" if found.trivial < 1e-3 else f"one is off by {found.trivial:.1e}",
        ),
    )  # fmt: skip
    return Group("Limit cycles with flange contact", note, rows)


@cache
def study():
    """Return the numbers of both ways."""
    from vehicledyn.run.prepare import prepare, reference_point
    from vehicledyn.scenario import load_model
    from vehicledyn.solve.periodic.autonomous import AutonomousField
    from vehicledyn.solve.periodic.critical import follow_balance
    from vehicledyn.solve.periodic.settled import Runner, balances_near, lower, steps

    target = load_model(str(FOLDER / "rail_wheelset.yaml"), [f"parameters.speed={FIRST} m/s"])
    prepared = prepare(target, backend="auto", progress=quiet)
    point = reference_point(prepared, FIRST, None, is_system=True)
    model = AutonomousField(prepared.equations, "speed", prepared.kernel.parameters)
    speeds = np.linspace(FIRST, LAST, 7)
    known = follow_balance(model, speeds, model.reduced(point.state), point.unknowns)
    watched = [c.name for c in prepared.equations.channels].index(WATCHED)
    runner, settled = Runner(prepared.kernel, model, watched), []
    ended = lower(
        runner, list(steps(FIRST, LAST, 4)), balances_near(model, known), DISTURBANCE,
        resolution=RESOLUTION, told=settled.append,
    )  # fmt: skip
    branch = _followed(model, settled[0])
    (fold,) = (p.orbit.parameter for p in branch.special if p.kind == "fold")
    at = next(s for s in settled if s.value == COMPARED)
    amplitude, period = _cycle(model, branch)
    return Found(
        (at.amplitude, amplitude),
        (at.period, period),
        (0.5 * sum(ended), fold),
        max(abs(p.multipliers.trivial - 1.0) for p in branch.points),
    )


def _followed(model, settled):
    """Return the branch from a simulated cycle down through its fold."""
    from vehicledyn.solve.periodic.branch import Limits, follow_cycles

    start = settled.orbit(model, intervals=30, degree=4)
    limits = Limits(LAST, FIRST + 0.1, 0.5, points=22)
    return follow_cycles(model, start, None, limits, upwards=False)


def _cycle(model, branch):
    """Return lateral amplitude and period of the stable cycle where cycles are compared."""
    from vehicledyn.solve.periodic.branch import cycle_at

    (cycle,) = (c for c in cycle_at(model, branch, COMPARED) if c.stable)
    motion = cycle.orbit.sample(np.linspace(0.0, 1.0, 4000, endpoint=False))[0]
    return 0.5 * float(np.ptp(motion[:, model.names.index(WATCHED)])), cycle.orbit.period
