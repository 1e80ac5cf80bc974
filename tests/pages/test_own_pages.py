"""Every listing of the pages on own vehicles, own tyres and comparing works."""

import json
import math
import re
import sys
from pathlib import Path

import pytest
from programs import run

from vehicledyn.results.store.reader import open_result

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"# (\S+)\n")


def work_through(page, folder):
    """Write the files of a page and run its commands in order; return what they printed."""
    printed = {}
    for kind, body in BLOCK.findall((DOCS / page).read_text(encoding="utf-8")):
        if kind == "sh":
            printed |= {line: run(line, folder) for line in body.splitlines()}
        else:
            name = FILE.match(body)[1]
            (folder / name).write_text(body, encoding="utf-8")
            if kind == "python":
                printed[name] = run([sys.executable, name], folder, PYTHONSAFEPATH="")
    return printed


def test_own_tyre(tmp_path):
    printed = work_through("own_tyre.md", tmp_path)
    curve = re.findall(r"([\d.]+)°\s+(\S+) N", printed["curve.py"])
    for degrees, force in curve:
        s = 60e3 * math.radians(float(degrees)) / (0.9 * 4e3)
        assert float(force) == pytest.approx(-0.9 * 4e3 * s / (1.0 + s), abs=0.06)
    assert len(curve) == 4
    assert printed["drive.py"].split() == ["ok", "N"]
    with open_result(tmp_path / "mine.h5") as result:
        table = result.as_frame()
    last = table.iloc[-1]
    slip = math.hypot(last["wheel_fl.tyre.longitudinal_slip"], last["wheel_fl.tyre.slip_angle"])
    s = 60e3 * slip / (0.9 * 4e3)
    force = math.hypot(
        last["wheel_fl.tyre.longitudinal_force"], last["wheel_fl.tyre.lateral_force"]
    )
    assert force == pytest.approx(
        0.9 * last["wheel_fl.tyre.normal_force"] * s / (1.0 + s), rel=1e-4
    )


def test_own_vehicle(tmp_path):
    work_through("own_vehicle.md", tmp_path)
    with open_result(tmp_path / "my_drive.h5") as result:
        assert result.is_whole
        table = result.as_frame()
    loads = table.filter(like="normal_force").iloc[0]
    weight = (800.0 + 4 * 20.0) * 9.81
    assert loads.sum() == pytest.approx(weight, rel=1e-5)
    # Moments about the rear axle: all masses of the front axle, and 1.5 m of 2.5 m of the body.
    front = (40.0 + 800.0 * 1.5 / 2.5) * 9.81
    assert loads.filter(like="front").sum() == pytest.approx(front, rel=2e-3)
    turned, steered = table["chassis.yaw"].iloc[-1], table["front_left_upright.steer"].iloc[-1]
    assert abs(turned) > 0.05 and turned * steered > 0.0
    assert (tmp_path / "my_drive_report.html").is_file()
    assert (tmp_path / "my_drive_animation.html").is_file()


def test_comparing(tmp_path):
    (tmp_path / "scenarios").symlink_to(ROOT / "scenarios")
    printed = work_through("compare_in_ci.md", tmp_path)
    (told,) = (text for line, text in printed.items() if "|| echo" in line)
    assert told.endswith("differs, as it should\n")
    assert "<testsuite " in (tmp_path / "report.xml").read_text()
    assert (tmp_path / "changed.html").is_file()


def test_the_job_fails_where_a_result_differs(tmp_path):
    page = (DOCS / "compare_in_ci.md").read_text(encoding="utf-8")
    (script,) = (body for kind, body in BLOCK.findall(page) if kind == "bash")
    (tmp_path / "compare_all.sh").write_text(script, encoding="utf-8")
    scenarios, references = tmp_path / "scenarios", tmp_path / "references"
    scenarios.mkdir()
    references.mkdir()
    source = ROOT / "scenarios" / "systems" / "slider_crank.yaml"
    text = source.read_text(encoding="utf-8").replace(
        "../../systems/", (ROOT / "systems").as_posix() + "/"
    )
    (scenarios / "slider_crank.yaml").write_text(text, encoding="utf-8")
    command = f"vehicledyn run {scenarios}/slider_crank.yaml --no-plots -q -o {references}"
    run(f"{command}/slider_crank.h5", tmp_path)
    job = f"bash compare_all.sh {scenarios} {references}"
    run(job, tmp_path)
    run(f'{command}/slider_crank.h5 --set "slider.mass=1 kg"', tmp_path)
    assert json.loads(run(f"{job} >/dev/null; echo $?", tmp_path)) == 1
