"""Cars driven as in the recorded runs of Chrono::Vehicle, and the runs themselves."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.multibody.elements.drives import TimeLaw
from vehicledyn.multibody.model.parts import BasePart, Loads, Wrench
from vehicledyn.road.manoeuvres.manoeuvre import RoadManoeuvre
from vehicledyn.symbolic import ops

ROOT = Path(__file__).parents[2]
RUNS = ROOT.parent / "shared" / "reference" / "road" / "vehicles" / "chrono_runs"
STEP_TIME = 4.0
"""When the recorded runs steer [s]."""


@dataclass(frozen=True)
class _Pull(BasePart):
    """A force at the centre of mass along the chassis's x axis that holds the speed."""

    chassis: str
    target: object
    gain: object

    def loads(self, situation):
        kinematics = situation.kinematics
        turn = kinematics.rotation(self.chassis)
        speed = (turn.T @ kinematics.velocity(self.chassis))[0]
        force = ops.vector(self.gain * (self.target - speed), 0.0, 0.0)
        return Loads(wrenches=(Wrench(self.chassis, force, ops.vector(0.0, 0.0, 0.0)),))


@register("manoeuvre", "chrono_step")
class ChronoStep(RoadManoeuvre):
    """A step of 0.1 s of the steering while a force at the centre of mass holds the speed."""

    rack: float = quantity("m", "Steering coordinate after the step")
    gain: float = quantity("N*s/m", "Force over the error of speed")
    begin: float = quantity("s", "When it begins")

    def fit(self, vehicle):
        """Return the vehicle steered and pulled."""

        def law(time):
            return self.rack * ops.minimum(ops.maximum((time - self.begin) / 0.1, 0.0), 1.0)

        pull = _Pull("pull", vehicle.chassis, vehicle.speed, self.gain)
        return super().fit(vehicle).with_parts(TimeLaw("steer", vehicle.rack, law), pull)


def recorded(name):
    """Return the columns of a recorded run; skip where there is none."""
    path = RUNS / f"{name}.csv"
    if not path.exists():
        pytest.skip(f"no reference data: {path.name}")
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


def rise_time(time, values, share):
    """Return when values first pass a share of their last one [s]."""
    target = share * values[-1]
    k = int(np.argmax(values >= target))
    return float(np.interp(target, values[k - 1 : k + 1], time[k - 1 : k + 1]))
