"""Who else could change a file."""

import os

import pytest

from vehicledyn.base.files.ownership import writable_by_others

pytestmark = pytest.mark.skipif(not hasattr(os, "geteuid"), reason="needs owners and modes")
ROOT = pytest.mark.skipif(getattr(os, "geteuid", lambda: 1)() != 0, reason="only root gives away")
SOMEBODY = 54321


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "outer" / "inner" / "file"
    path.parent.mkdir(parents=True, mode=0o755)
    path.write_text("text")
    path.chmod(0o644)
    return path


def test_own_files_are_safe(file):
    assert writable_by_others(file) == ""
    assert writable_by_others(file.parent / "missing" / "too") == ""


@pytest.mark.parametrize("level", [0, 1, 2])
def test_modes_on_the_way_count(file, level):
    place = [file, *file.parents][level]
    place.chmod(place.stat().st_mode | 0o002)
    reason = writable_by_others(file)
    assert reason.startswith("others can write to the f")
    assert f" {place} (mode 0" in reason


def test_folders_where_others_replace_nothing_are_safe(file):
    file.parent.chmod(0o1777)
    assert writable_by_others(file) == ""


@ROOT
@pytest.mark.parametrize("level", [0, 1, 2])
def test_owners_on_the_way_count(file, level):
    place = [file, *file.parents][level]
    os.chown(place, SOMEBODY, -1)
    assert writable_by_others(file) == f"{place} belongs to another user (number {SOMEBODY})"


@ROOT
def test_groups_count(file):
    os.chown(file, -1, SOMEBODY)
    assert writable_by_others(file) == ""
    file.chmod(0o664)
    assert "others can write to the file" in writable_by_others(file)


def test_links_are_followed(file, tmp_path):
    link = tmp_path / "link"
    link.symlink_to(file.parent.parent, target_is_directory=True)
    relative = tmp_path / "relative"
    relative.symlink_to("outer/../outer/inner")
    for path in (link / "inner" / "file", relative / "file"):
        file.parent.chmod(0o755)
        assert writable_by_others(path) == ""
        file.parent.chmod(0o777)
        assert f"folder {file.parent} " in writable_by_others(path)
    (tmp_path / "round").symlink_to("round")
    assert "loop" in writable_by_others(tmp_path / "round" / "x")


@ROOT
def test_links_of_others_are_not_trusted(file, tmp_path):
    link = tmp_path / "link"
    link.symlink_to(file)
    os.chown(link, SOMEBODY, -1, follow_symlinks=False)
    assert "belongs to another user" in writable_by_others(link)
