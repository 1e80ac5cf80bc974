"""Files are whole or absent; what errors and kills leave of them goes again."""

import multiprocessing
import os
import signal

import pytest

from vehicledyn.base.files.whole_file import folder_for_files, whole_file, write_whole


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


def hidden(folder):
    return [path for path in folder.iterdir() if path.name.startswith(".")]


def started(target, *, begun):
    """Start a process that writes half a file and waits."""

    def write():
        with whole_file(target) as place:
            place.write_text("half", encoding="utf-8")
            begun.send(None)
            signal.pause()

    context = multiprocessing.get_context("fork")
    process = context.Process(target=write)
    process.start()
    return process


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs POSIX processes")
@pytest.mark.parametrize("name", ["page.html", "no suffix", "n" * 250 + ".csv"])
def test_what_a_killed_process_has_left_is_removed_by_the_next_of_the_file(tmp_path, name):
    """But not what living processes write, whatever numbers these have, nor that of other files."""
    told, begun = multiprocessing.Pipe(duplex=False)
    target, other = tmp_path / name, tmp_path / "other.csv"
    processes = [started(place, begun=begun) for place in (target, target, other)]
    for _ in processes:
        told.recv()
    killed, living, beside = processes
    try:
        for process in (killed, beside):
            process.kill()
            process.join()
        left = hidden(tmp_path)
        assert len(left) == 3
        # A living process may have the number of the one that was killed.
        mine = [path for path in left if f".{killed.pid}-" in path.name]
        renamed = mine[0].with_name(mine[0].name.replace(f"{killed.pid}-", f"{os.getpid()}-"))
        mine[0].rename(renamed)
        write_whole(target, "whole")
        numbers = {path.name.split(".")[2].split("-")[0] for path in hidden(tmp_path)}
        assert numbers == {str(living.pid), str(beside.pid)}
        write_whole(other, "whole")
        assert len(hidden(tmp_path)) == 1
    finally:
        living.kill()
        living.join()
    write_whole(target, "whole")
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([name, "other.csv"])


def test_an_error_leaves_nothing_and_the_old_file(tmp_path):
    write_whole(tmp_path / "a.txt", "old")
    with pytest.raises(ValueError, match="no"), whole_file(tmp_path / "a.txt") as place:
        place.write_text("new", encoding="utf-8")
        raise ValueError("no")
    assert [path.read_text() for path in tmp_path.iterdir()] == ["old"]
