"""Measured data in files of other programs: HDF5, NetCDF, MATLAB's and MDF."""

import struct

import h5py
import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.studies.identification import foreign_reader
from vehicledyn.studies.identification.measured_data import (
    CurveColumns,
    MeasuredSignal,
    read_curve,
    read_signals,
)


@pytest.fixture
def here(monkeypatch):
    """Read all files in this process, which takes no time to start."""
    readers = foreign_reader._READERS
    monkeypatch.setattr(foreign_reader, "read_apart", lambda kind, *given: readers[kind](*given))


TIMES, HEIGHTS = np.array([0.0, 0.1, 0.2]), np.array([12.0, np.nan, 14.0])
TRAVEL, TOE = np.array([-20.0, 0.0, 20.0]), np.array([1.0, 2.0, 4.0])


def signal(column, unit=None):
    return MeasuredSignal("body.height", column, "m", unit, 1e-3, 0.0)


def written(path, content, **units):
    """Write datasets and return the file's path."""
    with h5py.File(path, "w") as file:
        for name, values in content.items():
            file[name] = values
        for name, unit in units.items():
            file[name].attrs["units"] = unit
    return path


def both(path, column, unit=None, time="time"):
    ((times, values),) = read_signals(path, time, [signal(column, unit)])
    assert times == pytest.approx(TIMES)
    assert values == pytest.approx(HEIGHTS * 1e-3, nan_ok=True)


def curve_of(path, *names):
    found = read_curve(path, CurveColumns(*names))
    assert (list(found.places), list(found.values.values), found.gaps) == (
        [-20.0, 20.0], [1.0, 4.0], 1,
    )  # fmt: skip
    return found


def test_plain_datasets_of_hdf5(tmp_path):
    """In groups, in tables with fields and in matrices, with units or without."""
    fields = [("t", float), ("z", float)]
    table = np.array(list(zip(TIMES, HEIGHTS, strict=True)), dtype=fields)
    content = {"time": TIMES, "height": HEIGHTS, "bench/travel": TRAVEL.astype("i2")}
    gap = TOE.copy()
    gap[1] = np.nan
    content |= {"bench/toe": gap, "table": table, "matrix": np.stack([TRAVEL, gap], axis=1)}
    path = written(tmp_path / "a.h5", content, height="[mm]")
    both(path, "height")
    both(path, "table/z", "mm", time="table/t")
    assert curve_of(path, "bench/travel", "bench/toe", "mm", "mrad").over_unit == "mm"
    curve_of(path, "matrix(:,1)", "matrix(:,2)", "mm", "mrad")


def test_packed_numbers_of_netcdf_are_unpacked(tmp_path):
    path = written(tmp_path / "a.nc", {"time": TIMES, "height": np.array([20, -1, 40], "i2")})
    with h5py.File(path, "a") as file:
        facts = {"units": "mm", "scale_factor": 0.1, "add_offset": 10.0}
        file["height"].attrs.update(facts)
        file["height"].attrs["_FillValue"] = np.array([-1], "i2")
    both(path, "height")


@pytest.mark.parametrize(
    ("column", "unit", "words"),
    [
        ("hight", None, "has no column 'hight'; did you mean 'height'"),
        ("height", None, "states no unit of 'height'; give 'unit'"),
        ("height", "kg", "'kg' does not measure a quantity in m"),
        ("marked", "m", "states that 'marked' is in 'mm'; leave 'unit' out"),
        ("strange", None, "'furlong' is not a known unit.*give 'unit'"),
        ("complex", "mm", "holds complex numbers"),
        ("matrix", "mm", r"shape is \(3, 2\); take one column of it, such as 'matrix\(:,1\)'"),
        ("matrix(:,3)", "mm", "has the columns 1 to 2"),
        ("word", "mm", "holds no numbers"),
        ("group", "mm", "has no column 'group'"),
    ],
)
def test_what_is_no_column_of_hdf5_is_refused(tmp_path, column, unit, words):
    content = {"time": TIMES, "height": HEIGHTS, "marked": HEIGHTS, "strange": HEIGHTS}
    content |= {"complex": HEIGHTS + 1j, "matrix": np.zeros((3, 2)), "word": "a", "group/a": 1.0}
    path = written(tmp_path / "a.h5", content, marked="mm", strange="furlong")
    with pytest.raises(InputError, match=words):
        read_signals(path, "time", [signal(column, unit)])


def test_what_is_no_curve_is_refused(tmp_path):
    """By its row; a curve may go up and down again."""
    content = {"over": np.array([1.0, np.nan, 0.5, np.nan]), "value": np.array([1.0, 2, 3, np.nan])}
    path = written(tmp_path / "a.h5", content | {"endless": [np.inf] * 4, "short": [1.0]})
    for names, words in (
        (("over", "value"), "row 2: 'over' has no value"),
        (("value", "endless"), "row 1: 'endless' is not finite"),
        (("over", "short"), "not of the same length"),
    ):
        with pytest.raises(InputError, match=words):
            read_curve(path, CurveColumns(*names, "mm", "mm"))
    with h5py.File(path, "a") as file:
        file["value"][1] = np.nan
    found = read_curve(path, CurveColumns("over", "value", "mm", "mm"))
    assert (list(found.places), found.gaps) == ([1.0, 0.5], 0)


def test_structs_and_columns_of_matlab(tmp_path, here):
    """Columns and rows, fields of structs, and a column of a matrix."""
    from scipy.io import savemat

    path = tmp_path / "a.mat"
    run = {"t": TIMES[:, None], "sensor": {"z": HEIGHTS[None, :]}}
    toe = np.array([1.0, np.nan, 4.0])
    savemat(path, {"run": run, "bench": np.stack([TRAVEL, toe], axis=1), "word": "a"})
    both(path, "run.sensor.z", "mm", time="run.t")
    curve_of(path, "bench(:,1)", "bench(:,2)", "mm", "mrad")
    for column, words in (
        ("run.sensor.x", "did you mean"),
        ("word", "no numbers"),
        ("run", "no c"),
    ):
        with pytest.raises(InputError, match=words):
            read_signals(path, "run.t", [signal(column, "mm")])


@pytest.mark.long
def test_a_damaged_file_ends_no_process_but_that_of_its_reader(tmp_path):
    """SciPy dies of such a byte; the whole file is read by that other process, too."""
    from scipy.io import savemat

    path = tmp_path / "a.mat"
    savemat(path, {"time": TIMES, "z": HEIGHTS})
    both(path, "z", "mm")
    content = bytearray(path.read_bytes())
    content[145] = 255
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.mat: (is damaged|cannot be read)"):
        read_signals(path, "time", [signal("z", "mm")])


def test_matlab_files_that_are_hdf5(tmp_path, here):
    """As version 7.3 writes them: behind a block of its own, with complex numbers as fields."""
    path = tmp_path / "a.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["run/t"], file["run/z"] = TIMES[None, :], HEIGHTS[None, :]
        parts = np.zeros((1, 3), dtype=[("real", float), ("imag", float)])
        parts["imag"] = TOE
        file["response"], file["travel"] = parts, TRAVEL
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file")
    both(path, "run.z", "mm", time="run.t")
    found = read_curve(path, CurveColumns("travel", "response", "mm", "1"))
    assert list(found.values.values) == list(1j * TOE)


def test_channels_of_mdf(tmp_path, here):
    """Each with times of its own, gaps where it is marked as invalid, and by its group."""
    asammdf = pytest.importorskip("asammdf")
    path, late = tmp_path / "a.mf4", TIMES + 0.05
    bits = np.isnan(HEIGHTS)
    with asammdf.MDF(version="4.10") as mdf:
        made = asammdf.Signal
        mdf.append([
            made(np.where(bits, 0.0, HEIGHTS), TIMES, name="z", unit="mm", invalidation_bits=bits),
            made(TRAVEL.astype("i2"), TIMES, name="travel", unit="mm"),
        ])  # fmt: skip
        mdf.append([made(TOE, late, name="z", unit="mm"), made(TOE, late, name="toe", unit="")])
        mdf.append([made(np.array([b"a"] * 3), TIMES, name="word", encoding="utf-8")])
        mdf.save(path)
    both(path, "0/z")
    for columns, words in (
        (("z",), "is there 2 times; name one by its group: '0/z', '1/z'"),
        (("zz",), "has no column 'zz'"),
        (("word", "mm"), "holds no numbers"),
        (("toe",), "states no unit of 'toe'"),
    ):
        with pytest.raises(InputError, match=words):
            read_signals(path, "time", [signal(*columns)])
    with pytest.raises(InputError, match="not sampled at the same times"):
        read_curve(path, CurveColumns("travel", "toe"))
    assert list(read_curve(path, CurveColumns("travel", "0/z")).values.values) == [12.0, 14.0]


@pytest.mark.parametrize("name", ["a.h5", "a.nc", "a.mat", "a.mf4", "a.dat"])
@pytest.mark.parametrize(
    "content",
    [b"", b"hello", b"MDF     4.10    " + b"\1" * 3000, b"\x89HDF\r\n\x1a\n" + b"\2" * 900,
     b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<HH", 0x100, 0x4D49) + b"\7" * 900],
    ids=["empty", "text", "mdf", "hdf5", "mat"],
)  # fmt: skip
def test_what_is_no_such_file_is_refused(tmp_path, here, name, content):
    if b"MDF" in content or name.endswith("mf4"):
        pytest.importorskip("asammdf")
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.\w+: "):
        read_signals(path, "time", [signal("height", "mm")])
