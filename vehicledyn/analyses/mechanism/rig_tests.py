"""Tests of the suspension rig: what each controls and what it shows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from vehicledyn.analyses.mechanism import rig_quantities as q
from vehicledyn.analyses.mechanism.rig_bench import Bench
from vehicledyn.analyses.mechanism.rig_quantities import RigQuantity

Controls = Callable[[Bench, float], dict[str, float]]


@dataclass(frozen=True)
class RigTest:
    """A test: what it controls, over which range if none is given, and what it shows.

    ``controls`` are linear: those of 1 are the direction that slopes are along.
    """

    control: str
    unit: str
    text: str
    usual: tuple[float, float, int]
    controls: Controls
    quantities: tuple[RigQuantity, ...]


def _each(name: str) -> Controls:
    return lambda bench, value: {f"rig.{name}_{k}": value for k in range(len(bench.corners))}


def of_one_wheel(name: str, corner: int) -> Controls:
    """Return what sets a parameter of the rig at one wheel."""
    return lambda _, value: {f"rig.{name}_{corner}": value}


def _rolled(bench: Bench, value: float) -> dict[str, float]:
    """Return travels as of a road that rolls to the left under the axle, wheels at their y."""
    tracks = bench.design_tracks
    return {f"rig.travel_{k}": value * y for k, y in enumerate(tracks)}


TESTS = {
    "parallel": RigTest(
        "travel",
        "m",
        "Travel of the contact points upwards",
        (-0.06, 0.06, 24),
        _each("travel"),
        (*q.ANGLES, *q.POSITION, *q.LOAD, *q.TRAVEL, *q.LIFTING, *q.NAMED_AXIS),
    ),
    "roll": RigTest(
        "roll",
        "rad",
        "Roll of the wheels against the body, positive where the left wheel rises",
        (-0.06, 0.06, 24),
        _rolled,
        (*q.ANGLES, *q.POSITION, *q.LOAD, *q.ROLL),
    ),
    "steer": RigTest(
        "steering",
        "m",
        "Steering coordinate",
        (-0.05, 0.05, 20),
        lambda _, value: {"rig.steering": value},
        (*q.ANGLES, *q.POSITION, *q.LOAD, *q.STEER, *q.AXIS),
    ),
    "lateral": RigTest(
        "side_force",
        "N",
        "Side force to the left at each contact point",
        (-3000.0, 3000.0, 12),
        _each("force_y"),
        (*q.ANGLES, *q.LOAD, *q.BY_FORCE, *q.BY_SIDE_FORCE),
    ),
    "longitudinal": RigTest(
        "longitudinal_force",
        "N",
        "Force forward at each contact point, the wheel held on its carrier",
        (-3000.0, 3000.0, 12),
        _each("force_x"),
        (*q.ANGLES, *q.LOAD, *q.BY_FORCE, *q.BY_LONGITUDINAL_FORCE),
    ),
    "aligning": RigTest(
        "moment",
        "N*m",
        "Moment to the left about the vertical axis at each wheel",
        (-100.0, 100.0, 10),
        _each("moment"),
        (*q.ANGLES, *q.LOAD, *q.BY_MOMENT),
    ),
}
"""Tests of the rig by name."""
