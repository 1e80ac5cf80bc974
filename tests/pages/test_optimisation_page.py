"""Every listing of the page on optimisation works."""

import re
from pathlib import Path

import pytest
from programs import run

pytestmark = pytest.mark.long

PAGE = (Path(__file__).parents[2] / "docs" / "optimisation.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def test_the_page(tmp_path):
    printed = ""
    for kind, body in BLOCK.findall(PAGE):
        if kind == "yaml":
            (tmp_path / re.match(r"# (\S+)\n", body)[1]).write_text(body, encoding="utf-8")
            continue
        for line in body.splitlines():
            printed += run(line, tmp_path)
    assert "active: rms(strut.rate) at most 0.12" in printed
    assert (tmp_path / "comfort.h5").is_file()
