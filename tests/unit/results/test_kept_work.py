"""What a computation keeps beside its output: known again after a kill, and only to the same."""

from dataclasses import dataclass

import numpy as np
import pytest

import vehicledyn
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.interface.running import result_place
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.hdf5.output import OutputLock, is_being_written


@dataclass(frozen=True)
class Found:
    """A result of a step."""

    values: np.ndarray
    words: str


FOUND = Found(np.array([[1.0, np.nan], [3.0, -0.0]]), "overturned")


def unexpected():
    raise AssertionError("computed again")


def failing():
    raise NumericalError("no turn")


def test_steps_are_recalled_to_the_last_bit(tmp_path):
    with KeptWork(tmp_path / "y.h5") as kept:
        memory = kept.memory("a car", 1.5, kinds=(Found,))
        assert not list(tmp_path.glob("*.checkpoint"))  # nothing is kept yet
        memory.recall("step", (1, FOUND), lambda: FOUND)
        memory.recall("step", 2, lambda: {"values": [1.0, None], "words": "x"})
        with pytest.raises(NumericalError, match="no turn"):
            memory.recall_or_raise("turn", 1, failing)
    with KeptWork(tmp_path / "y.h5", resume=True) as kept:
        memory = kept.memory("a car", 1.5, kinds=(Found,))
        assert memory.n_known == 3 and kept.is_recalling
        found = memory.recall("step", (1, FOUND), unexpected)
        assert found.values.tobytes() == FOUND.values.tobytes()
        assert found.words == FOUND.words
        assert memory.recall("step", 2, unexpected) == {"values": [1.0, None], "words": "x"}
        with pytest.raises(NumericalError, match="no turn"):
            memory.recall_or_raise("turn", 1, unexpected)
        with pytest.raises(AssertionError):
            memory.recall("step", (2, FOUND), unexpected)
        kept.finish()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("data", [b"", b"\1\0\0\0[", b'\x0d\0\0\0{"tuple": 1}x', bytes(40)])
def test_what_cannot_be_read_is_computed_again(tmp_path, data):
    with KeptWork(tmp_path / "y.h5") as kept:
        memory = kept.memory("a car")
        memory.recall("step", 1, lambda: 5)
        (key,) = kept._checkpoint._places
        kept._checkpoint.put(key, data)
        assert memory.recall("step", 1, lambda: 5) == 5


@pytest.mark.parametrize("facts", [("b car", 1.5), ("a car", np.nextafter(1.5, 2.0)), ("a car",)])
def test_another_computation_is_refused(tmp_path, facts):
    with KeptWork(tmp_path / "y.h5") as kept:
        kept.memory("a car", 1.5).recall("step", 1, lambda: 2)
    refused = pytest.raises(InputError, match="belongs to another computation")
    with KeptWork(tmp_path / "y.h5", resume=True) as kept, refused:
        kept.memory(*facts)


def test_another_version_is_refused(tmp_path, monkeypatch):
    with KeptWork(tmp_path / "y.h5") as kept:
        kept.memory("a car").recall("step", 1, lambda: 2)
    monkeypatch.setattr("vehicledyn.results.hdf5.kept_work.VERSION", "another")
    refused = pytest.raises(InputError, match="version of the program")
    with KeptWork(tmp_path / "y.h5", resume=True) as kept, refused:
        kept.memory("a car")


def test_two_computations_do_not_write_one_result(tmp_path):
    refused = pytest.raises(InputError, match="another run is writing")
    with KeptWork(tmp_path / "y.h5"), refused:
        KeptWork(tmp_path / "y.h5")


def test_the_lock_is_lent_to_one_writer_at_a_time(tmp_path):
    path = tmp_path / "y.h5"
    with KeptWork(path):
        assert not is_being_written(path)
        lock = OutputLock(path)
        assert is_being_written(path)
        with pytest.raises(InputError, match="another run is writing"):
            OutputLock(path)
        lock.release()
        OutputLock(path).release()
    assert not list(tmp_path.iterdir())


def test_disks_without_locks_can_be_written(tmp_path, monkeypatch):
    def flock(*_):
        raise OSError(37, "No locks available")

    monkeypatch.setattr("vehicledyn.results.hdf5.output.fcntl.flock", flock)
    with KeptWork(tmp_path / "y.h5"):
        assert not is_being_written(tmp_path / "y.h5")
    assert not list(tmp_path.iterdir())


def test_what_fails_for_good_leaves_nothing_to_go_on_with(tmp_path):
    for error, left in ((NumericalError("no"), 0), (KeyboardInterrupt(), 1)):
        with pytest.raises(type(error)), result_place(tmp_path / "y.h5") as place:
            place.kept.memory("a car").recall("step", 1, lambda: 2)
            raise error
        assert len(list(tmp_path.iterdir())) == left


def test_what_goes_on_has_a_result():
    with pytest.raises(InputError, match="resume: name the result that was being written"):
        vehicledyn.handling("small_car", resume=True)
