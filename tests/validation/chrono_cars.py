"""Cars driven as in the recorded runs of Chrono::Vehicle, and the runs themselves."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from pydantic import Field

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


IDLER_TORQUE = {"straight": (-4.316, -5.958, -12.90), "turned": (-16.2, -25.4, -44.2)}
"""Torque on the chassis by the truck's idler arm, before and after the step [N m].

Chrono's joint of the idler arm (ChLinkRevoluteSpherical) holds the steering link along its axis
e by a force λ. Of the force -λ e at the link, r from the pivot p, the chassis gets the torque
λ (p × r/|r| - p × e) about its centre of mass in place of -λ (p + r) × e: the derivative of e·r
by the turns of the chassis is wrong there. The difference λ (p × r/|r| - e × r) turns the car
from outside. These are its values; :func:`idler_torque` finds them from the track rods' forces.
"""


@dataclass(frozen=True)
class _Idler(BasePart):
    """The torque of :data:`IDLER_TORQUE`, by the share of the step that is done."""

    chassis: str
    share: object

    def loads(self, situation):
        done = self.share(situation.time)
        pairs = zip(*IDLER_TORQUE.values(), strict=True)
        torque = ops.vector(*(a + done * (b - a) for a, b in pairs))
        return Loads(wrenches=(Wrench(self.chassis, ops.vector(0.0, 0.0, 0.0), torque),))


@register("manoeuvre", "chrono_step")
class ChronoStep(RoadManoeuvre):
    """A step of 0.1 s of the steering while a force at the centre of mass holds the speed."""

    rack: float = quantity("m", "Steering coordinate after the step")
    gain: float = quantity("N*s/m", "Force over the error of speed")
    begin: float = quantity("s", "When it begins")
    idler: bool = Field(default=False, description="Whether the idler arm turns the chassis")

    def fit(self, vehicle):
        """Return the vehicle steered and pulled."""

        def share(time):
            return ops.minimum(ops.maximum((time - self.begin) / 0.1, 0.0), 1.0)

        steer = TimeLaw("steer", vehicle.rack, lambda time: self.rack * share(time))
        pull = _Pull("pull", vehicle.chassis, vehicle.speed, self.gain)
        more = (_Idler("idler", vehicle.chassis, share),) if self.idler else ()
        return super().fit(vehicle).with_parts(steer, pull, *more)


def idler_torque(at):
    """Return the torque of :data:`IDLER_TORQUE` by the equilibrium of the steering link [N m].

    ``at`` gives a channel's value. The link turns about its own x axis on the end of the Pitman
    arm; the track rods' forces, weight and the pull of the turn are held by λ at its other end.
    """
    tilt, gear = math.radians(18.5), np.array([1.18898, 0.0, -0.111678])
    steering = _turn(1, tilt)
    arm, swing = at("steering.arm.angle"), at("steering.arm.angle") + at("steering.link.angle")
    link = steering @ _turn(2, swing) @ steering.T
    end = gear + steering @ ([0.0, 0.249, 0.0] + _turn(2, arm) @ [0.129, 0.0, 0.0])
    start = gear + np.array([0.129 * math.cos(tilt), 0.249, -0.129 * math.sin(tilt)])
    pull = at("chassis.yaw_rate") * at("body.forward_speed")
    weight = 3.681 * np.array([0.0, -9.81 * at("chassis.roll") - pull, -9.81])
    moment = np.cross(link @ [0.0, -0.249, 0.0], weight)
    for name, side in (("left", 1.0), ("right", -1.0)):
        place = np.array([1.382965, side * 0.448, -0.159]) - start
        force = np.array([at(f"{name}_rod.force_{axis}") for axis in "xyz"])
        moment += np.cross(link @ place, link @ force)
    along, axis = link @ steering[:, 0], steering[:, 2]
    far, pivot = link @ [0.0, -0.574, 0.0], gear + steering @ [0.0, -0.325, 0.0]
    held = -(moment @ along) / (np.cross(far, axis) @ along)
    reach = end + far - pivot
    return held * (np.cross(pivot, reach / np.linalg.norm(reach)) - np.cross(axis, reach))


def _turn(axis, angle):
    """Return the rotation about an axis that is counted from zero."""
    found = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    found[i, i] = found[j, j] = math.cos(angle)
    found[j, i], found[i, j] = math.sin(angle), -math.sin(angle)
    return found


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
