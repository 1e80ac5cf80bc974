"""Rigid contact of standard profiles: where it is after jumps, and that it jumps in time."""

from dataclasses import replace

import numpy as np
import pytest
from rigid_examples import LAW, STEEL, STRAIGHT, on_rails, wheelset_body, wheelset_on

from vehicledyn.integrate.methods.rk4 import RungeKutta4
from vehicledyn.integrate.simulate import simulate
from vehicledyn.multibody import derive
from vehicledyn.multibody.loops.partition_monitor import PartitionMonitor, freed
from vehicledyn.multibody.loops.position_level import Positions
from vehicledyn.rail.contact.rigid_contact import RigidRailWheels
from vehicledyn.rail.contact.rigid_profiles import rigid_wheels
from vehicledyn.rail.geometry.contact_geometry import MountedWheel, place_rail
from vehicledyn.rail.geometry.wheelset_geometry import WheelsetOnTrack, find_jumps, stand
from vehicledyn.rail.profiles.named_profiles import named_profile

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def s1002():
    """S1002 on 60E1, 1:40: contact jumps at a quarter of a millimetre and at five."""
    rail = place_rail(named_profile("60E1", "rail"), np.arctan(1 / 40), 1.435, 0.014)
    wheel = MountedWheel(named_profile("S1002", "wheel"), 0.46, 0.75)
    return WheelsetOnTrack(wheel, wheel, rail, rail)


@pytest.fixture(scope="module")
def part(s1002):
    wheel = s1002.left_wheel
    wheels = rigid_wheels(
        wheel,
        s1002.left_rail,
        ("left", "right"),
        radius=wheel.radius,
        half_distance=wheel.half_distance,
    )
    return RigidRailWheels("wheels", "wheelset", wheels, STRAIGHT, LAW, STEEL)


@pytest.mark.parametrize(
    ("lateral", "yaw"),
    [
        *((0.0, 0.0), (0.003, 0.01), (0.00503, 0.0), (-0.0051, 0.0), (-0.0055, 0.0)),
        # The wheel climbs its flange, where it first sinks deeper as it rolls.
        *((0.0065, 0.0), (-0.0066, 0.0), (0.0068, 0.01), (0.0072, 0.0), (0.0075, -0.01)),
    ],
)
def test_contact_starts_where_a_search_finds_it(s1002, part, lateral, yaw):
    standing = stand(s1002, lateral, yaw)
    body = wheelset_body(lateral=lateral, yaw=yaw, height=0.46)
    positions = Positions(wheelset_on(part, body))
    names = [coordinate.name for coordinate in positions.coordinates]
    found = dict(zip(names, positions.start, strict=True))
    assert found["z"] == pytest.approx(standing.height, abs=2e-8)
    assert found["roll"] == pytest.approx(standing.roll, abs=5e-8)
    for side in ("left", "right"):
        place = getattr(standing, side).place[0]
        assert found[f"wheels.{side}.place"] == pytest.approx(place, abs=2e-5)


@pytest.mark.parametrize("lateral", [0.0064, -0.0064])
def test_contact_starts_where_wheel_and_rail_nearly_fit(s1002, part, lateral):
    """Outlines of the same curvature: their errors of 1e-8 m count some ten times in the height."""
    standing = stand(s1002, lateral, 0.0)
    positions = Positions(wheelset_on(part, wheelset_body(lateral=lateral, height=0.46)))
    names = [coordinate.name for coordinate in positions.coordinates]
    found = dict(zip(names, positions.start, strict=True))
    assert found["z"] == pytest.approx(standing.height, abs=5e-7)
    assert found["roll"] == pytest.approx(standing.roll, abs=1e-6)


def test_places_of_contact_stay_dependent(part):
    """On a steep flange the lateral shift determines the place well, but nothing else asks it."""
    free = wheelset_on(part, wheelset_body(lateral=0.0065, height=0.46))
    bodies = [replace(b, joints=tuple(map(_auto, b.joints))) for b in free.bodies]
    system = replace(free, bodies=tuple(bodies))
    positions = Positions(system)
    names = [coordinate.name for coordinate in positions.coordinates]
    values = dict(zip(names, positions.start, strict=True))
    places = {"wheels.left.place", "wheels.right.place"}
    watch = PartitionMonitor.of(system)
    found = watch.compare(0.0, values, ["z", "roll", *sorted(places)])
    assert places < set(found.best)
    equations = derive(freed(system, values, np.zeros(0)))
    assert places < set(equations.structure["dependent"])


def _auto(joint):
    kept = joint.role in ("driven", "dependent")
    return joint if kept else replace(joint, role="auto")


def test_contact_jumps_where_a_second_point_touches(s1002, part):
    """Drawn aside slowly, the left contact leaps to the flange root at 0.2 mm."""
    shifts = np.arange(0.0, 1.1e-3, 2.5e-4)
    jumps = find_jumps(s1002, [stand(s1002, y) for y in shifts])
    assert [jump.side for jump in jumps] == ["left"]
    body = wheelset_body(height=0.46)
    equations, kernel, state, unknowns = on_rails(part, body)
    names = [variable.name for variable in equations.states]
    state[names.index("y_rate")] = 0.05
    happened, rows = [], []
    simulate(
        kernel,
        RungeKutta4(step=5e-4),
        start=0.0,
        stop=0.015,
        state=state,
        unknowns=unknowns,
        interval=5e-4,
        sink=lambda t, x, z, y: rows.extend(y),
        happened=lambda name, time: happened.append((name, time)),
    )
    assert [name for name, _ in happened] == ["wheels.left.jumps"]
    number = {channel.name: k for k, channel in enumerate(equations.channels)}
    lateral = np.array(rows)[:, number["wheels.lateral_shift"]]
    place = np.array(rows)[:, number["wheels.left.place"]]
    leap = int(np.argmax(np.abs(np.diff(place))))
    assert lateral[leap] - 5e-6 < jumps[0].lateral < lateral[leap + 1] + 5e-6
    last = stand(s1002, lateral[-1], rows[-1][number["yaw"]])
    assert place[-1] == pytest.approx(last.left.place[0], abs=2e-5)


@pytest.mark.parametrize("lateral", [0.0, 4.85e-3])
def test_the_wheel_hits_the_rail_where_its_contact_jumps(part, lateral):
    """Impulses along the normals of the new contact and of the other wheel's, and nothing else.

    Momentum across, upwards and about the track is known from two impulses. What contact and
    weight do in 10 µs is taken off by the steps before and after.
    """
    body = wheelset_body(lateral=lateral, height=0.46)
    equations, kernel, state, unknowns = on_rails(part, body)
    state[[variable.name for variable in equations.states].index("y_rate")] = 0.1
    happened, rows, times = [], [], []

    def sink(t, x, z, y):
        times.extend(t)
        rows.extend(y)

    simulate(
        kernel, RungeKutta4(step=1e-5), start=0.0, stop=0.003, state=state, unknowns=unknowns,
        interval=1e-5, sink=sink, happened=lambda name, time: happened.append((name, time)),
    )  # fmt: skip
    ((name, time),) = happened
    assert name == "wheels.left.jumps"
    number = {channel.name: k for k, channel in enumerate(equations.channels)}
    after = int(np.searchsorted(times, time))

    def leap(channel):
        value = np.array([row[number[channel]] for row in rows[after - 2 : after + 2]])
        return value[2] - value[1] - 0.5 * (value[1] - value[0] + value[3] - value[2])

    def at(channel):
        return rows[after][number[channel]]

    momentum = np.array([1500.0 * leap("y_rate"), 1500.0 * leap("z_rate"), 1e3 * leap("roll_rate")])
    across = []
    for side, sign in (("left", 1.0), ("right", -1.0)):
        contact = f"wheels.{side}.contact_1"
        angle = sign * at(f"{contact}.angle")
        y, z = at(f"{contact}.lateral_place") - at("y"), -at(f"{contact}.rolling_radius")
        normal = -np.sin(angle), np.cos(angle)
        across.append([*normal, y * normal[1] - z * normal[0]])
    matrix = np.array(across).T
    impulses = np.linalg.lstsq(matrix, momentum, rcond=None)[0]
    assert impulses[0] > 2.0
    assert matrix @ impulses == pytest.approx(momentum, abs=0.01 * np.abs(momentum).max())
    assert leap("y_rate") < 0.0
    # Carnot: what is lost is the energy of the rates that are lost.
    lost = 0.5 * (momentum[:2] @ momentum[:2] / 1500.0 + momentum[2] ** 2 / 1000.0)
    assert leap("energy.kinetic") == pytest.approx(-lost, rel=0.04)
