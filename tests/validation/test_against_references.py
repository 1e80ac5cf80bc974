"""Every group of comparisons with references lies within its bands."""

import pytest
from reference_cases import histories, positions
from reference_cases.groups import GROUPS, computed
from reference_cases.motions import is_compiled

pytestmark = [pytest.mark.validation, pytest.mark.xdist_group("comparisons")]  # computed once

ROWS = {
    "positions": 12,
    "kinematics": 7,
    "suspensions": 55,
    "histories": 24,
    "convergence": 36,
    "modes": 16,
    "mechanics": 4,
    "slalom": 4,
    "standstill": 2,
    "repeatability": 2,
    "contact_points": 6,
    "tyre_tables": 3,
    "road_vehicles": 24,
    "rail_geometry": 10,
    "rail_contact": 27,
    "rail_wheels": 16,
    "track": 11,
    "rail_assessment": 11,
    "rigid_wheelset": 6,
    "limit_cycles": 9,
    "book": 21,
}
NEEDS_COMPILER = {
    "limit_cycles": "limit cycles with flange contact take minutes interpreted",
    "convergence": "runs with small steps take minutes interpreted",
    "road_vehicles": "runs of a car with a caravan take minutes interpreted",
    "repeatability": "there is nothing to compare the interpreted run with",
}


@pytest.mark.parametrize("name", GROUPS)
def test_group(name):
    if name in NEEDS_COMPILER and not is_compiled():
        pytest.skip(f"no compiler: {NEEDS_COMPILER[name]}")
    group = computed(name)
    assert len(group.rows) == ROWS[name]
    assert not group.failures(), "\n".join(map(str, group.failures()))


def test_a_heavier_chassis_is_noticed():
    """One per mill of mass is enough to leave the bands."""
    failures = positions.compare("chassis.mass=1261.3 kg").failures()
    assert {"chassis sinks, equilibrium", "front wheel load, equilibrium"} <= {
        row.quantity for row in failures
    }


def test_a_shifted_history_is_noticed():
    """A hundredth of a second is far out of the band, so samples and times belong together."""
    reference, computed_columns, _ = histories.both("ramp")
    shifted = abs(computed_columns["y"][1:] - reference["y"][:-1]).max()
    assert shifted > 1000 * histories.STEERING_BANDS["y"]
