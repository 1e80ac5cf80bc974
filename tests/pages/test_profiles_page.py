"""Every command and listing of the page on profiles works."""

import re
import sys
from pathlib import Path

import pytest
from programs import run

from vehicledyn.results.tables.contact_table import read_contacts

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "profiles.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
COMMANDS = [
    line for kind, body in BLOCK.findall(PAGE) if kind == "sh" for line in body.splitlines()
]


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """The folder in which all commands have run, and what each printed."""
    place = tmp_path_factory.mktemp("page")
    (place / "profiles").symlink_to(ROOT / "profiles")
    return place, {line: run(line, place) for line in COMMANDS}


def test_first_command_writes_result_and_pictures(told):
    folder, printed = told
    table = read_contacts(folder / "geometry.h5")
    assert table.settings["gauge"] == 1.435
    assert len(table.jumps) == 6
    pictures = {path.name for path in (folder / "geometry").iterdir()}
    assert pictures == {"contact.png", "contact.svg", "geometry.png", "geometry.svg"}
    assert "contact jumps at y = 4.99" in printed[COMMANDS[0]]
    again = {path.name for path in (folder / "again").iterdir()}
    assert again == {"contact.png"}
    told = next(text for line, text in printed.items() if line.startswith("vehicledyn info"))
    assert "contact geometry of wheel and rail" in told
    assert "17 shifts from -8 to 8 mm" in told


def test_profiles_of_the_folder_are_those_of_the_names(told):
    """The tables hold half-millimetre steps of the profiles that the names build."""
    printed = told[1]
    rows = {}
    for line, text in printed.items():
        if line.startswith(("vehicledyn profiles profiles/s1002.csv profiles", COMMANDS[0])):
            rows[line] = {
                row.split()[0]: [float(cell) for cell in row.split()[1:]]
                for row in text.splitlines()
                if re.match(r" +-?\d+\.\d{3} ", row) and len(row.split()) == 11
            }
    by_name, by_file = rows[COMMANDS[0]], next(v for k, v in rows.items() if k != COMMANDS[0])
    for shift in ("1.000", "2.000", "4.000"):
        assert by_file[shift][:2] == pytest.approx(by_name[shift][:2], abs=0.02)
        assert by_file[shift][8] == pytest.approx(by_name[shift][8], abs=2e-3)


def test_smoothing_is_reported(told):
    (text,) = (text for line, text in told[1].items() if "--smoothing" in line)
    assert "smoothed over 2 mm: points lie up to" in text


def test_python_listing(tmp_path):
    (listing,) = (body for kind, body in BLOCK.findall(PAGE) if kind == "python")
    assert "touches at -12.7" in run([sys.executable, "-c", listing], tmp_path)


def test_links_lead_to_files():
    pages = ("docs/profiles.md", "profiles/README.md")
    for page in pages:
        text = (ROOT / page).read_text(encoding="utf-8")
        for link in re.findall(r"\]\(([^)#:]+)\)", text):
            assert ((ROOT / page).parent / link).exists(), link
