"""Every command and listing of the page on the assessment of vehicles on rails works."""

import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from programs import run

from vehicledyn.results.store.layout import ResultHeader
from vehicledyn.results.store.writer import ResultWriter
from vehicledyn.symbolic.equations import Channel

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "rail_assessment.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def blocks(language):
    return [body for kind, body in BLOCK.findall(PAGE) if kind == language]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a run of 40 s through a made-up curve."""
    place = tmp_path_factory.mktemp("page")
    time = np.arange(0.0, 40.0025, 5e-3)
    curve = np.clip(time / 10.0 - 1.0, 0.0, 1.0)
    values = {
        "front.left.Q": ("N", 5e4 - 8e3 * curve),
        "front.right.Q": ("N", 5e4 + 8e3 * curve),
        "front.left.Y": ("N", 6e3 * curve),
        "front.right.Y": ("N", -14e3 * curve),
        "front.left.wear_number": ("N", 60.0 * curve),
        "front.right.wear_number": ("N", 180.0 * curve),
        "front.track_position": ("m", 20.0 * time),
        "seat.longitudinal": ("m/s^2", 0.05 * np.sin(2.0 * np.pi * time)),
        "seat.lateral": ("m/s^2", 0.2 * np.sin(2.0 * np.pi * 1.2 * time)),
        "seat.vertical": ("m/s^2", 0.3 * np.sin(2.0 * np.pi * 1.6 * time)),
    }
    channels = [Channel(name, unit, name) for name, (unit, _) in values.items()]
    header = ResultHeader("A curve of 300 m", "bogie")
    with ResultWriter(place / "curve.h5", channels=channels, header=header) as writer:
        writer.append(time, np.stack([column for _, column in values.values()], axis=1))
    return place


def test_commands(folder):
    whole, section, as_json = (run(line, folder) for line in blocks("sh")[0].splitlines())
    assert "0 to 40 s, 800 m, 200 samples a second" in whole
    assert "10 to 30 s, 400 m" in section
    assert json.loads((folder / "curve.json").read_text()) == json.loads(as_json)
    rows = {row.split()[0]: row.split() for row in whole.splitlines() if row.startswith("  front")}
    assert set(rows) == {"front", "front.left", "front.right"}
    found = json.loads(as_json)
    ratio = found["wheels"][1]["derailment"]
    assert ratio == pytest.approx(14.0 / 58.0, rel=1e-6)
    assert len(found["wear"][0]["parts"]) == 10


def test_python_listing(tmp_path):
    (listing,) = blocks("python")
    assert run([sys.executable, "-c", listing], tmp_path) == "1.20\n"


def test_numbers_of_the_table_are_those_of_the_program():
    from vehicledyn.results.assessment import weighting

    rows = re.findall(r"^\| (W_.*?) \|(.*)\|$", PAGE, re.MULTILINE)
    known = [weighting.W_B, weighting.W_B_ISO, weighting.W_C, weighting.W_D]
    assert len(rows) == len(known)
    for (name, cells), own in zip(rows, known, strict=True):
        numbers = [float(cell) for cell in cells.split("|") if cell.strip()]
        wanted = [0.4, 100.0, own.transition, own.quality]
        if own.step is not None:
            s = own.step
            wanted += [s.low, s.low_quality, s.high, s.high_quality, s.gain]
        assert name.startswith(own.name)
        assert numbers == wanted


def test_numbers_of_curve_transitions_are_those_of_the_program():
    from vehicledyn.results.assessment.curve_transitions import SEATED, STANDING

    rows = dict(re.findall(r"^\| (standing|seated) \|(.*)\|$", PAGE, re.MULTILINE))
    for name, own in (("standing", STANDING), ("seated", SEATED)):
        assert [float(cell) for cell in rows[name].split("|")] == list(vars(own).values())


def test_keys_of_the_summary_exist():
    text = (ROOT / "vehicledyn" / "results" / "assessment" / "summary.py").read_text("utf-8")
    keys = re.findall(r"`(largest_\w+|instability_\w+|track_shift_limit|wear_\w+)`", PAGE)
    for key in set(keys) - {"wear_number"}:
        assert f'"{key}"' in text, key
