"""Folders made for files go again where an error leaves them empty."""

import pytest

from vehicledyn.base.files.whole_file import folder_for_files, write_whole


def fail_in(folder, *, after=None):
    with pytest.raises(OSError, match="full"), folder_for_files(folder):
        if after is not None:
            write_whole(folder / after, "whole")
        raise OSError("full")


def test_folders_that_an_error_leaves_empty_go_again(tmp_path):
    fail_in(tmp_path / "a" / "b")
    assert list(tmp_path.iterdir()) == []


def test_folders_that_were_there_stay(tmp_path):
    (tmp_path / "a").mkdir()
    fail_in(tmp_path / "a" / "b")
    fail_in(tmp_path / "a")
    assert list(tmp_path.rglob("*")) == [tmp_path / "a"]


def test_folders_that_hold_a_whole_file_stay(tmp_path):
    fail_in(tmp_path / "a", after="one.txt")
    assert (tmp_path / "a" / "one.txt").read_text(encoding="utf-8") == "whole"
