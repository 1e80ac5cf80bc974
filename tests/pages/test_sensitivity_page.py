"""Every listing of the page on sensitivities works."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.long

PAGE = (Path(__file__).parents[2] / "docs" / "sensitivity.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def test_the_page(tmp_path):
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    printed = []
    for kind, body in BLOCK.findall(PAGE):
        command = [sys.executable, "-c", body] if kind == "python" else ["sh", "-ec", body]
        done = subprocess.run(
            command, cwd=tmp_path, env=os.environ | {"PATH": path}, check=False,
            capture_output=True, text=True, timeout=300,
        )  # fmt: skip
        assert done.returncode == 0, f"{body}\n{done.stdout}\n{done.stderr}"
        printed.append(done.stdout)
    assert "max(lower.angle)" in printed[0]
    assert (tmp_path / "figures" / "tornado_max_lower_angle.png").is_file()
    assert re.search(r"\[\d\.\d+", printed[1])
