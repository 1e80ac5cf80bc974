"""Every listing of the page on optimisation works."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.long

PAGE = (Path(__file__).parents[2] / "docs" / "optimisation.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def test_the_page(tmp_path):
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    printed = ""
    for kind, body in BLOCK.findall(PAGE):
        if kind == "yaml":
            (tmp_path / re.match(r"# (\S+)\n", body)[1]).write_text(body, encoding="utf-8")
            continue
        done = subprocess.run(
            ["sh", "-ec", body], cwd=tmp_path, env=os.environ | {"PATH": path}, check=False,
            capture_output=True, text=True, timeout=300,
        )  # fmt: skip
        assert done.returncode == 0, f"{body}\n{done.stdout}\n{done.stderr}"
        printed += done.stdout
    assert "active: rms(strut.rate) at most 0.12" in printed
    assert (tmp_path / "comfort.h5").is_file()
