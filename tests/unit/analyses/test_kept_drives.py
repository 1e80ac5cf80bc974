"""Drives of handling tests are known again after a kill, and only to the same car."""

from types import SimpleNamespace

import numpy as np
import pytest

import vehicledyn
from vehicledyn.analyses.handling import test_run
from vehicledyn.analyses.handling.kept_drives import Drive, KeptDrives
from vehicledyn.base.errors import InputError

KEY = bytes(range(32))


def test_a_killed_study_goes_on_with_its_drives(tmp_path):
    drive = Drive(np.array([0.0, 0.1]), np.array([[1.0, np.nan], [3.0, -0.0]]), "overturned")
    with KeptDrives(tmp_path / "y.h5", resume=False) as kept:
        kept.begin("a car")
        assert kept.recall(KEY) is None
        kept.keep(KEY, drive)
    with KeptDrives(tmp_path / "y.h5", resume=True) as kept:
        kept.begin("a car")
        found = kept.recall(KEY)
        assert found.ended_by == "overturned"
        assert found.times.tobytes() == drive.times.tobytes()
        assert found.outputs.tobytes() == drive.outputs.tobytes()
        assert kept.recall(KEY[::-1]) is None
        kept.forget()
    assert not list(tmp_path.iterdir())


def test_a_drive_that_is_known_is_not_driven_again(tmp_path, monkeypatch):
    """It is known by equations, parameters, start and duration."""
    drives, signals = [], SimpleNamespace(of=lambda times, *_: SimpleNamespace(time=times))
    monkeypatch.setattr(test_run, "Signals", signals)

    def driven(*_):
        drives.append(1)
        return Drive(np.array([0.0, 0.1]), np.ones((2, 1)), "")

    def drive(kept, number=1.0, state=0.1, digest="x", duration=0.1):
        kernel = SimpleNamespace(parameters=np.array([number]), set_parameters=lambda _: None)
        car = SimpleNamespace(
            kernel=kernel, digest=digest, channel={"speed": 0}, set=lambda _: None, kept=kept,
            vehicle=SimpleNamespace(chassis="c"),
        )  # fmt: skip
        start = SimpleNamespace(
            state=np.array([state]), unknowns=np.zeros(0), parameters=kernel.parameters
        )
        test = SimpleNamespace(settings_for=lambda _: {})
        assert test_run.drive(car, test, start, duration).end == 0.1

    monkeypatch.setattr(test_run, "_driven", driven)
    for resume in (False, True):
        with KeptDrives(tmp_path / "y.h5", resume=resume) as kept:
            kept.begin("a car")
            drive(kept)
    assert len(drives) == 1
    with KeptDrives(tmp_path / "y.h5", resume=True) as kept:
        kept.begin("a car")
        for other in ({"number": 2.0}, {"state": 0.2}, {"digest": "y"}, {"duration": 0.2}, {}):
            drive(kept, **other)
    assert len(drives) == 5


def test_another_car_is_refused(tmp_path):
    with KeptDrives(tmp_path / "y.h5", resume=False) as kept:
        kept.begin("a car")
    refused = pytest.raises(InputError, match="belongs to another computation")
    with KeptDrives(tmp_path / "y.h5", resume=True) as kept, refused:
        kept.begin("b car")


@pytest.mark.parametrize(
    "data",
    [b"", b"[]\n", b'[2, 1, ""]\n' + bytes(40), b'[null, 1, ""]\n', b"[1, 1, 1]\n\xff"],
)
def test_damaged_drives_are_refused(tmp_path, data):
    with KeptDrives(tmp_path / "y.h5", resume=False) as kept:
        kept.begin("a car")
        kept._checkpoint.put(KEY, data)
        with pytest.raises(InputError, match=r"y\.h5\.checkpoint: is damaged; start again"):
            kept.recall(KEY)


def test_two_studies_do_not_write_one_result(tmp_path):
    refused = pytest.raises(InputError, match="another run is writing")
    with KeptDrives(tmp_path / "y.h5", resume=False), refused:
        KeptDrives(tmp_path / "y.h5", resume=False)


def test_what_goes_on_has_a_result():
    with pytest.raises(InputError, match="resume: name the result that was being written"):
        vehicledyn.handling("small_car", resume=True)
