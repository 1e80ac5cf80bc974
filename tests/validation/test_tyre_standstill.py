"""A car with locked wheels on a 20 % slope for ten minutes, on tyres of property files."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from vehicledyn.results.store.reader import open_result

STANDING = Path(__file__).parents[2] / "scenarios" / "iltis_standstill.yaml"
CREEP = 1e-9
"""Most that the car may move from the time on when its springs are at rest [m]."""

AT_REST = 30.0
"""Time by which oscillations are below rounding [s]."""


@pytest.mark.validation
@pytest.mark.parametrize("name", ["passenger_R0394_mf61.tir", "passenger_235_60R16_pac2002.tir"])
def test_no_creep_on_a_slope(tmp_path, name):
    text = STANDING.read_text(encoding="utf-8")
    for old, new in (
        ("kind: magic_formula_1987", f"file: {name}"),
        ("slope_x: 0.05", "slope_x: 0.2"),
        ("slope_y: 0.1", "slope_y: 0.0"),
        ("kind: first_order\n  longitudinal: 0.2 m\n  lateral: 0.4 m", "kind: of_tyre"),
        ("duration: 5 s", "duration: 600 s"),
        ("interval: 10 ms", "interval: 1 s"),
    ):
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "stand.yaml").write_text(text, encoding="utf-8")
    arguments = ["run", str(tmp_path / "stand.yaml"), "-o", str(tmp_path / "stand.h5")]
    subprocess.run(
        [sys.executable, "-m", "vehicledyn", *arguments, "--no-plots"], check=True, timeout=300
    )
    with open_result(tmp_path / "stand.h5") as result:
        frame = result.as_frame()
    late = frame[frame.index >= AT_REST]
    assert len(late) > 500
    for name in ("chassis.x", "chassis.y"):
        assert np.ptp(late[name].to_numpy()) < CREEP
