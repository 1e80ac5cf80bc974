"""Every listing of the page on optimal manoeuvres works."""

import re
from pathlib import Path

import pytest
from programs import run

pytestmark = pytest.mark.long

PAGE = (Path(__file__).parents[2] / "docs" / "optimal_manoeuvres.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def test_the_page(tmp_path):
    printed = ""
    for kind, body in BLOCK.findall(PAGE):
        if kind == "yaml":
            (tmp_path / re.match(r"# (\S+)\n", body)[1]).write_text(body, encoding="utf-8")
            continue
        for line in body.splitlines():
            printed += run(line, tmp_path)
    assert "simulated under these controls" in printed
    assert (tmp_path / "swing_up.h5").is_file()
