"""Every command and listing of the page on tyres works; its table names every law and option."""

import re
from pathlib import Path

import h5py
from programs import run

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.parameters import read_part
from vehicledyn.base.registry import kinds
from vehicledyn.base.yaml import read_yaml
from vehicledyn.road.tyres.pacejka.formula_61 import RULES

PAGE = (Path(__file__).parents[2] / "docs" / "tyres.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def test_commands(tmp_path):
    commands = [
        line for kind, body in BLOCK.findall(PAGE) if kind == "sh" for line in body.splitlines()
    ]
    for line in commands:
        assert "version 6.1" in run(line, tmp_path)
    with h5py.File(tmp_path / "tyres.h5") as file:
        assert set(file) == {"tyre_1", "tyre_2"}
    assert (tmp_path / "tyre_pictures" / "friction_ellipse.png").is_file()


def test_listing(tmp_path):
    (listing,) = [body for kind, body in BLOCK.findall(PAGE) if kind == "yaml"]
    (tmp_path / "a.yaml").write_text(listing)
    tyre = read_part("tyre", read_yaml(tmp_path / "a.yaml").data["tyres"])
    assert tyre.kind == "file" and tyre.friction == 0.8 and tyre.pressure == 2.4e5


def test_page_names_every_law_and_convention():
    for kind in kinds("tyre"):
        tail = kind.removeprefix("magic_formula")
        assert f"`{kind}`" in PAGE or f"`{tail}`" in PAGE or kind == "calspan"
    for name in (*RULES, "chrono"):
        assert f"`{name}`" in PAGE
