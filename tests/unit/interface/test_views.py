"""Tracks, tyres, models, pages and exported equations from Python."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd

CURVE = """\
kind: layout
gauge: 1435 mm
inclination: 1/40
rail: "60E1"
segments:
  - {kind: straight, length: 20 m}
  - {kind: arc, length: 60 m, radius: 600 m}
"""
TYRE = next((Path(vd.__file__).parent).rglob("*.tir"))


def test_track(tmp_path):
    (tmp_path / "curve.yaml").write_text(CURVE)
    found = vd.track(tmp_path / "curve.yaml", every="10 m")
    assert found.kind == "track"
    assert found["s"].values == pytest.approx(np.arange(0.0, 81.0, 10.0))
    assert found["curvature"].values[-2] == pytest.approx(1e3 / 600.0)
    with pytest.raises(vd.InputError, match="every"):
        vd.track(tmp_path / "curve.yaml", every="10 kg")


@pytest.mark.parametrize("slope", ["1/20", "1:20", "0.05"])
def test_a_track_echoes_its_slope_as_written(slope, tmp_path):
    (tmp_path / "curve.yaml").write_text(CURVE.replace("1/40", slope))
    assert f"inclined {slope}," in vd.track(tmp_path / "curve.yaml").report.table.facts[0]


def test_tyre(tmp_path):
    found = vd.tyre(TYRE, loads=["4 kN"], save_to=tmp_path / "tyre.h5")
    force = found["tyre_1.lateral.lateral_force"]
    assert (found.kind, force.unit) == ("tyre", "N")
    assert 2e3 < np.abs(force.values).max() < 8e3
    page = vd.report(found, tmp_path / "tyre.html")
    assert TYRE.name in page.read_text(encoding="utf-8")


def test_models_name_every_system():
    found = vd.models()
    assert found["iltis"] and found["double_pendulum"]
    assert all(isinstance(sentence, str) for sentence in found.values())


def test_export(tmp_path):
    done = vd.write_equations("double_pendulum", "python", tmp_path / "pendulum.py")
    assert (tmp_path / "pendulum.py").is_file()
    assert done.as_text()
