import h5py
import pytest

from vehicledyn.results.hdf5.superblock import (
    SIZE,
    is_open_with_readers,
    lookup3,
    with_writing_flag,
)


@pytest.mark.parametrize(
    ("text", "checksum"),
    [(b"", 0xDEADBEEF), (b"Four score and seven years ago", 0x17770551)],
)
def test_the_checksum_agrees_with_its_author(text, checksum):
    """Vectors printed by driver5 of Jenkins' lookup3.c."""
    assert lookup3(text) == checksum


def test_the_checksum_agrees_with_hdf5(tmp_path):
    path = tmp_path / "a.h5"
    with h5py.File(path, "w", libver=("v110", "v110")) as file:
        file["x"] = 1.0
    start = path.read_bytes()[:SIZE]
    assert lookup3(start[:44]) == int.from_bytes(start[44:], "little")
    assert not is_open_with_readers(start)


def test_our_flag_equals_that_of_hdf5(tmp_path):
    path = tmp_path / "a.h5"
    with h5py.File(path, "w", libver=("v110", "v110")) as file:
        file.swmr_mode = True
        start = path.read_bytes()[:SIZE]
        assert is_open_with_readers(start)
        assert with_writing_flag(start) == start
        cleared = bytearray(start)
        cleared[11] = 0x04
        assert with_writing_flag(bytes(cleared)) == start
