"""Every command and listing of the page on handling works; its table names every test."""

import re
from pathlib import Path

import pytest
from programs import run

import vehicledyn
from vehicledyn.results.plots.handling.test_figures import TESTS
from vehicledyn.results.tables.handling_headings import STANDARDS, heading

pytestmark = pytest.mark.long

PAGE = (Path(__file__).parents[2] / "docs" / "handling.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
FIRST = re.compile(r"# (\S+)\n")


def test_listings_and_commands(tmp_path):
    for kind, body in BLOCK.findall(PAGE):
        lines = body.splitlines()
        if kind == "yaml":
            (tmp_path / FIRST.match(body)[1]).write_text(body)
            assert vehicledyn.load(tmp_path / FIRST.match(body)[1]).title
            continue
        if kind == "python":
            (tmp_path / FIRST.match(body)[1]).write_text(body)
            lines = [f"python {FIRST.match(body)[1]}"]
        for line in lines:
            run(line, tmp_path)
    assert "Understeer gradient" in (tmp_path / "steady.html").read_text()


def test_every_test_has_a_heading_with_its_standard():
    for test, title in TESTS.items():
        assert test in STANDARDS
        for standard in STANDARDS[test].split(", ")[:1]:
            assert standard.split(" S")[0].split(":")[0] in title or "NHTSA" in standard, test
    assert heading("step_steer") == "Step steer (ISO 7401:2011)"


def test_page_names_every_test():
    said = PAGE.lower().replace("-", " ")
    other = {
        "braking_in_turn": "braking in a turn",
        "crosswind": "side wind",
        "split_braking_steered": "held and steered",
    }
    for test in TESTS:
        assert other.get(test, test.replace("_", " ").removesuffix(" steer")) in said, test
