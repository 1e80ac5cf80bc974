"""Every listing of the page on equilibrium, eigenmodes and frequency response works."""

import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from programs import run

from vehicledyn.results.tables.mode_table import read_modes
from vehicledyn.results.tables.response_table import read_response

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "analyses.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    """Run the page from its first line to its last; return the folder and what was printed."""
    folder, printed = tmp_path_factory.mktemp("page"), {}
    for kind, body in BLOCK.findall(PAGE):
        if kind == "yaml":
            (folder / re.match(r"# (\S+)\n", body)[1]).write_text(body, encoding="utf-8")
        elif kind == "python":
            printed["python"] = run([sys.executable, "-c", body], folder)
        else:
            printed |= {line: run(line, folder) for line in body.splitlines()}
    return folder, printed


def test_mode_shapes_as_told(said):
    _, printed = said
    assert "upper.height 1, lower.height 0.0938∠26°" in PAGE
    text = printed["vehicledyn eig two_masses.yaml"]
    assert "upper.height 1, lower.height 0.0938∠26°" in text
    modes = json.loads(next(v for k, v in printed.items() if "--json -o modes.h5" in k))
    (body, _) = modes["speeds"][0]["modes"]
    assert [item["name"] for item in body["coordinates"][:2]] == ["upper.height", "lower.height"]
    assert body["coordinates"][0]["magnitude"] == pytest.approx(1.0, rel=1e-12)
    assert body["coordinates"][1]["magnitude"] == pytest.approx(0.0938, abs=5e-5)


def test_files_and_figures_of_the_page(said):
    folder, printed = said
    modes = read_modes(folder / "modes.h5")
    (case,) = modes.cases
    # the strut carries what accelerates the upper mass: F = m λ² z
    force = case.channel_shape[:, modes.columns(["strut.force", "upper.height"])]
    assert force[:, 0] == pytest.approx(-300.0 * case.eigenvalue**2 * force[:, 1], rel=1e-9)
    assert "N per m of the leading mass" in printed["python"]
    assert [case.label for case in read_modes(folder / "iltis.h5").cases][::2] == [
        "10 m/s", "30 m/s",
    ]  # fmt: skip
    assert len(list((folder / "locus").glob("mode_shapes_case_2_*.png"))) == 1
    assert (folder / "iltis_plots" / "root_locus.png").is_file()
    table = read_response(folder / "steering.h5")
    assert [item.unit for item in table.outputs] == ["rad/s", "m/s^2"]
    assert table.static_gain[0, 1] == pytest.approx(20.0 * table.static_gain[0, 0], rel=0.2)
    assert {p.name for p in (folder / "steering").glob("*.png")} == {
        "bode_body_yaw_rate.png", "bode_accelerometer_lateral.png",
    }  # fmt: skip


def test_responses_of_the_page(said):
    _, printed = said
    text = next(v for k, v in printed.items() if '--at "1.5 Hz"' in k)
    assert "static gain  6.11111e-05 m/N" in text  # 1/18000 + 1/180000
    assert len(re.findall(r"^ +1\.?5? Hz ", text, re.MULTILINE)) == 2
    told = json.loads(next(v for k, v in printed.items() if "--input profile" in k))
    assert told["stable"] and len(told["responses"]) == 2
    ride = np.array(told["responses"][0]["magnitude"])
    assert len(ride) == len(told["frequency"]) == 200
    assert told["responses"][0]["unit"] == "m/s^2/m"


def test_links_of_the_page_lead_to_files():
    links = re.findall(r"\]\(([^)#:]+)\)", PAGE)
    assert [link for link in links if not (ROOT / "docs" / link).exists()] == []
