"""Rigid contact of standard profiles: where it is after jumps, and that it jumps in time."""

import numpy as np
import pytest
from rigid_examples import LAW, STEEL, STRAIGHT, on_rails, wheelset_body, wheelset_on

from vehicledyn.multibody.positions import Positions
from vehicledyn.rail.contact_geometry import Wheel, place_rail
from vehicledyn.rail.contact_geometry_wheelset import WheelsetOnTrack, find_jumps, stand
from vehicledyn.rail.named_profiles import named_profile
from vehicledyn.rail.rigid_contact import RigidRailWheels
from vehicledyn.rail.rigid_profiles import rigid_wheels
from vehicledyn.solve.methods.rk4 import RungeKutta4
from vehicledyn.solve.simulate import simulate


@pytest.fixture(scope="module")
def s1002():
    """S1002 on 60E1, 1:40: contact jumps at a quarter of a millimetre and at five."""
    rail = place_rail(named_profile("60E1", "rail"), np.arctan(1 / 40), 1.435, 0.014)
    wheel = Wheel(named_profile("S1002", "wheel"), 0.46, 0.75)
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
    ("lateral", "yaw"), [(0.0, 0.0), (0.003, 0.01), (-0.0055, 0.0), (0.0075, -0.01)]
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
