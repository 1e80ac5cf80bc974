"""Every listing of the pages on identification and uncertainty works."""

import re
from pathlib import Path

import pytest
from programs import run

pytestmark = pytest.mark.long

DOCS = Path(__file__).parents[2] / "docs"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize(
    ("page", "said"),
    [
        ("identification", [r"body\.stiffness = 2\.5e\+04 N/m", "identified parameters"]),
        ("uncertainty", ["first_order, 1 runs", r"max\(body\.height\) above -0\.15 m in [1-9]"]),
    ],
)
def test_the_page(page, said, tmp_path):
    printed = ""
    for kind, body in BLOCK.findall((DOCS / f"{page}.md").read_text(encoding="utf-8")):
        if kind == "yaml":
            (tmp_path / re.match(r"# (\S+)\n", body)[1]).write_text(body, encoding="utf-8")
            continue
        commands = body.splitlines() if kind == "sh" else [["python", "-c", body]]
        printed += "".join(run(command, tmp_path) for command in commands)
    for words in said:
        assert re.search(words, printed), f"{words} not in {printed}"
    assert list((tmp_path / "figures").glob("*.png"))
