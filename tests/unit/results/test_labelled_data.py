"""Every kind of result file opens as labelled data: in xarray, here, and as tables elsewhere."""

import csv
import shutil
import warnings

import h5py
import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import MissingPartError
from vehicledyn.results.store import reader
from vehicledyn.results.store.animation_section import Span
from vehicledyn.results.store.reader import open_result

xarray = pytest.importorskip("xarray")
QUICK = {"backend": "interpreted"}


@pytest.fixture(scope="module")
def results():
    """One small result of each kind, by kind."""
    short = vd.load("quarter_car").changed(duration="0.2 s")
    return {
        "run": vd.simulate(short, **QUICK),
        "study": vd.sweep(
            short, vary={"parameters.body.mass": ["200 kg", "300 kg"]}, workers=1, **QUICK
        ),
        "modes": vd.modes("quarter_car", **QUICK),
        "response": vd.response("quarter_car", "road.height", "body.height", points=4),
        "contacts": vd.contact_geometry("S1002", "60E1", shifts=[0.0, 1e-3], amplitudes=[1e-3]),
        "equilibrium": vd.equilibrium("quarter_car", **QUICK),
    }


KINDS = ("run", "study", "modes", "response", "contacts", "equilibrium")


@pytest.mark.parametrize("kind", KINDS)
def test_xarray_opens_it_with_all_dimensions_named(results, kind):
    data = results[kind]
    assert data.kind == kind
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with xarray.open_dataset(data.path) as flat, xarray.open_datatree(data.path) as tree:
            sizes = {name for node in tree.subtree for name in node.sizes}
            assert flat.sizes
            assert not [name for name in sizes if name.startswith("phony")]


def test_the_channels_of_a_run_are_in_the_root_and_in_their_groups(results):
    with xarray.open_dataset(results["run"].path) as flat:
        height = flat["body.height"]
        assert height.attrs["units"] == "m"
        assert height.dims == ("time",)
        assert flat["time"].attrs["units"] in ("s", "") or flat["time"].dtype.kind in "mf"
        assert set(results["run"]) - {"time"} <= set(flat.variables)
    with xarray.open_datatree(results["run"].path) as tree:
        assert tree["body/height"].values.tolist() == height.values.tolist()
        assert tree["animation"].sizes["picture_time"] > 1


def test_the_samples_of_a_study_have_cases_times_and_channels(results):
    with xarray.open_datatree(results["study"].path) as tree:
        assert tree["samples"].dims == ("case", "time", "channel")
        assert tree["cases/values"].dims == ("case", "axis")
        assert tree["figures/value"].dims == ("case", "figure")


def test_older_files_still_open(results, tmp_path):
    """Times of pictures had the name of those of the samples, and channels were in groups only."""
    old = tmp_path / "old.h5"
    shutil.copyfile(results["run"].path, old)
    with h5py.File(old, "r+") as file:
        file.move("animation/picture_time", "animation/time")
        for name in [name for name in file if "." in name]:
            del file[name]
    assert vd.compare(vd.open_result(old), results["run"]).is_equal
    with open_result(old) as result:
        assert result.pictures > 1
        assert len(result.animation(Span(10_000)).pictures.time) == result.pictures


@pytest.mark.parametrize("kind", KINDS)
def test_tables_and_arrays(results, kind):
    data = results[kind]
    assert len(data.to_dataframe()) > 0
    whole = data.to_xarray()
    assert set(data) <= set(whole.variables)
    for name in data:
        assert data[name].values.shape == whole[name].shape, name
    assert data._repr_html_().count("<tr>") >= len(data)


@pytest.mark.parametrize("rows", [7, 10_000])
def test_csv_has_names_and_units(results, tmp_path, monkeypatch, rows):
    """However many rows are made at once."""
    monkeypatch.setattr("vehicledyn.results.labelled.export._ROWS", rows)
    path = results["run"].export(tmp_path / "a.csv", "body.*")
    with path.open(newline="") as file:
        names, units, *rows = csv.reader(file)
    assert names == ["time", "body.height", "body.height_rate"]
    assert units == ["s", "m", "m/s"]
    numbers = np.array(rows, dtype=float)
    assert numbers[:, 1].tolist() == results["run"]["body.height"].values.tolist()
    with pytest.raises(vd.InputError, match=r"a\.csv: exists"):
        results["run"].export(path)
    with pytest.raises(vd.InputError, match=r"ends in \.csv, \.mat, \.parquet"):
        results["run"].export(tmp_path / "a.xlsx")


def test_complex_values_become_two_columns(results, tmp_path):
    path = results["modes"].export(tmp_path / "a.csv")
    names = path.read_text(encoding="utf-8").splitlines()[0].split(",")
    assert {"case", "mode", "eigenvalue.real", "eigenvalue.imag", "frequency"} <= set(names)


def test_a_matlab_file_has_values_and_facts(results, tmp_path):
    from scipy.io import loadmat

    path = results["run"].export(tmp_path / "a.mat", "body.*")
    found = loadmat(path, simplify_cells=True)
    assert found["body_height"].tolist() == results["run"]["body.height"].values.tolist()
    assert found["columns"][1][:3].tolist() == ["body_height", "body.height", "m"]
    assert found["about"]["title"] == results["run"].title


def test_parquet_needs_its_package(results, tmp_path):
    try:
        from pyarrow import parquet
    except ImportError:
        with pytest.raises(MissingPartError, match=r"pip install 'vehicledyn\[parquet\]'"):
            results["run"].export(tmp_path / "a.parquet")
        assert list(tmp_path.iterdir()) == []
    else:
        path = results["run"].export(tmp_path / "a.parquet", "body.*")
        table = parquet.read_table(path)
        assert table.schema.field("body.height").metadata[b"units"] == b"m"


def test_a_table_of_unlike_arrays_is_refused(results):
    with pytest.raises(vd.InputError, match="arrays over the same dimensions"):
        results["study"].to_dataframe("case.end_time", "body.height")


def test_times_are_not_read_before_they_are_asked_for(results, monkeypatch):
    """Those of a long run took 8 B a sample after its end, whatever was asked for."""
    asked = []

    def noted(path, most=None):
        asked.append(most)
        return open_result(path, most)

    monkeypatch.setattr(reader, "open_result", noted)
    data = vd.open_result(results["run"].path)
    assert len(data.summary) > 3 and data.events == () and data.notes == results["run"].notes
    assert asked and set(asked) == {reader.ENDS}
    assert len(data.time) > reader.ENDS
    assert asked[-1] is None


def test_a_table_opens_the_file_once(results, monkeypatch):
    data = vd.open_result(results["run"].path)
    opened = []
    monkeypatch.setattr(
        reader, "open_result", lambda path: opened.append(path) or open_result(path)
    )
    table = data.to_dataframe()
    assert len(opened) == 1 and table.shape[1] > 3
    assert [array.name for array in data.arrays("body.*")] == data.names("body.*")
    assert table["body.height"].to_numpy() == pytest.approx(data["body.height"].values, abs=0.0)
