"""Measured signals in files."""

import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.studies.identification.experiments import MeasuredChannel
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


def test_cells_of_signals_that_are_empty_or_nan_are_gaps(tmp_path):
    """As measuring programs write them; a time must be there, and a word is no number."""
    path = tmp_path / "measured.csv"
    rows = ["0, 12", "0.1, nan", "0.2,", "0.3, NaN", "0.4, 16"]
    path.write_text("\n".join(["time [s], height [mm]", *rows]), encoding="utf-8")
    ((times, values),) = read_signals(path, "time", [HEIGHT])
    kept, lost = MeasuredChannel("body.height", times, values, 1e-3).without_gaps()
    assert lost == 3
    assert list(kept.times) == [0.0, 0.4]
    assert kept.values == pytest.approx([0.012, 0.016])
    for wrong in ("0.5, none", "nan, 12"):
        path.write_text(f"time [s], height [mm]\n0, 12\n{wrong}\n", encoding="utf-8")
        with pytest.raises(InputError, match="is no number"):
            read_signals(path, "time", [HEIGHT])
