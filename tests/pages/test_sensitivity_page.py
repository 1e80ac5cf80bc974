"""Every listing of the page on sensitivities works."""

import re
import sys
from pathlib import Path

import pytest
from programs import run

pytestmark = pytest.mark.long

PAGE = (Path(__file__).parents[2] / "docs" / "sensitivity.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def test_the_page(tmp_path):
    printed = []
    for kind, body in BLOCK.findall(PAGE):
        commands = [[sys.executable, "-c", body]] if kind == "python" else body.splitlines()
        printed.append("".join(run(command, tmp_path) for command in commands))
    assert "max(lower.angle)" in printed[0]
    assert (tmp_path / "figures" / "tornado_max_lower_angle.png").is_file()
    assert re.search(r"\[\d\.\d+", printed[1])
