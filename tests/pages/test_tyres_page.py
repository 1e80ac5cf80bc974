"""Every command and listing of the page on tyres works; its tables name what exists."""

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


def test_laws_of_the_table_exist():
    """The reference, which is generated, has all."""
    table = PAGE.split("## Other laws")[1].split("##")[0]
    rows = [
        re.findall(r"`(\w+)`", row.split("|")[1]) for row in re.findall(r"^\| `.*", table, re.M)
    ]
    named = {f"magic_formula{k}" if k.startswith("_") else k for row in rows for k in row}
    assert len(named) > 5
    assert named <= set(kinds("tyre"))


def test_page_names_every_convention():
    for name in (*RULES, "chrono"):
        assert f"`{name}`" in PAGE
