"""Every command and every listing of docs/accuracy.md works."""

import re
import shutil
import sys
from pathlib import Path

import pytest
from programs import call, run
from test_documents import BLOCK, blocks

from vehicledyn.results.store.reader import open_result

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "accuracy.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def told(tmp_path_factory, needs_compiler):
    """Run the commands in order; return the folder and what each printed."""
    folder = tmp_path_factory.mktemp("accuracy")
    for name in ("scenarios", "systems"):
        shutil.copytree(ROOT / name, folder / name)
    (listing,) = blocks(PAGE, "yaml")
    (folder / "stepless.yaml").write_text(listing, encoding="utf-8")
    printed = []
    for block in blocks(PAGE, "sh"):
        for line in block.splitlines():
            command, _, code = line.partition("# exit ")
            done = call(command.strip(), folder)
            assert done.returncode == int(code or 0), done.stderr
            printed.append(done.stdout + done.stderr)
    return folder, printed


def test_warning_of_the_page(told):
    (text,) = blocks(PAGE, "text")
    assert text.strip() in told[1][0]


def test_python_listing(told):
    (listing,) = blocks(PAGE, "python")
    printed = run([sys.executable, "-c", listing], told[0])
    lines = printed.splitlines()
    assert lines == ["inaccurate", "14% off: largest_sideslip_angle", "take 2.5 ms"]


def test_statuses_and_steps(told):
    folder, printed = told
    with open_result(folder / "diverged.h5") as result:
        assert result.status == "failed"
    assert "the integration diverges with a step of 50 ms" in printed[1]
    assert "chosen from the motion at the start" in printed[2]
    with open_result(folder / "stepless.h5") as result:
        assert result.solver["accuracy"] == "accurate"


def test_attributes_are_those_of_the_file(told):
    named = set(re.findall(r"^- `(\w+)`:", PAGE, re.MULTILINE))
    with open_result(told[0] / "coarse.h5") as result:
        assert named <= set(result.solver)


def test_every_listing_is_run_by_a_test():
    kinds = {kind for kind, _ in BLOCK.findall(PAGE)}
    assert kinds == {"sh", "text", "python", "yaml"}
