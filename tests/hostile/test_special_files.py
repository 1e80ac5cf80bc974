"""Devices, FIFOs, sockets, folders and giants are refused by name, wherever a file is read."""

import io
import os
import socket
from pathlib import Path

import pytest
from harness import Case, run
from mechanism_cases import MEASURED, OUTLINE, STUDIES

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.limits import (
    UnreadableFileError,
    check_regular,
    open_regular,
    read_regular,
)
from vehicledyn.results.hdf5 import opening
from vehicledyn.results.hdf5.output import check_output

pytestmark = pytest.mark.xdist_group("hostile")  # warmed up once

ROOT = Path(__file__).parents[2]
RAMP = (ROOT / "scenarios" / "iltis_ramp_steer.yaml").read_bytes()
ROAD = RAMP.replace(b"kind: flat", b"kind: profile\n  file: bad.csv")
PENDULUM = (ROOT / "systems" / "double_pendulum.yaml").read_bytes()
SWING = (
    (ROOT / "scenarios" / "systems" / "double_pendulum.yaml")
    .read_bytes()
    .replace(b"../../systems/double_pendulum.yaml", b"system.yaml")
)
SYSTEM = {"system.yaml": PENDULUM, "a.yaml": SWING}
WHEELSET = (ROOT / "systems" / "rail_wheelset.yaml").read_bytes()
STUDY = b"""\
title: A study
scenario: bad.yaml
cases: {kind: list, file: cases.csv}
output: {channels: []}
"""
TABLE = STUDY.replace(b"bad.yaml", b"ramp.yaml").replace(b"cases.csv", b"bad.csv")
RAIL = b"kind: straight\nrail: bad.csv\ngauge: 1435 mm\ninclination: 1/40\n"
LAYOUT = b"kind: layout_table\nfile: bad.csv\nrail: 60E1\ngauge: 1435 mm\ninclination: 1/40\n"
RECORD = RAIL.replace(b"bad.csv", b"60E1") + (
    b"irregularities: {kind: record, file: bad.csv, fade: 1 m}\n"
)
OPTIMISE = STUDIES["optimise"].replace("scenarios/systems/double_pendulum", "bad")
IDENTIFY = STUDIES["identify"].replace("scenarios/systems/double_pendulum.yaml", "a.yaml")
PLACES = {
    "scenario": ({}, ["run", "bad.yaml"], "bad.yaml"),
    "validated": ({}, ["validate", "bad.yaml"], "bad.yaml"),
    "system": ({}, ["eig", "bad.yaml"], "bad.yaml"),
    "model of a scenario": (
        {"a.yaml": RAMP.replace(b"model: iltis", b"model: bad.yaml")},
        ["run", "a.yaml"],
        "bad.yaml",
    ),
    "study": ({}, ["sweep", "bad.yaml"], "bad.yaml"),
    "scenario of a study": ({"s.yaml": STUDY}, ["sweep", "s.yaml"], "bad.yaml"),
    "table of a study": (
        {"s.yaml": TABLE, "ramp.yaml": RAMP},
        ["sweep", "s.yaml"],
        "bad.csv",
    ),
    "road": ({"a.yaml": ROAD}, ["run", "a.yaml"], "bad.csv"),
    "track": ({}, ["track", "bad.yaml"], "bad.yaml"),
    "rail of a track": (
        {"a.yaml": WHEELSET.replace(b'"60E1"', b"bad.csv")},
        ["eig", "a.yaml"],
        "bad.csv",
    ),
    "profile of a wheel": (
        {"a.yaml": WHEELSET.replace(b"S1002", b"bad.csv")},
        ["eig", "a.yaml"],
        "bad.csv",
    ),
    "table of a track": ({"t.yaml": LAYOUT}, ["track", "t.yaml"], "bad.csv"),
    "irregularities": ({"t.yaml": RECORD}, ["track", "t.yaml"], "bad.csv"),
    "motion as table": (SYSTEM, ["inverse", "a.yaml", "--motion", "bad.csv"], "bad.csv"),
    "motion as result": (SYSTEM, ["inverse", "a.yaml", "--motion", "bad.h5"], "bad.h5"),
    "output": ({"a.yaml": RAMP}, ["run", "a.yaml", "-o", "bad.h5"], "bad.h5"),
    "output that goes on": (
        {
            "s.yaml": STUDY.replace(b"bad.yaml", b"ramp.yaml"),
            "ramp.yaml": RAMP,
            "cases.csv": b"speed [m/s]\n10\n",
        },
        ["sweep", "s.yaml", "-o", "bad.h5", "--resume", "--workers", "1"],
        "bad.h5",
    ),
    "profile": ({}, ["profiles", "s1002", "bad.csv"], "bad.csv"),
    "info": ({}, ["info", "bad.h5"], "bad.h5"),
    "plot": ({}, ["plot", "bad.h5"], "bad.h5"),
    "report": ({}, ["report", "bad.h5"], "bad.h5"),
    "animate": ({}, ["animate", "bad.h5"], "bad.h5"),
    "assess": ({}, ["assess", "bad.h5"], "bad.h5"),
    "compare": ({}, ["compare", "bad.h5", "bad.h5"], "bad.h5"),
}

FURTHER = {
    "OpenCRG road": (
        {"a.yaml": RAMP.replace(b"kind: flat", b"kind: opencrg\n  file: bad.crg")},
        ["run", "a.yaml"],
        "bad.crg",
    ),
    "grid of heights": (
        {"a.yaml": RAMP.replace(b"kind: flat", b"kind: heightfield\n  file: bad.asc")},
        ["run", "a.yaml"],
        "bad.asc",
    ),
    "mesh": (
        {"a.yaml": RAMP.replace(b"kind: flat", b"kind: mesh\n  file: bad.obj\n  cell: 1 m")},
        ["run", "a.yaml"],
        "bad.obj",
    ),
    "tyre": ({}, ["tyre", "bad.tir"], "bad.tir"),
    "plugin": ({"a.yaml": RAMP}, ["--plugin", "bad.py", "run", "a.yaml"], "bad.py"),
    "cam": ({}, ["cam", "bad.yaml"], "bad.yaml"),
    "outline of a cam": (
        {"c.yaml": OUTLINE.replace("measured", "bad").encode()},
        ["cam", "c.yaml"],
        "bad.csv",
    ),
    "optimisation": ({}, ["optimise", "bad.yaml"], "bad.yaml"),
    "uncertainty": ({}, ["uncertainty", "bad.yaml"], "bad.yaml"),
    "measured data": (
        SYSTEM | {"s.yaml": IDENTIFY.replace("measured", "bad").encode()},
        ["identify", "s.yaml"],
        "bad.csv",
    ),
    "runs to go on with": (
        SYSTEM | {"s.yaml": IDENTIFY.encode(), "measured.csv": MEASURED.encode()},
        ["identify", "s.yaml", "-o", "out.h5", "--resume"],
        "out.h5.checkpoint",
    ),
    "scenario of an optimisation": (
        {
            "s.yaml": STUDIES["optimise"]
            .replace("scenarios/systems/double_pendulum", "bad")
            .encode()
        },
        ["optimise", "s.yaml"],
        "bad.yaml",
    ),
    "runs to keep": (
        SYSTEM | {"s.yaml": IDENTIFY.encode(), "measured.csv": MEASURED.encode()},
        ["identify", "s.yaml", "-o", "out.h5"],
        "out.h5.checkpoint",
    ),
    "restart": (SYSTEM, ["run", "a.yaml", "--restart", "bad.h5"], "bad.h5"),
    "second car": ({}, ["steady", "small_car", "--against", "bad.yaml"], "bad.yaml"),
    "assembly": (
        {"a.yaml": b"title: Two\nbodies: {}\nassemblies: {front: {file: bad.yaml}}\n"},
        ["eig", "a.yaml"],
        "bad.yaml",
    ),
}
"""Places that are tried with a FIFO and one other kind in turn."""


def a_fifo(path):
    os.mkfifo(path)


def a_link_to_a_device(path):
    path.symlink_to("/dev/zero")


def a_socket(path):
    here = path.parent
    before = os.getcwd()  # noqa: PTH109 the names of sockets are short
    os.chdir(here)
    try:
        with socket.socket(socket.AF_UNIX) as door:
            door.bind(path.name)
    finally:
        os.chdir(before)


def a_folder(path):
    path.mkdir()


def a_giant(path):
    with path.open("wb") as file:
        file.truncate(1 << 40)


KINDS = [
    (a_fifo, "FIFO"),
    (a_link_to_a_device, "device"),
    (a_socket, "socket"),
    (a_folder, "folder"),
    (a_giant, ""),
]


ALL = [(place, *kind) for place in PLACES for kind in KINDS]
ALL += [
    (place, *KINDS[kind])
    for number, place in enumerate(FURTHER)
    for kind in (0, 1 + number % (len(KINDS) - 1))
]


@pytest.mark.parametrize(
    ("place", "make", "word"), ALL, ids=[f"{place}-{make.__name__}" for place, make, _ in ALL]
)
def test_refused_by_name(place, make, word):
    files, command, name = (PLACES | FURTHER)[place]
    outcome = run(Case(place, files | {name: make}, command))
    if place == "runs to keep" and make is a_giant:
        return  # it is replaced
    if place == "report" and make is a_folder:
        assert outcome.faults == []  # a folder of results is what report may get
        return
    assert (outcome.code, outcome.signal, outcome.faults) == (2, None, []), outcome.text
    assert name in outcome.text
    assert word in outcome.text or "is not a regular file" in outcome.text
    if make is a_giant and name.endswith(("yaml", "csv")):
        assert "larger than" in outcome.text
        assert "(1.1e+03 GB)" in outcome.text


def test_files_are_read_whole(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(b"12345")
    assert read_regular(path, 5) == b"12345"
    with pytest.raises(UnreadableFileError, match="larger than"):
        read_regular(path, 4)
    with open_regular(path) as file:
        assert file.read(2) == b"12"
    check_regular(path, 5)


def test_missing_files(tmp_path):
    with pytest.raises(UnreadableFileError, match="there is no such file") as caught:
        check_regular(tmp_path / "none")
    assert caught.value.words == "there is no such file"
    with pytest.raises(UnreadableFileError, match="cannot be read: embedded null"):
        check_regular(tmp_path / "no\0ne")


def test_a_file_that_has_no_bytes_yet_is_no_result(tmp_path, monkeypatch):
    """Such as /proc/kmsg, a regular file of which reading gives None instead of waiting."""

    class Waiting(io.BytesIO):
        def read(self, *_):
            return None

        def fileno(self):
            return 0

    monkeypatch.setattr(opening, "open_regular", lambda _path: Waiting())
    with pytest.raises(InputError, match="is not an HDF5 file"):
        opening.is_open_for_writing(tmp_path / "waiting.h5")


def test_an_output_without_bytes_is_replaced_unread(tmp_path, monkeypatch):
    """A file of the system may hold none, and whoever reads it waits for the first."""
    output = tmp_path / "out.h5"
    output.touch()
    monkeypatch.setattr(Path, "open", lambda *_: pytest.fail("it is read"))
    assert check_output(output) == output
