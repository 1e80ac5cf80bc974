"""Limit cycles with flange contact, closed as periodic orbits, against simulations."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from reference_cases.comparison import Group, exactly, figure
from reference_cases.system_files import FOLDER, quiet

SPEEDS = (48.0, 47.0, 46.0)
"""Speeds at which cycles are compared [m/s]; the cycle lives down to 45.4 m/s."""

SIMULATED = "simulation until it repeats"
DISTURBANCE = 8e-3
WATCHED = "wheelset.lateral"


class Found(NamedTuple):
    """Amplitude [m] and period [s] of a cycle by simulation and as a periodic orbit."""

    amplitudes: tuple[float, float]
    periods: tuple[float, float]
    trivial: float


def compare():
    """Return the comparisons."""
    note = (
        "rail_wheelset on S1002 wheels and 60E1 rails: a stable cycle in which both flanges touch, "
        "as a simulation settles to it whose speed is lowered in steps, and as the periodic orbit "
        "that shooting closes there. Bands: 0.5 %, and 1e-3 for the trivial Floquet multiplier."
    )
    found = study()
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
    off = max(abs(cycle.trivial - 1.0) for cycle in found)
    rows.append(
        exactly(
            "theory", "cycles whose trivial multiplier is 1 within 1e-3", "all",
            "all" if off < 1e-3 else f"one is off by {off:.1e}",
        )
    )  # fmt: skip
    return Group("Limit cycles with flange contact", note, tuple(rows))


@cache
def study():
    """Return the cycles at all speeds."""
    from vehicledyn.run.prepare import prepare, reference_point
    from vehicledyn.scenario import load_model
    from vehicledyn.solve.periodic.autonomous import AutonomousField
    from vehicledyn.solve.periodic.critical import follow_balance
    from vehicledyn.solve.periodic.settled import Runner, balances_near, lower

    overrides = [f"parameters.speed={SPEEDS[0]} m/s"]
    target = load_model(str(FOLDER / "rail_wheelset.yaml"), overrides)
    prepared = prepare(target, backend="auto", progress=quiet)
    point = reference_point(prepared, SPEEDS[0], None, is_system=True)
    model = AutonomousField(prepared.equations, "speed", prepared.kernel.parameters)
    known = follow_balance(model, SPEEDS, model.reduced(point.state), point.unknowns)
    watched = [c.name for c in prepared.equations.channels].index(WATCHED)
    runner, settled = Runner(prepared.kernel, model, watched), []
    lower(
        runner, SPEEDS, balances_near(model, known), DISTURBANCE,
        resolution=1.0, told=settled.append,
    )  # fmt: skip
    return [_closed(model, cycle) for cycle in settled]


def _closed(model, settled):
    """Return the numbers of a simulated cycle and of the periodic orbit there."""
    from vehicledyn.solve.periodic.shooting import closed

    found = closed(model, settled.orbit(model, intervals=30, degree=4))
    motion = found.orbit.sample(np.linspace(0.0, 1.0, 4000, endpoint=False))[0]
    amplitude = 0.5 * float(np.ptp(motion[:, model.names.index(WATCHED)]))
    return Found(
        (settled.amplitude, amplitude),
        (settled.period, found.orbit.period),
        found.passages.trivial,
    )
