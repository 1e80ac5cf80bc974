"""Results longer than a portion are compared, described and drawn portion by portion."""

import tracemalloc
from dataclasses import asdict

import numpy as np
import pytest
from scipy.io import loadmat

from vehicledyn.base.errors import InputError
from vehicledyn.results.compare import run_compare, sampling_grids
from vehicledyn.results.compare.run_compare import compare_files
from vehicledyn.results.info import describe_result
from vehicledyn.results.labelled import export
from vehicledyn.results.labelled.data import open_result as open_labelled
from vehicledyn.results.plots import figures
from vehicledyn.results.plots.standard import figure_sets
from vehicledyn.results.store import decimation
from vehicledyn.results.store.layout import SampleAxis
from vehicledyn.results.store.reader import open_result

TIME = np.linspace(0.0, 5.0, 101)


@pytest.fixture
def small_portions(monkeypatch):
    for module in (run_compare, sampling_grids, decimation):
        monkeypatch.setattr(module, "PORTION", 7)


def a(**changes):
    """Return two channels over 5 s, some samples of them changed."""
    values = {"x": ("m", np.sin(TIME)), "v": ("m/s", np.cos(TIME))}
    for name, (row, value) in changes.items():
        values[name][1][row] = value
    return values


CHANGES = [{}, {"x": (50, 7.0)}, {"v": (93, np.nan)}, {"x": (8, np.inf), "v": (20, -3.0)}]


@pytest.mark.parametrize("axis", [None, SampleAxis("1", "Sample")], ids=["time", "samples"])
def test_portions_are_compared_as_the_whole(make_result, request, axis):
    more = {} if axis is None else {"axis": axis}
    paths = [
        make_result(f"{number}.h5", time=TIME, values=a(**changes), **more)
        for number, changes in enumerate(CHANGES)
    ]
    pairs = [(paths[0], path) for path in paths] + [(path, paths[0]) for path in paths]
    pairs.append((paths[2], paths[2]))
    whole = [asdict(compare_files(*pair)) for pair in pairs]
    assert [sum(c["passed"] for c in one["channels"]) for one in whole[:4]] == [2, 1, 1, 0]
    request.getfixturevalue("small_portions")
    assert [asdict(compare_files(*pair)) for pair in pairs] == whole


def test_portions_are_interpolated_and_their_grids_compared(make_result, request):
    finer = np.sort(np.append(np.linspace(0.0, 5.0, 200), 2.5))
    values = {"x": ("m", np.sin(finer)), "v": ("m/s", np.cos(finer))}
    other = make_result("finer.h5", time=finer, values=values)
    late = make_result("late.h5", time=TIME + 1e-3 * (TIME[61] == TIME), values=a())
    base = make_result("base.h5", time=TIME, values=a())
    pairs = [(other, base, True), (base, other, True), (late, base, False), (other, base, False)]
    whole = [asdict(compare_files(p, q, interpolate=between)) for p, q, between in pairs]
    assert whole[0]["channels"][0]["difference"] < 1e-3 and "sample 61" in str(whole[2])
    request.getfixturevalue("small_portions")
    found = [asdict(compare_files(p, q, interpolate=between)) for p, q, between in pairs]
    assert found == whole


@pytest.mark.usefixtures("small_portions")
def test_times_that_fall_are_found_at_every_place(make_result):
    import h5py

    for row in (6, 7, 8, 100):
        path = make_result(f"{row}.h5", time=TIME, values=a())
        with h5py.File(path, "r+") as file:
            file["time"][row] = -1.0
        with pytest.raises(InputError, match="damaged"):
            describe_result(path)


@pytest.mark.usefixtures("small_portions")
def test_few_samples_are_in_memory(make_result):
    path = make_result(time=TIME, values=a())
    with open_result(path, 2) as result:
        assert result.block <= 7
        assert result.samples == 101
        places = result.column("time").first_from(np.array([-1.0, 0.0, 0.01, 2.5, 5.0, 9.0]))
        assert places.tolist() == [0, 0, 1, 50, 100, 101]
        assert np.array_equal(result.column("x")[3:40], np.sin(TIME)[3:40])
    found = describe_result(path)
    assert (found.start, found.end, found.samples) == (0.0, 5.0, 101)


def test_long_runs_are_drawn_by_their_envelope(make_result, monkeypatch):
    drawn = []
    monkeypatch.setattr(
        figures, "draw_figure", lambda r, _, **__: drawn.append(r.channel("x").values)
    )
    path = make_result(time=TIME, values=a(x=(77, 9.0)), plots=[])
    list(figure_sets({"": path}, most=20))
    assert drawn and all(len(values) <= 22 and values.max() == 9.0 for values in drawn)


@pytest.mark.parametrize("suffix", [".csv", ".mat"])
def test_tables_of_long_runs_are_written_in_portions(make_result, tmp_path, monkeypatch, suffix):
    """40 columns of 64 kB each: CSV keeps few rows of all, MATLAB's files one column.

    They take 0.5 MB, and what other tests of the process left may add as much.
    """
    time = np.linspace(0.0, 1.0, 8_001)
    values = {f"c{k}": ("m", time + k) for k in range(40)}
    data = open_labelled(make_result(time=time, values=values))
    monkeypatch.setattr(export, "_ROWS", 100)
    monkeypatch.setattr(export, "_VALUES", 4_000)
    data.export(tmp_path / f"first{suffix}")  # loads what is loaded once
    tracemalloc.start()
    path = data.export(tmp_path / f"long{suffix}")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1e6 < 0.5 * 41 * time.nbytes
    if suffix == ".csv":
        found = np.loadtxt(path, delimiter=",", skiprows=2)
        columns = list(found.T)
    else:
        found = loadmat(path)
        columns = [found["time"][:, 0], *(found[name][:, 0] for name in values)]
        assert found["columns"].shape == (41, 4)
    assert np.array_equal(columns, [time, *(time + k for k in range(40))])
