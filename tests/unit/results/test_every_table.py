"""Every kind of table file is described, drawn, reported, compared and exported."""

import importlib
import pkgutil

import h5py
import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.results import tables
from vehicledyn.results.compare.any_compare import compare_results
from vehicledyn.results.labelled.data import LabelledData
from vehicledyn.results.plots.table_results import TABLES, describe_table, table_figures
from vehicledyn.results.report.table_content import table_content
from vehicledyn.results.tables.cam_table import CamTable, read_cam, write_cam
from vehicledyn.results.tables.columns import Column
from vehicledyn.results.tables.handling_table import (
    HandlingTable,
    KeyFigure,
    read_handling,
    write_handling,
)
from vehicledyn.results.tables.kinds import TABLES as NAMED
from vehicledyn.results.tables.track_table import (
    TrackTable,
    read_track_table,
    write_track,
)
from vehicledyn.results.tables.tyre_table import COLUMNS, TyreTable, read_tyres, write_tyre

FORMATS = {
    module.FORMAT
    for found in pkgutil.iter_modules(tables.__path__)
    if hasattr(module := importlib.import_module(f"{tables.__name__}.{found.name}"), "FORMAT")
}


@pytest.mark.parametrize("known", [TABLES, NAMED], ids=["drawn", "named"])
def test_every_format_is_known(known):
    assert FORMATS
    assert set(known) >= FORMATS


def handling(path):
    speed = Column("m/s^2", "Lateral acceleration", np.linspace(0.5, 4.0, 5))
    angle = Column("rad", "Angle", np.linspace(0.01, 0.1, 5))
    names = (
        "steering_angle", "understeer_angle", "sideslip_angle", "roll_angle", "yaw_rate",
        "smallest_wheel_load", "drive_torque",
    )  # fmt: skip
    sheet = {"lateral_acceleration": speed, **dict.fromkeys(names, angle)}
    figure = KeyFigure("steady", "understeer.gradient", 2e-3, "rad*s^2/m", "Understeer gradient")
    write_handling(path, HandlingTable("T", "car", {"constant_speed": sheet}, [figure], ("n",)))
    table = read_handling(path)
    assert (table.title, table.model, table.notes) == ("T", "car", ("n",))
    assert table.figures == [figure]
    assert table.sheets["constant_speed"]["yaw_rate"].values == pytest.approx(angle.values)


def cam(path):
    angle = np.linspace(0.0, 6.28, 9)
    names = (
        "lift",
        "pitch_x",
        "pitch_y",
        "profile_x",
        "profile_y",
        "pressure_angle",
        "curvature",
        "pitch_radius",
        "profile_radius",
    )
    columns = {name: Column("m", name, 0.01 * np.cos(angle)) for name in names}
    figures = {"largest_pressure_angle": (0.3, "rad", "Largest pressure angle")}
    write_cam(path, CamTable("C", "radial roller", angle, columns, figures))
    table = read_cam(path)
    assert table.figures == figures
    assert set(table.columns) == set(names)
    assert table.columns["lift"].unit == "m"


def tyre(path):
    ones = np.ones(3)
    sweep = {name: np.array([0.1, 0.2, 0.3]) for name in COLUMNS} | {"load": 4e3 * ones}
    sweeps = dict.fromkeys(("longitudinal", "lateral", "cambered", "combined"), sweep)
    write_tyre([TyreTable("A", sweeps), TyreTable("B", sweeps)], path)
    first, second = read_tyres(path)
    assert (first.title, second.title) == ("A", "B")
    assert first.loads == [4e3]


RAILS = tuple(f"{side}_{way}" for side in ("left", "right") for way in ("lateral", "vertical"))


def track(path):
    columns = {
        name: Column("m", name, np.linspace(0.0, 1.0, 4))
        for name in ("s", "x", "y", "z", "heading", "curvature", "cant", "gradient", *RAILS)
    }
    write_track(TrackTable("T", ("a curve",), columns), path)
    table = read_track_table(path)
    assert (table.title, table.facts, list(table.columns)) == ("T", ("a curve",), list(columns))
    assert table["x"] == pytest.approx(columns["x"].values, abs=0.0)


@pytest.mark.parametrize("write", [handling, cam, tyre, track])
def test_a_file_is_understood_by_every_command(tmp_path, write):
    path = tmp_path / "table.h5"
    write(path)
    assert describe_table(path).facts["holds"] in describe_table(path).as_text()
    assert dict(table_figures(path))
    content = table_content(path)
    assert content.title and content.what
    assert LabelledData(path).kind in {kind.name for kind in NAMED.values()}
    assert compare_results(path, path).verdict == "equal"


@pytest.mark.parametrize("sweep", ["longitudinal", "lateral", "cambered", "combined"])
def test_a_tyre_without_one_of_its_sweeps_is_refused(tmp_path, sweep):
    path = tmp_path / "tyre.h5"
    tyre(path)
    with h5py.File(path, "r+") as file:
        del file[f"tyre_1/{sweep}"]
    with pytest.raises(InputError, match=sweep):
        read_tyres(path)


@pytest.mark.parametrize(
    ("write", "place"), [(tyre, "tyre_1/combined/slip_angle"), (tyre, "tyre_1/lateral/load"),
                         (track, "x")]
)  # fmt: skip
def test_numbers_that_figures_are_laid_out_by_are_not_missing(tmp_path, write, place):
    path = tmp_path / "table.h5"
    write(path)
    with h5py.File(path, "r+") as file:
        file[place][...] = np.nan
    with pytest.raises(InputError, match="no finite numbers"):
        dict(table_figures(path))
