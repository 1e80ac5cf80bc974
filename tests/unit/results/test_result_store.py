import json
import os
import signal
import subprocess
import sys
import time as clock
from pathlib import Path

import h5py
import numpy as np
import pytest
from result_files import Quantity, header, slalom_values

from vehicledyn.base.errors import InputError
from vehicledyn.results.hdf5 import journal
from vehicledyn.results.hdf5.output import OutputLock, check_output
from vehicledyn.results.store import writer as writer_module
from vehicledyn.results.store.layout import EventRecord, SummaryEntry
from vehicledyn.results.store.reader import open_result
from vehicledyn.results.store.writer import ResultWriter

CHANNEL = [Quantity("body.x", "m", "Position", "ground")]

WRITE_UNTIL_KILLED = """
import sys, time, numpy as np
from vehicledyn.results.store import writer
from vehicledyn.results.store.layout import ResultHeader
from types import SimpleNamespace
writer.FLUSH_INTERVAL = 0.0
about = {"unit": "m", "description": "x", "frame": ""}
names = [SimpleNamespace(name=f"part_{k}.x", **about) for k in range(30)]
w = writer.ResultWriter(sys.argv[1], channels=names, header=ResultHeader("Killed", "none"))
for step in range(1_000_000):
    t = np.arange(step * 10, step * 10 + 10) * 1e-3
    w.append(t, np.tile(t[:, None], (1, 30)))
    if step == 5:
        print("ready", flush=True)
"""

WRITE_UNTIL_FULL = """
import resource, sys, numpy as np
from types import SimpleNamespace
from vehicledyn.base.errors import InputError
from vehicledyn.results.store.layout import ResultHeader
from vehicledyn.results.store.writer import ResultWriter
limit = int(sys.argv[2])
resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
about = {"unit": "m", "description": "x", "frame": ""}
names = [SimpleNamespace(name=f"part_{k}.x", **about) for k in range(30)]
try:
    with ResultWriter(sys.argv[1], channels=names, header=ResultHeader("Full", "none"),
                      expected_samples=100) as w:
        for step in range(10000):
            t = np.arange(step * 100, step * 100 + 100) * 1e-3
            w.append(t, np.tile(t[:, None], (1, 30)))
except InputError as error:
    print(error)
"""


def start_writer(path):
    process = subprocess.Popen(
        [sys.executable, "-c", WRITE_UNTIL_KILLED, str(path)], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "ready\n"
    return process


def end(process):
    process.kill()
    process.wait()
    process.stdout.close()


def test_everything_written_is_read_back(make_result):
    time, values = slalom_values()
    with open_result(make_result()) as result:
        assert result.channels == tuple(values)
        assert np.array_equal(result.time, time)
        for name, (unit, column) in values.items():
            series = result.channel(name)
            assert np.array_equal(series.values, column)
            assert (series.unit, series.frame) == (unit, "ground")
        assert result.states.names == ("chassis.x", "chassis.vx")
        assert result.states.units == ("m", "m/s")
        assert np.array_equal(result.states.values[:, 1], time + 1.0)
        assert result.scenario_text == "title: Nine cones  # µ\n"
        assert result.configuration == {"model": "iltis", "speed": 10.0}
        assert result.solver == {"method": "rk4", "step": 1e-3, "steps": 22000, "warm": 1}
        assert result.summary["cones.clearance"].value == 0.25
        assert result.summary["cones.clean"].value is True
        assert result.summary["driver"].value == "preview"
        assert list(result.summary) == [
            "cones.cleared",
            "cones.clearance",
            "cones.clean",
            "driver",
        ]
        assert set(result.scene) == {"cones", "outline"}
        assert result.scene["cones"].attributes == {"radius": 0.15}
        assert (result.status, result.is_whole, result.state_of_run) == ("ok", True, "complete")
        assert [plot["name"] for plot in result.plots] == ["path", "loads"]


def test_layout_is_netcdf_compatible(make_result):
    with h5py.File(make_result(), "r") as file:
        channel = file["wheel_fl/tyre/normal_force"]
        assert channel.dims[0][0].name == "/time"
        assert channel.attrs["units"] == "N"
        assert channel.attrs["long_name"] == "Some quantity"
        unscaled = []
        file.visititems(
            lambda name, item: (
                unscaled.append(name)
                if isinstance(item, h5py.Dataset)
                and not item.is_scale
                and any(len(dimension) == 0 for dimension in item.dims)
                else None
            )
        )
        assert unscaled == []


def test_frame_holds_all_channels(make_result):
    with open_result(make_result()) as result:
        frame = result.as_frame()
        assert list(frame.columns) == list(result.channels)
        assert frame.index.name == "time"
        assert np.array_equal(frame["chassis.roll"], result.channel("chassis.roll").values)


def test_samples_may_come_in_any_portions(tmp_path, monkeypatch):
    monkeypatch.setattr(writer_module, "FLUSH_INTERVAL", 0.0)
    with ResultWriter(
        tmp_path / "a.h5", channels=CHANNEL, header=header(), expected_samples=7
    ) as writer:
        start = 0
        for size in (1, 0, 5, 20, 3):
            time = np.arange(start, start + size) * 0.1
            writer.append(time, 2.0 * time[:, None])
            start += size
    with open_result(tmp_path / "a.h5") as result:
        assert np.array_equal(result.time, np.arange(29) * 0.1)
        assert np.array_equal(result.channel("body.x").values, 2.0 * result.time)


def test_arrays_may_have_any_order_in_memory(tmp_path):
    time = np.arange(5) * 0.1
    states = np.asfortranarray(np.column_stack([time, -time]))
    quantities = [Quantity("body.x", "m"), Quantity("body.vx", "m/s")]
    with ResultWriter(
        tmp_path / "a.h5", channels=CHANNEL, states=quantities, header=header()
    ) as writer:
        writer.append(time, np.asfortranarray(time[:, None]), states)
    with open_result(tmp_path / "a.h5") as result:
        assert np.array_equal(result.states.values, states)


def test_equal_runs_give_equal_datasets(make_result):
    def datasets(path):
        found = {}
        with h5py.File(path, "r") as file:
            file.visititems(
                lambda name, item: (
                    found.update({name: np.asarray(item[()]).tobytes()})
                    if isinstance(item, h5py.Dataset) and item.dtype.kind != "O"
                    else None
                )
            )
        return found

    assert datasets(make_result("a.h5")) == datasets(make_result("b.h5"))


def test_events_are_kept_in_order(tmp_path):
    events = (EventRecord(0.5, "lift_off"), EventRecord(0.75, "touch_down"))
    writer = ResultWriter(tmp_path / "a.h5", channels=CHANNEL, header=header())
    writer.append(np.array([0.0, 1.0]), np.zeros((2, 1)))
    writer.close(events=events)
    with open_result(tmp_path / "a.h5") as result:
        assert result.events == events


def test_no_states_and_no_summary_are_fine(tmp_path):
    with ResultWriter(tmp_path / "a.h5", channels=CHANNEL, header=header()) as writer:
        writer.append(np.array([0.0]), np.zeros((1, 1)))
    with open_result(tmp_path / "a.h5") as result:
        assert result.states.values.shape == (1, 0)
        assert (result.summary, result.events, result.solver) == ({}, (), {})


@pytest.mark.parametrize(
    ("error", "status", "message"),
    [
        (RuntimeError("loop 'rear left' did not close"), "failed", "loop 'rear left'"),
        (KeyboardInterrupt(), "interrupted", "stopped by the user"),
    ],
)
def test_an_error_inside_leaves_a_partial_result(tmp_path, error, status, message):
    with (
        pytest.raises(type(error)),
        ResultWriter(tmp_path / "a.h5", channels=CHANNEL, header=header()) as writer,
    ):
        writer.append(np.array([0.0, 1.5]), np.zeros((2, 1)))
        raise error
    with open_result(tmp_path / "a.h5") as result:
        assert result.status == status
        assert not result.is_whole
        assert message in result.status_message
        assert f"partial: {status} at t = 1.5 s" in result.state_of_run


def test_a_killed_run_is_readable_and_partial(tmp_path):
    path = tmp_path / "killed.h5"
    process = start_writer(path)
    process.send_signal(signal.SIGKILL)
    end(process)
    with open_result(path) as result:
        assert result.status == "running"
        assert not result.is_whole
        assert "broken off" in result.state_of_run
        assert len(result.time) >= 50
        for name in result.channels:
            assert np.array_equal(result.channel(name).values, result.time)


def test_a_result_is_readable_while_it_is_written(tmp_path):
    path = tmp_path / "live.h5"
    process = start_writer(path)
    try:
        lengths = []
        for _ in range(3):
            with open_result(path) as result:
                assert "still running" in result.state_of_run
                assert np.array_equal(result.channel("part_7.x").values, result.time)
                lengths.append(len(result.time))
            clock.sleep(0.1)
        assert lengths[0] < lengths[-1]
        with h5py.File(path, "r", swmr=True) as file:  # as any other HDF5 program would
            assert len(file["time"]) >= lengths[-1]
    finally:
        end(process)


def test_two_runs_cannot_write_one_file(tmp_path, make_result):
    path = tmp_path / "live.h5"
    process = start_writer(path)
    try:
        with pytest.raises(InputError, match="another run is writing"):
            check_output(path)
        with pytest.raises(InputError, match="another run is writing"):
            ResultWriter(path, channels=CHANNEL, header=header())
        with open_result(path) as result:
            assert result.title == "Killed"
    finally:
        end(process)
    assert make_result("live.h5") == path  # the lock went with the process
    assert [entry.name for entry in tmp_path.iterdir()] == ["live.h5"]


def test_of_two_runs_that_start_together_one_is_refused(tmp_path):
    lock = OutputLock(tmp_path / "a.h5")
    with pytest.raises(InputError, match="another run is writing"):
        OutputLock(tmp_path / "a.h5")
    lock.release()
    OutputLock(tmp_path / "a.h5").release()
    assert list(tmp_path.iterdir()) == []


def test_an_older_result_is_replaced_at_once(make_result):
    path = make_result()
    with open_result(path) as older:
        writer = ResultWriter(path, channels=CHANNEL, header=header(title="New"))
        with open_result(path) as result:
            assert (result.title, result.status) == ("New", "running")
            assert "before the first sample" in result.state_of_run
        assert np.isfinite(older.channel("chassis.x").values).all()
        writer.close()


@pytest.mark.parametrize("limit", [3_000, 20_000, 26_000, 60_000, 90_000, 400_000])
def test_a_full_disk_is_one_message_and_a_partial_result(tmp_path, limit):
    path = tmp_path / "full.h5"
    done = subprocess.run(
        [sys.executable, "-c", WRITE_UNTIL_FULL, str(path), str(limit)],
        capture_output=True,
        text=True,
        check=False,
        timeout=60.0,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("\n") == 1
    assert "cannot be written" in done.stdout
    assert "free some space" in done.stdout
    if path.exists():
        with open_result(path) as result:
            assert not result.is_whole
            for name in result.channels:
                assert np.array_equal(result.channel(name).values, result.time)
    else:
        assert limit < 60_000


def test_ctrl_c_waits_until_the_file_is_consistent(tmp_path, monkeypatch):
    extend = writer_module.sections.extend

    def interrupted(*arguments):
        signal.raise_signal(signal.SIGINT)
        extend(*arguments)

    path = tmp_path / "a.h5"
    with (
        pytest.raises(KeyboardInterrupt),
        ResultWriter(path, channels=CHANNEL, header=header(), expected_samples=1) as writer,
    ):
        monkeypatch.setattr(writer_module.sections, "extend", interrupted)
        writer.append(np.array([0.0, 1.0]), np.ones((2, 1)))
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    with open_result(path) as result:
        assert result.status == "interrupted"
        assert np.array_equal(result.channel("body.x").values, [1.0, 1.0])


def test_a_failed_close_keeps_the_samples(tmp_path, monkeypatch):
    def full(*_args):
        raise OSError(28, "No space left on device")

    writer = ResultWriter(tmp_path / "a.h5", channels=CHANNEL, header=header())
    writer.append(np.array([0.0, 1.0]), np.zeros((2, 1)))
    monkeypatch.setattr(journal, "_packed", full)
    with pytest.raises(InputError, match="No space left on device; free some space"):
        writer.close()
    with open_result(tmp_path / "a.h5") as result:
        assert len(result.time) == 2
        assert not result.is_whole
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.h5"]


def test_outputs_that_cannot_be(tmp_path):
    (tmp_path / "file").write_text("")
    for path, message in (
        (tmp_path, "is a folder"),
        (tmp_path / "missing" / "a.h5", "does not exist"),
        (tmp_path / "file" / "a.h5", "does not exist"),
        (Path(os.devnull), "not a regular file"),
    ):
        with pytest.raises(InputError, match=message):
            check_output(path)
        with pytest.raises(InputError, match=message):
            ResultWriter(path, channels=CHANNEL, header=header())


def test_a_file_that_is_no_result_is_never_replaced(tmp_path, make_result):
    scenario, result, empty = tmp_path / "ramp.yaml", make_result(), tmp_path / "empty.h5"
    scenario.write_text("title: Do not lose me")
    empty.touch()
    with pytest.raises(InputError, match="exists and is no HDF5 file, so it is kept"):
        check_output(scenario)
    assert check_output(result) == result
    assert check_output(empty) == empty


@pytest.mark.skipif(os.geteuid() == 0, reason="the administrator may write anywhere")
def test_a_folder_without_permission(tmp_path):
    folder = tmp_path / "locked"
    folder.mkdir(mode=0o500)
    with pytest.raises(InputError, match="no permission"):
        check_output(folder / "a.h5")


def test_permissions_are_asked_for(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(InputError, match="no permission to write"):
        check_output(tmp_path / "a.h5")


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["a.b", "a.b"], "defined twice"),
        (["a", "a.b"], "also the name of a part"),
        (["summary.x"], "reserved"),
        (["a..b"], "words joined by dots"),
        (["a/b"], "words joined by dots"),
    ],
)
def test_channel_names_that_cannot_lie_in_one_file(tmp_path, names, message):
    with pytest.raises(InputError, match=message):
        ResultWriter(
            tmp_path / "a.h5", channels=[Quantity(name, "m") for name in names], header=header()
        )


def test_wrong_samples_are_refused(tmp_path):
    with ResultWriter(tmp_path / "a.h5", channels=CHANNEL, header=header()) as writer:
        with pytest.raises(ValueError, match="shape"):
            writer.append(np.zeros(2), np.zeros((2, 2)))
        with pytest.raises(ValueError, match="backwards"):
            writer.append(np.array([1.0, 0.0]), np.zeros((2, 1)))
        with pytest.raises(ValueError, match="no final status"):
            writer.close("running")
    with pytest.raises(ValueError, match="closed"):
        writer.append(np.zeros(1), np.zeros((1, 1)))


def test_texts_that_hdf5_cannot_hold_are_escaped(tmp_path):
    with ResultWriter(
        tmp_path / "a.h5", channels=CHANNEL, header=header(scenario_text="a\0b\udc80")
    ) as writer:
        writer.close("failed", "x\0y", summary=[SummaryEntry("note", "p\0q", "1", "Note")])
    with open_result(tmp_path / "a.h5") as result:
        assert result.scenario_text == "a\\0b\\udc80"
        assert result.status_message == "x\\0y"
        assert result.summary["note"].value == "p\\0q"


def test_unreadable_files(tmp_path, make_result):
    good = make_result().read_bytes()
    files = {
        "empty.h5": (b"", "not an HDF5 file"),
        "text.h5": (b"t,x\n0,1\n", "not an HDF5 file"),
        "cut.h5": (good[: len(good) // 2], "damaged"),
        "start.h5": (good[:20], "damaged"),
        "hole.h5": (good[:48] + bytes(2000) + good[2048:], "damaged"),
    }
    for name, (content, message) in files.items():
        (tmp_path / name).write_bytes(content)
        with pytest.raises(InputError, match=message):
            open_result(tmp_path / name)
    with pytest.raises(InputError, match="no such file"):
        open_result(tmp_path / "none.h5")
    with pytest.raises(InputError, match="this is a folder"):
        open_result(tmp_path)


def test_other_formats(make_result, tmp_path):
    path = make_result()
    with h5py.File(path, "r+") as file:
        file.attrs["format_version"] = 2
    with pytest.raises(InputError, match=r"format version 2.*update vehicledyn"):
        open_result(path)
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1.0
    with pytest.raises(InputError, match="not a result of this program"):
        open_result(tmp_path / "other.h5")


def test_missing_and_short_channels_are_damage(make_result):
    path = make_result("short.h5")
    with h5py.File(path, "r+") as file:
        file["chassis/x"].resize((7,))
    with pytest.raises(InputError, match=r"7 samples of chassis\.x"):
        open_result(path)
    path = make_result("missing.h5")
    with h5py.File(path, "r+") as file:
        del file["chassis/x"]
    with pytest.raises(InputError, match="damaged"):
        open_result(path)


@pytest.mark.parametrize("wrong", [np.nan, -1.0, np.inf])
def test_times_that_do_not_rise_are_damage(make_result, wrong):
    path = make_result("times.h5")
    with h5py.File(path, "r+") as file:
        del file["checksums"]
        file["time"][3] = wrong
    told = r"its time number (4|5) is .* does not follow the one before; run it again"
    with pytest.raises(InputError, match=told):
        open_result(path)


def test_an_unknown_channel_gets_the_nearest_name(make_result):
    with (
        open_result(make_result()) as result,
        pytest.raises(InputError, match="did you mean 'chassis"),
    ):
        result.channel("chasis.roll")


def test_configuration_is_json(make_result):
    with h5py.File(make_result(), "r") as file:
        text = file["scenario/configuration"].asstr()[()]
    assert json.loads(text)["speed"] == 10.0
