import json

import numpy as np
import pytest
from result_files import slalom_values

from vehicledyn.base.errors import InputError
from vehicledyn.results.info import describe_result


def test_a_whole_file(make_result):
    description = describe_result(make_result())
    text = description.as_text()
    assert "PARTIAL" not in text
    for words in ("Nine cones", "iltis (0123456789ab)", "0 to 22 s, 221 samples", "path, loads"):
        assert words in text
    assert "Smallest clearance" in text
    assert "0.25 m" in text
    assert "steps   22000" in text
    load = next(c for c in description.channels if c.name == "wheel_fl.tyre.normal_force")
    values = slalom_values()[1]["wheel_fl.tyre.normal_force"][1]
    assert (load.unit, load.smallest, load.largest) == ("N", values.min(), values.max())


def test_a_partial_file_says_so_first(make_result):
    path = make_result(status="failed", message="loop did not close")
    first = describe_result(path).as_text().splitlines()[0]
    assert first == "PARTIAL RESULT: failed at t = 22 s: loop did not close"


def test_what_a_run_warned_of_is_shown(make_result):
    """A step that is too long was told once, when the run ended."""
    text = describe_result(make_result(notes=["warning: the step is too long"])).as_text()
    assert "\nNotes\n  warning: the step is too long\n" in text
    assert "Notes" not in describe_result(make_result(name="other.h5")).as_text()


def test_it_is_strict_json(make_result):
    time = np.array([0.0, 1.0, 2.0])
    path = make_result(time=time, values={"a": ("m", np.array([1.0, np.nan, 3.0]))})
    found = json.loads(json.dumps(describe_result(path).as_dict(), allow_nan=False))
    assert found["channels"][0]["not_finite"] == 1
    assert (found["channels"][0]["smallest"], found["channels"][0]["largest"]) == (1.0, 3.0)
    assert found["summary"][1]["value"] == 0.25


def test_zero_has_no_sign(make_result):
    path = make_result(time=np.array([0.0, 1.0, 2.0]), values={"a": ("m", np.full(3, -0.0))})
    assert "0 .. 0 " in describe_result(path).as_text()
    assert "-0" not in describe_result(path).as_text().partition("Channels")[2]


def test_a_file_without_samples(make_result):
    path = make_result(time=np.empty(0), values={"a": ("m", np.empty(0))}, status="interrupted")
    description = describe_result(path)
    assert description.channels[0].smallest is None
    assert "no samples" in description.as_text()
    assert "before the first sample" in description.as_text()


def test_a_missing_file(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        describe_result(tmp_path / "none.h5")
