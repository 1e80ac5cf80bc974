"""Every command and listing of the page on cams works; its tables name every kind."""

import re
from pathlib import Path

from programs import run

from vehicledyn.base.registry import kinds
from vehicledyn.cams.cam_file import read_cam

PAGE = (Path(__file__).parents[2] / "docs" / "cams.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
FIRST = re.compile(r"# (\S+)\n")


def test_listings_and_commands(tmp_path):
    for kind, body in BLOCK.findall(PAGE):
        if body.startswith("# part of"):
            continue  # systems/cam_follower.yaml has the same
        if kind == "yaml":
            (tmp_path / FIRST.match(body)[1]).write_text(body)
            assert read_cam(tmp_path / FIRST.match(body)[1]).title
            continue
        lines = body.splitlines()
        if kind == "python":
            (tmp_path / FIRST.match(body)[1]).write_text(body)
            lines = [f"python {FIRST.match(body)[1]}"]
        for line in lines:
            assert run(line, tmp_path)
    names = {p.name for p in tmp_path.iterdir()}
    assert {"intake.csv", "intake.h5", "intake.dxf", "intake_pictures"} <= names


def test_page_names_every_kind():
    for family in ("motion_law", "cam_follower", "cam_outline"):
        for kind in kinds(family):
            assert f"`{kind}`" in PAGE
