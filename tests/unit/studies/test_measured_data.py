"""Measured signals in files."""

from types import SimpleNamespace

import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.studies.identification.experiments import (
    Experiment,
    MeasuredChannel,
    check_measured,
)
from vehicledyn.studies.identification.measured_data import MeasuredSignal, read_signals
from vehicledyn.studies.identification.measured_figures import at_place
from vehicledyn.studies.mistakes import Mistakes

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


def test_times_without_a_unit_are_seconds(tmp_path):
    """Values are not: what they measure says no unit that everybody writes."""
    path = tmp_path / "measured.csv"
    path.write_text("time, height [mm]\n0, 12\n0.1, 16\n", encoding="utf-8")
    assert list(read_signals(path, "time", [HEIGHT])[0][0]) == [0.0, 0.1]
    assert list(read_signals(path, "time", [HEIGHT], "ms")[0][0]) == [0.0, 1e-4]
    path.write_text("time, height\n0, 12\n", encoding="utf-8")
    with pytest.raises(InputError, match="states no unit of 'height'; give 'unit'"):
        read_signals(path, "time", [HEIGHT])


@pytest.mark.parametrize(("last", "is_asked"), [(1.2, False), (1000.0, True)])
def test_times_far_beyond_the_run_may_be_in_another_unit(last, is_asked):
    signal = MeasuredChannel("height", np.array([0.0, last]), np.zeros(2), 1e-3)
    loaded = SimpleNamespace(scenario=SimpleNamespace(duration=1.0))
    mistakes = Mistakes()
    check_measured(mistakes, Experiment("shaker", loaded, (signal,)))
    (problem,) = mistakes.problems
    assert "lie outside the run" in problem.message
    assert ("'time_unit'" in problem.message) is is_asked


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("foo(body.height)", "is an unknown figure.* Curves over places are gain, phase"),
        ("gane(body.height, road.height)", "is an unknown figure; did you mean 'gain'"),
        ("gain(body.height)", "names too little"),
        ("rms(body.height)", "has no places; leave 'over' out"),
        ("crash_time", "has no places; leave 'over' out"),
    ],
)
def test_what_is_over_no_places_is_told_why(name, words):
    with pytest.raises(InputError, match=words):
        at_place(name, "1 Hz")
