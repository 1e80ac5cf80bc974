"""Wheelsets in rigid contact for tests: outlines of profiles, and a wheelset on its track."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from outlines import ArcOutline

from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, derive
from vehicledyn.rail.contact.rigid_contact import RigidRailWheels, RigidWheel
from vehicledyn.rail.contact.rigid_touch import TouchingWheel
from vehicledyn.rail.contact.rolling_contact import Material
from vehicledyn.rail.creep.tanh import Tanh
from vehicledyn.rail.track.track import Track, TrackFrame
from vehicledyn.symbolic import ops, rotations

STEEL = Material(2.1e11, 0.28)
LAW = Tanh(friction=0.3, c11=4.0, c22=3.6, c23=1.5)
STRAIGHT = Track(1.435, 0.014, 0.025, "arc:300 mm")


@dataclass(frozen=True)
class Circle:
    """A level centre line that is a circle to the left, without cant."""

    radius: float
    is_straight: bool = False
    tightest: float = 0.0

    def frame(self, s):
        angle = s / self.radius
        place = ops.vector(self.radius * ops.sin(angle), self.radius * (1.0 - ops.cos(angle)), 0.0)
        turning = ops.vector(0.0, 0.0, 1.0 / self.radius)
        return TrackFrame(place, rotations.turn(3, angle), 1.0, turning)

    def curvature(self, s):
        return 1.0 / self.radius


def round_rail(rail):
    """Return the outline of a numeric rail whose profile is one arc."""
    radius = rail.profile.pieces[0].radius
    lean = np.array([np.sin(rail.inclination), -np.cos(rail.inclination)])
    across, up = np.array(rail.origin) + radius * lean
    return ArcOutline(radius, (across, up))


def rigid_wheels(wheelset, outline, starts, *, name="wheels", track=STRAIGHT):
    """Return the part of a numeric wheelset with round rails; ``outline`` is its wheels'."""
    wheel, rail = wheelset.left_wheel, round_rail(wheelset.left_rail)
    pair = [
        RigidWheel(TouchingWheel(side, outline, rail, wheel.radius, wheel.half_distance), start)
        for side, start in zip((1.0, -1.0), starts, strict=True)
    ]
    return RigidRailWheels(name, "wheelset", tuple(pair), track, LAW, STEEL)


def wheelset_body(*, lateral=0.0, yaw=0.0, height=0.0, speed=0.0, radius=0.46, ahead=0.0):
    """Return a free wheelset; shift and yaw keep their starts."""
    joints = (
        Joint("T1", "x", ahead, "independent", start_rate=speed),
        Joint("T2", "y", lateral, "independent"),
        Joint("T3", "z", height),
        Joint("R3", "yaw", yaw, "independent"),
        Joint("R1", "roll"),
        Joint("R2", "spin", start_rate=speed / radius),
    )
    inertia = (1000.0, 100.0, 1000.0, 0.0, 0.0, 0.0)
    return Body("wheelset", GROUND, joints=joints, mass=1500.0, inertia=inertia, spins_about=2)


def wheelset_on(part, body, *parts):
    """Return the system of a body on rails."""
    return System(
        "wheelset",
        ParameterTable(),
        (body,),
        parts=(part, *parts),
    )


def on_rails(part, body, *parts):
    """Return equations, kernel, states and unknowns of a wheelset that stands on its rails."""
    equations = derive(wheelset_on(part, body, *parts))
    kernel = compile_kernel(equations, backend="interpreted")
    state = np.array([variable.start for variable in equations.states])
    unknowns = assemble(kernel, 0.0, state, [variable.start for variable in equations.unknowns])
    return equations, kernel, state, unknowns


def channels(equations, kernel, state, unknowns, time=0.0):
    """Return all channels by name."""
    values = kernel.outputs(time, state, unknowns)
    return dict(zip([channel.name for channel in equations.channels], values, strict=True))
