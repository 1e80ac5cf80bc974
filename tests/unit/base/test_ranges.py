"""Ranges of values as texts."""

import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.base.ranges import read_range


def test_values():
    assert read_range("-80 mm:80 mm:4").values("m") == pytest.approx(
        [-0.08, -0.04, 0.0, 0.04, 0.08]
    )
    assert read_range("20 mm").values("m") == pytest.approx([0.02])
    assert read_range("1:2:1").values("1") == (1.0, 2.0)


@pytest.mark.parametrize(
    "text", ["", "1:2", "1:2:x", "1:2:0", "1:2:-3", "::", "1:2:3:4", "1:2:1e9"]
)
def test_what_is_no_range(text):
    with pytest.raises(InputError, match=r"write a value or FROM:TO:STEPS|number of steps"):
        read_range(text)


@pytest.mark.parametrize("text", ["1 kg", "1 kg:2 mm:2", "nan", "inf"])
def test_values_that_do_not_fit(text):
    with pytest.raises(InputError):
        read_range(text).values("m")


def test_numbers_of_a_range_need_their_unit():
    assert read_range("0:2 rad:1").values("rad") == (0.0, 2.0)
    assert read_range("3").values("1") == (3.0,)
    with pytest.raises(InputError, match="2 has no unit; write '2 rad' or '2 deg'"):
        read_range("0:2:1").values("rad")
