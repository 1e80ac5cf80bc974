"""Every command and listing of the page on vehicles on rails works."""

import re
from pathlib import Path

import pytest
from programs import run

from vehicledyn.results.store.reader import open_result

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "rail.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
LISTINGS = {body.split()[1]: body for kind, body in BLOCK.findall(PAGE) if kind == "yaml"}
COMMANDS = [
    line for kind, body in BLOCK.findall(PAGE) if kind == "sh" for line in body.splitlines()
]


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """The folder in which all commands have run, and what each printed."""
    place = tmp_path_factory.mktemp("page")
    for name, text in LISTINGS.items():
        (place / name).write_text(text, encoding="utf-8")
    printed = {}
    for line in COMMANDS:
        printed[line.split()[1]] = run(line, place)
    return place, printed


def test_run_has_the_channels_that_are_told(told):
    folder, _ = told
    names = re.findall(r"^\| (`.*?) \|", PAGE, re.MULTILINE)
    wanted, head = [], ""
    for text in re.findall(r"`([^`]+)`", " ".join(names)):
        head = head if text.startswith(".") else text.rpartition(".")[0]
        wanted.append((head + text if text.startswith(".") else text).replace("<name>", "wheels"))
    with open_result(folder / "swing.h5") as result:
        assert len(wanted) == 20
        assert [name for name in wanted if name not in result.units] == []
        assert abs(result.channel("wheelset.lateral").values[-1]) < 2e-3


def test_wheels_carry_the_load_in_equilibrium(told):
    _, printed = told
    (row,) = [line for line in printed["equilibrium"].splitlines() if "wheels.left.Q" in line]
    assert float(row.split()[-4]) == pytest.approx(0.5 * (85e3 + 1500.0 * 9.81), rel=1e-4)


def test_wheelset_is_stable_at_thirty_metres_a_second(told):
    assert "all others stable" in told[1]["eig"]


def test_links_of_the_page_lead_to_files():
    links = re.findall(r"\]\(([^)#:]+)\)", PAGE)
    assert [link for link in links if not (ROOT / "docs" / link).exists()] == []
