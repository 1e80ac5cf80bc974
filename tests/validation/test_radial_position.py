"""A free wheelset on a curve rolls radially and shifted outwards, as Redtenbacher found."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from outlines import ArcOutline, ConeOutline
from scipy.optimize import brentq

from vehicledyn.analyse.equilibrium import assemble, find_equilibrium
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import (
    GROUND,
    Body,
    ConstantRate,
    Joint,
    ParameterTable,
    System,
    derive,
)
from vehicledyn.rail.contact.rigid_contact import RigidRailWheels, RigidWheel
from vehicledyn.rail.contact.rigid_touch import TouchingWheel
from vehicledyn.rail.contact.rolling_contact import Material
from vehicledyn.rail.creep.johnson_vermeulen import JohnsonVermeulen
from vehicledyn.rail.geometry.contact_geometry import MountedWheel, place_rail
from vehicledyn.rail.geometry.wheelset_geometry import WheelsetOnTrack, stand
from vehicledyn.rail.profiles.named_profiles import named_profile
from vehicledyn.rail.track.track import Track, TrackFrame
from vehicledyn.symbolic import ops, rotations

RADIUS, CONICITY, RAIL_RADIUS, CURVE, SPEED = 0.46, 0.05, 0.08, 1000.0, 3.0


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


def numeric_wheelset():
    rail = place_rail(named_profile(f"arc:{RAIL_RADIUS} m", "rail"), CONICITY, 1.435, 0.001)
    wheel = MountedWheel(named_profile("cone:1/20", "wheel"), RADIUS, rail.origin[0])
    return WheelsetOnTrack(wheel, wheel, rail, rail)


def rigid_part(wheelset, standing):
    rail = wheelset.left_rail
    lean = np.array([math.sin(rail.inclination), -math.cos(rail.inclination)])
    across, up = np.array(rail.origin) + RAIL_RADIUS * lean
    arc, cone = ArcOutline(RAIL_RADIUS, (across, up)), ConeOutline(CONICITY)
    half = wheelset.left_wheel.half_distance
    wheels = tuple(
        RigidWheel(TouchingWheel(side, cone, arc, RADIUS, half), float(touch.place[0]))
        for side, touch in ((1.0, standing.left), (-1.0, standing.right))
    )
    track = Track(1.435, 0.001, CONICITY, "arc", line=Circle(CURVE))
    law = JohnsonVermeulen(friction=0.3)
    return RigidRailWheels("wheels", "wheelset", wheels, track, law, Material(2.1e11, 0.27))


def turning_wheelset(part, height):
    """A wheelset that a frame leads along the curve, free to shift, yaw and spin."""
    frame = Body("frame", GROUND, (0.0, CURVE, 0.0), (Joint("R3", "frame.angle", role="driven"),))
    wheelset = Body(
        "wheelset",
        "frame",
        (0.0, -CURVE, 0.0),
        (
            Joint("T2", "y", role="independent"),
            Joint("T3", "z", height),
            Joint("R3", "yaw", role="independent"),
            Joint("R1", "roll"),
            Joint("R2", "spin", start_rate=SPEED / RADIUS),
        ),
        mass=1500.0,
        inertia=(1000.0, 100.0, 1000.0, 0.0, 0.0, 0.0),
        spins_about=2,
    )
    return System(
        "wheelset",
        ParameterTable(),
        (frame, wheelset),
        parts=(ConstantRate("lead", "frame.angle", SPEED / CURVE), part),
    )


@pytest.mark.validation
def test_free_wheelset_takes_the_radial_position():
    """The rolling line lies where r_outer - r_inner = s r/R; y = r b/(γ R) of a cone."""
    numeric = numeric_wheelset()
    standing = stand(numeric, 0.0)
    equations = derive(turning_wheelset(rigid_part(numeric, standing), standing.height))
    kernel = compile_kernel(equations, backend="interpreted")
    names = [variable.name for variable in equations.states]
    start = np.array([variable.start for variable in equations.states])
    unknowns = assemble(kernel, 0.0, start, [v.start for v in equations.unknowns])
    point = find_equilibrium(
        equations,
        kernel,
        time=0.0,
        state=start,
        unknowns=unknowns,
        free=[names.index(n) for n in ("y", "yaw", "spin_rate")],
        balanced=[names.index(n) for n in ("y_rate", "yaw_rate", "spin_rate")],
        tolerance=1e-9,
    )
    state = dict(zip(names, point.state, strict=True))
    values = kernel.outputs(0.0, point.state, point.unknowns)
    channels = dict(zip([c.name for c in equations.channels], values, strict=True))
    half = numeric.left_wheel.half_distance

    def excess(lateral):
        found = stand(numeric, lateral)
        radii = [RADIUS - CONICITY * float(t.place[0]) for t in (found.left, found.right)]
        width = float(found.left.y[0] + found.right.y[0])
        return radii[1] - radii[0] - width * RADIUS / CURVE

    # The curve bends to the left: the wheelset shifts to the right.
    assert state["y"] == pytest.approx(brentq(excess, -0.012, 0.0), rel=2e-3)
    # The theory knows no roll: its shift is that at the height of the rails.
    at_rails = -(state["y"] + RADIUS * channels["roll"])
    assert at_rails == pytest.approx(RADIUS * half / (CONICITY * CURVE), rel=0.02)
    assert abs(state["yaw"]) < 1e-3 * abs(state["y"]) / half
