"""Measured signals in files."""

import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.studies.identification.measured_data import MeasuredSignal, read_signals

HEIGHT = MeasuredSignal("body.height", "height", "m", None, 1e-3, 0.0)


def test_columns_that_nobody_asks_for_are_passed_over(tmp_path):
    """Whatever their heads, units and cells are."""
    path = tmp_path / "measured.csv"
    path.write_text(
        "time [s], gear, height [mm], Öldruck (bar), load [furlong]\n"
        "0, neutral, 12, x, 1\n0.1, first, , -, nan\n",
        encoding="utf-8",
    )
    ((times, values),) = read_signals(path, "time", [HEIGHT])
    assert list(times) == [0.0, 0.1]
    assert values == pytest.approx([0.012, float("nan")], nan_ok=True)


def test_a_column_that_is_asked_for_must_be_there(tmp_path):
    path = tmp_path / "measured.csv"
    path.write_text("time [s], heigth [mm]\n0, 12\n", encoding="utf-8")
    with pytest.raises(InputError, match="has no column 'height'; did you mean 'heigth'"):
        read_signals(path, "time", [HEIGHT])
