"""Every listing of the pages on identification and uncertainty works."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.long

DOCS = Path(__file__).parents[2] / "docs"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize(
    ("page", "said"),
    [
        ("identification", [r"body\.stiffness = 2\.5e\+04 N/m", "identified parameters"]),
        ("uncertainty", ["first_order, 1 runs", r"max\(body\.height\) above 1\.05 m in \d"]),
    ],
)
def test_the_page(page, said, tmp_path):
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    printed = ""
    for kind, body in BLOCK.findall((DOCS / f"{page}.md").read_text(encoding="utf-8")):
        if kind == "yaml":
            (tmp_path / re.match(r"# (\S+)\n", body)[1]).write_text(body, encoding="utf-8")
            continue
        (tmp_path / "listing.py").write_text(body, encoding="utf-8")
        command = ["sh", "-ec", body if kind == "sh" else "python listing.py"]
        done = subprocess.run(
            command, cwd=tmp_path, env=os.environ | {"PATH": path}, check=False,
            capture_output=True, text=True, timeout=300,
        )  # fmt: skip
        assert done.returncode == 0, f"{body}\n{done.stdout}\n{done.stderr}"
        printed += done.stdout
    for words in said:
        assert re.search(words, printed), f"{words} not in {printed}"
    assert list((tmp_path / "figures").glob("*.png"))
