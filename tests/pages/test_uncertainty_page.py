"""The listing of the page on uncertainty works."""

import re
from pathlib import Path

import pytest

pytestmark = pytest.mark.long

PAGE = (Path(__file__).parents[2] / "docs" / "uncertainty.md").read_text(encoding="utf-8")


def test_the_page(capsys):
    (body,) = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    exec(compile(body, "uncertainty.md", "exec"), {})
    printed = capsys.readouterr().out
    assert "first_order, 1 runs" in printed
    assert re.search(r"max\(body\.height\) above 1\.05 m in \d", printed)
