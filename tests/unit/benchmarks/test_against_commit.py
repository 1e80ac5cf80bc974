"""The comparison with an earlier commit: which way a ratio points, and what is refused."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "benchmarks"))

import against_commit


def test_ratios_above_one_are_better_whatever_the_unit():
    assert against_commit.compared("s", [4.0, 2.0, 3.0], [1.0, 2.0, 1.5]) == [2.0, 2.0]
    assert against_commit.compared("x", [100.0, 120.0, 90.0], [200.0, 150.0, 240.0]) == [2.0, 2.0]


def test_a_revision_that_git_does_not_know(tmp_path):
    with pytest.raises(SystemExit, match="nonsense: fatal: "):
        against_commit.unpacked("nonsense", tmp_path)


def test_another_package_than_the_trees_is_refused(tmp_path):
    """A tree without a package would measure the installed one."""
    with pytest.raises(SystemExit, match="empty: Python takes the package from"):
        against_commit.Tree("empty", tmp_path, tmp_path).check()


def test_each_turn_has_new_files_of_the_kernels(tmp_path):
    tree = against_commit.Tree("some", tmp_path, tmp_path)
    kernel = tmp_path / "cache" / "kernels" / "kernel.so"
    kernel.parent.mkdir(parents=True)
    kernel.write_bytes(b"code")
    before = kernel.stat().st_ino
    tree.renew_cache()
    assert kernel.read_bytes() == b"code"
    assert kernel.stat().st_ino != before
    assert [item.name for item in tmp_path.iterdir()] == ["cache"]
