"""Every listing of the page on animations works and tells what the page says."""

import re
import sys
from pathlib import Path

import pytest
from programs import run

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "animation.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def said(tmp_path_factory, needs_compiler):
    """Run the page from its first line to its last; return the folder and what was printed."""
    folder, printed = tmp_path_factory.mktemp("page"), {}
    (folder / "scenarios").symlink_to(ROOT / "scenarios")
    for kind, body in BLOCK.findall(PAGE):
        if kind == "python":
            run([sys.executable, "-c", body], folder)
        else:
            printed |= {line: run(line, folder) for line in body.splitlines()}
    return folder, printed


def test_files(said):
    folder, printed = said
    assert printed["vehicledyn animate slalom.h5"] == "slalom_animation.html\n"
    page = (folder / "slalom_animation.html").stat().st_size
    assert 0.7e6 < page < 1.5e6
    assert (folder / "both.html").stat().st_size > page
    assert (folder / "passing.png").read_bytes()[1:4] == b"PNG"
    assert b"<svg" in (folder / "above.svg").read_bytes()[:600]
    assert (folder / "slalom.gif").read_bytes()[:6] == b"GIF89a"


def test_size_of_the_section(said):
    folder, _ = said
    sizes = [(folder / name).stat().st_size for name in ("slalom.h5", "plain.h5")]
    assert 1.1 < sizes[0] / sizes[1] < 1.35
