"""Every command and listing of the page on tracks works."""

import csv
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from programs import run

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.parameters import read_part
from vehicledyn.base.registry import kinds
from vehicledyn.results.store.reader import open_result

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "track.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
LISTINGS = {body.split()[1]: body for kind, body in BLOCK.findall(PAGE) if kind in ("yaml", "csv")}
COMMANDS = [
    line for kind, body in BLOCK.findall(PAGE) if kind == "sh" for line in body.splitlines()
]
RAILS = {"gauge": 1.435, "inclination": "1/40", "rail": "60E1"}


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """The folder in which all commands have run, and what each printed."""
    place = tmp_path_factory.mktemp("page")
    for name, text in LISTINGS.items():
        (place / name).write_text(text, encoding="utf-8")
    printed = {}
    for line in COMMANDS:
        printed[line] = run(line, place)
    return place, printed


def test_track_is_shown_as_table_csv_and_pictures(told):
    folder, printed = told
    first = printed[COMMANDS[0]]
    assert "layout, gauge 1435 mm, rails 60E1 inclined 1/40, cant over 1500 mm" in first
    assert "570 m long" in first
    lines = (folder / "branch_line.csv").read_text().splitlines()
    rows = list(csv.reader(line for line in lines if not line.startswith("#")))
    columns = dict(zip(rows[0], np.array(rows[1:], dtype=float).T, strict=True))
    at = int(np.flatnonzero(columns["s [m]"] == 190.0)[0])
    assert columns["cant [mm]"][at] == pytest.approx(100.0)
    assert columns["curvature [1/km]"][at] == pytest.approx(1.0 / 0.3, rel=1e-6)
    assert columns["gradient [permil]"][at] == pytest.approx(12.0, abs=1e-4)
    lacking = 1500.0 * 25.0**2 / (300.0 * 9.81) - 100.0
    assert columns["cant_deficiency [mm]"][at] == pytest.approx(lacking, rel=1e-5)
    pictures = {path.name for path in (folder / "branch_line").iterdir()}
    assert pictures == {f"{n}.{k}" for n in ("plan", "design", "rails") for k in ("png", "svg")}


def test_ride_starts_in_the_curve_where_it_is_told(told):
    folder, printed = told
    with open_result(folder / "ride.h5") as result:
        start = result.as_frame().reset_index().iloc[0]
    assert start["front.track_frame.position"] == pytest.approx(154.0)
    assert start["rear.track_frame.position"] == pytest.approx(146.0)
    assert start["load.track_frame.curvature"] == pytest.approx(1 / 300.0, rel=1e-9)
    shown = json.loads(next(text for line, text in printed.items() if "--json" in line))
    assert shown["columns"]["s"]["values"][-1] == 570.0


@pytest.mark.parametrize("name", ["yard.csv", "surveyed.csv"])
def test_tables_of_the_page_are_tracks(name, tmp_path):
    (tmp_path / name).write_text(LISTINGS[name])
    kind = "layout_table" if name == "yard.csv" else "measured"
    track = read_part("track", {"kind": kind, **RAILS, "file": name}).track(tmp_path)
    assert track.line.error <= 1e-8
    assert track.ends == (0.0, 81.4 if kind == "layout_table" else 50.0)


def test_record_of_the_page_is_one(tmp_path):
    (tmp_path / "rough.csv").write_text(LISTINGS["rough.csv"])
    given = {"kind": "record", "file": "rough.csv", "fade": 0}
    assert read_part("irregularity", given).shift(tmp_path).ends == (0.0, 12.0)


def test_page_names_every_kind():
    told = set(re.findall(r"`(\w+)`", PAGE))
    for family in ("track", "segment", "irregularity"):
        assert set(kinds(family)) <= told


def test_a_file_without_a_track_is_refused(told, tmp_path):
    (tmp_path / "none.yaml").write_text("title: t\nbodies: {b: {joints: [T1 x], mass: 1 kg}}\n")
    done = subprocess.run(
        [Path(sys.executable).parent / "vehicledyn", "track", "none.yaml"],
        cwd=tmp_path, check=False, capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert done.returncode == 2
    assert "none.yaml:1:1: track: there is no track in this file" in done.stderr
