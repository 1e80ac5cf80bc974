"""Every listing of the page on Python works."""

import csv

import numpy as np
import pytest
from scipy.io import loadmat
from test_own_pages import work_through


def test_the_page_on_python(tmp_path):
    printed = work_through("python.md", tmp_path)
    shown, unit, numbers = printed["quarter_car.py"].splitlines()
    assert shown.startswith("Scenario 'A quarter car") and "10 kN/m" in shown
    assert unit == "m ('time',) (101,)"
    assert float(numbers.split()[-1]) == 2.0
    results = printed["results.py"]
    assert "[[1.]]" in results and results.count("soft") == 1
    drops = eval(results.splitlines()[-1])
    assert drops == sorted(drops, reverse=True)
    assert printed["wrong.py"].startswith("duration: '1 kg' has the wrong unit")
    frequency, drift, ends = printed["pendulum.py"].splitlines()
    # A rod of 2 m about its end: ω² = 3 g/(2 l).
    assert frequency == str(np.round([[np.sqrt(1.5 * 9.81 / 2.0) / (2.0 * np.pi)]], 4))
    assert drift == "True"
    pulse = np.sqrt(1.5 * 9.81 / np.array([1.0, 2.0, 3.0]))
    angles = [float(text) for text in ends.strip("[]").split()]
    assert angles == pytest.approx(0.1 * np.cos(pulse), abs=1e-3)
    sizes, groups = printed["tree.py"].splitlines()
    assert sizes == "3 ('case', 'time', 'channel')"
    assert {"channels", "axes", "cases", "figures"} <= set(eval(groups))
    assert (tmp_path / "heights.png").is_file()
    table = list(csv.reader((tmp_path / "body.csv").read_text(encoding="utf-8").splitlines()))
    assert table[:2] == [["time", "body.height", "body.height_rate"], ["s", "m", "m/s"]]
    masses = loadmat(tmp_path / "study.mat")["parameters_body_mass"]
    assert masses.ravel().tolist() == [200.0, 300.0, 400.0]
