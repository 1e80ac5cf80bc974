"""Checkpoints: records survive any cut, and belong to one computation."""

import resource
import signal
from contextlib import closing

import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.results.hdf5.checkpoint import Checkpoint, checkpoint_path

RECORDS = {bytes([k]) * 32: bytes([k]) * (100 * k) for k in range(1, 6)}


def written(output):
    with closing(Checkpoint(output, "abc", resume=False)) as made:
        for key, data in RECORDS.items():
            made.put(key, data)
    return checkpoint_path(output)


def test_records_come_back(tmp_path):
    written(tmp_path / "out.h5")
    with closing(Checkpoint(tmp_path / "out.h5", "abc", resume=True)) as again:
        assert {key: again.get(key) for key in RECORDS} == RECORDS
        assert again.get(b"?" * 32) is None and again.is_recalling
        again.put(b"?" * 32, b"new")
        assert again.get(b"?" * 32) == b"new" and not again.is_recalling


@pytest.mark.parametrize("left", [0.1, 0.5, 0.93, 0.999])
def test_a_file_cut_anywhere_keeps_whole_records(tmp_path, left):
    path = written(tmp_path / "out.h5")
    data = path.read_bytes()
    path.write_bytes(data[: int(left * len(data))])
    with closing(Checkpoint(tmp_path / "out.h5", "abc", resume=True)) as again:
        found = {key: again.get(key) for key in RECORDS if again.get(key) is not None}
        assert all(RECORDS[key] == value for key, value in found.items()) and len(found) < len(
            RECORDS
        )
        for key, value in RECORDS.items():
            again.put(key, value)
        assert {key: again.get(key) for key in RECORDS} == RECORDS


def test_a_damaged_record_and_those_behind_it_are_dropped(tmp_path):
    path = written(tmp_path / "out.h5")
    data = bytearray(path.read_bytes())
    data[data.index(b"\3" * 300) + 7] ^= 1
    path.write_bytes(bytes(data))
    with closing(Checkpoint(tmp_path / "out.h5", "abc", resume=True)) as again:
        assert [again.get(key) is not None for key in RECORDS] == [True, True, False, False, False]


def test_another_computation_is_refused_and_a_new_one_begins_anew(tmp_path):
    written(tmp_path / "out.h5")
    with pytest.raises(InputError, match="belongs to another computation"):
        Checkpoint(tmp_path / "out.h5", "abd", resume=True)
    with closing(Checkpoint(tmp_path / "out.h5", "abd", resume=False)) as fresh:
        assert all(fresh.get(key) is None for key in RECORDS)
        fresh.remove()
        assert not checkpoint_path(tmp_path / "out.h5").exists()


def test_a_folder_of_its_name_is_refused(tmp_path):
    checkpoint_path(tmp_path / "out.h5").mkdir()
    with pytest.raises(InputError, match="not a regular file"):
        Checkpoint(tmp_path / "out.h5", "abc", resume=False)


def test_a_full_disk_stops_keeping_only(tmp_path):
    """A limit of the file's size does what a full disk does."""
    made = Checkpoint(tmp_path / "out.h5", "abc", resume=False)
    made.put(b"a" * 32, b"1" * 1000)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, before[1]))
    try:
        made.put(b"b" * 32, b"2" * 5000)
        made.put(b"c" * 32, b"3")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    made.close()
    with closing(Checkpoint(tmp_path / "out.h5", "abc", resume=True)) as again:
        assert again.get(b"a" * 32) == b"1" * 1000 and again.get(b"b" * 32) is None
