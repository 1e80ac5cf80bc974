"""Every listing of the page on limit cycles works and tells what the page says."""

import json
import math
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from programs import run

from vehicledyn.results.tables.hunt_table import read_hunt

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "hunting.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    """Run the page from its first line to its last; return the folder and what was printed."""
    folder, printed = tmp_path_factory.mktemp("page"), {}
    (folder / "systems").symlink_to(ROOT / "systems")
    for kind, body in BLOCK.findall(PAGE):
        if kind == "python":
            printed["python"] = run([sys.executable, "-c", body], folder)
        else:
            printed |= {line: run(line, folder) for line in body.splitlines()}
    return folder, printed


def closed_form():
    """Linear critical speed [m/s] and its frequency [Hz] of the simple wheelset."""
    m, inertia, a, r, conicity, ky, kp, f = 1500, 900, 0.75, 0.45, 0.15, 4e5, 2.5e6, 6e6
    c1, c2 = 2 * f, 2 * f * a * a
    square = (c1 * kp + c2 * ky) / (m * c2 + inertia * c1)
    below = ky * kp + 4 * f * f * a * conicity / r + m * inertia * square**2
    below -= (m * kp + inertia * ky) * square
    return math.sqrt(c1 * c2 * square / below), math.sqrt(square) / (2 * math.pi)


def test_critical_speeds(said):
    folder, _ = said
    table = read_hunt(folder / "simple_wheelset_hunt.h5")
    figures = table.figures
    speed, frequency = closed_form()
    assert figures["linear_critical"] == pytest.approx(speed, rel=1e-9)
    assert figures["linear_critical_frequency"] == pytest.approx(frequency, rel=1e-9)
    assert f"{speed:.3f} m/s with {frequency:.4f} Hz" in PAGE
    assert f"{figures['nonlinear_critical']:.2f}" == "54.46"
    assert figures["simulated_lowering"] == pytest.approx(figures["nonlinear_critical"], rel=1e-3)
    assert figures["simulated_raising"] == pytest.approx(speed, rel=1e-3)
    assert 0.0 < figures["largest_difference_amplitude"] < 0.005
    assert 0.0 < figures["largest_difference_period"] < 0.005


def test_branch_with_its_fold(said):
    folder, printed = said
    table = read_hunt(folder / "simple_wheelset_hunt.h5")
    rows = table.branch(1)
    assert table.status == "ok" and len(rows) > 30
    assert max(abs(row.trivial - 1.0) for row in rows) < 1e-4
    first = next(k for k, row in enumerate(rows) if row.kind == "fold")
    assert not any(row.stable for row in rows[2:first])
    assert all(row.stable for row in rows[first + 1 : first + 5])
    assert rows[first].amplitude[0] == pytest.approx(8e-3, rel=0.02)  # the flange's clearance
    motion = np.array(rows[-1].motion)
    assert motion[0] == pytest.approx(motion[-1], abs=1e-9)
    assert np.abs(motion[:, 0]).max() == pytest.approx(rows[-1].amplitude[0], rel=1e-2)
    assert "linear_critical" in printed["vehicledyn info simple_wheelset_hunt.h5"]
    values = printed["python"].split("\n")[0].split()
    assert float(values[1]) == pytest.approx(54.46, abs=0.01)
    assert (folder / "simple_wheelset_hunt_plots" / "bifurcation.png").is_file()
    assert (folder / "simple_wheelset_hunt_plots" / "root_locus.svg").is_file()


def test_other_parameters_and_json(said):
    folder, printed = said
    told = json.loads(next(text for line, text in printed.items() if "--json" in line))
    assert told["status"] == "ok"
    assert told["cycles"][0]["multipliers"][0]["real"] == pytest.approx(1.0, abs=1e-6)
    assert told["figures"]["nonlinear_critical"] == pytest.approx(54.4632, rel=1e-5)
    stiffness = read_hunt(folder / "stiffness.h5")
    assert stiffness.parameter.name == "lateral_stiffness"
    assert stiffness.parameter.unit == "N/m"


def test_links_of_the_page_lead_to_files():
    links = re.findall(r"\]\(([^)#:]+)\)", PAGE)
    assert links
    assert [link for link in links if not (ROOT / "docs" / link).exists()] == []


def test_the_bicycle_of_the_page(said):
    """The numbers of the text are those of the file."""
    folder, printed = said
    figures = read_hunt(folder / "bicycle.h5").figures
    for key in ("oscillation_ceases", "divergence_begins"):
        assert f"{figures[key]:.3f} m/s" in PAGE
    (command,) = (line for line in printed if "bicycle.yaml" in line)
    assert "an oscillation ceases to grow" in printed[command]
