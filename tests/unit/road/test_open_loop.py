"""Open-loop tables: values between their times, lists that do not fit together."""

import pytest
from pydantic import ValidationError

from vehicledyn.road.manoeuvres.kinds.recorded.open_loop import OpenLoop


def test_values_lie_on_straight_lines():
    test = OpenLoop(times=["1 s", "3 s"], angles=["0 deg", "90 deg"], brake_torques=[100, 500])
    assert test.brake_torque().at(2.0) == pytest.approx(300.0)
    assert test.steering().knots.at(2.5) == pytest.approx(0.75 * 1.5707963267948966)
    assert test.drive_torque().at(2.0) == 0.0
    assert test.brake_torque().at(9.0) == 500.0


@pytest.mark.parametrize(
    ("lists", "words"),
    [
        ({"times": [0, 1], "angles": [0.1]}, "angles: 1 values and 2 times"),
        ({"times": [1, 1]}, "times: must grow"),
        ({"times": []}, "times: takes 1 to 8"),
        ({"times": list(range(9))}, "times: takes 1 to 8"),
    ],
)
def test_lists_that_do_not_fit_together(lists, words):
    with pytest.raises(ValidationError, match=words):
        OpenLoop(**lists)
