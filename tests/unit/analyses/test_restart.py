"""A run that was broken off goes on from its result, to the bit where the method allows it."""

import shutil
import subprocess
import sys
import zlib
from pathlib import Path

import h5py
import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.analyses.simulation import restart, simulation
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.store import writer
from vehicledyn.results.store.reader import open_result

ROOT = Path(__file__).parents[3]
SYSTEMS = ROOT / "systems"

PLAIN = """\
title: A swing
model: double_pendulum.yaml
duration: 2 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 5 ms, animation: true}
"""
LOOPED = """\
title: A four-bar linkage
model: parallelogram.yaml
duration: 1 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 20 ms}
"""
BALL = """\
title: A ball that jumps and is kicked
bodies:
  ball: {joints: [T1 x, T3 z], mass: 2 kg}
events:
  floor: {when: ball.z, direction: falling, reset: {ball.z_rate: -0.8 * ball.z_rate}}
initial: {ball.z: 0.3 m, ball.x_rate: 1 m/s}
"""
BOUNCING = """\
title: A ball that jumps
model: ball.yaml
duration: 1.5 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""
STIFF = """\
title: A swing
model: double_pendulum.yaml
duration: 1 s
solver: {kind: rosenbrock, relative_tolerance: 1e-8, absolute_tolerance: 1e-8}
output: {interval: 5 ms}
"""
NET = """\
title: Two points on rods
constraint_method: multipliers
bodies:
  near: {at: [1 m, 0, 0], joints: [T1 x, T2 y, T3 z], mass: 1 kg}
  far: {at: [1 m, 1 m, 0], joints: [T1 x, T2 y, T3 z], mass: 2 kg}
cuts:
  first: {kind: rod, a: ground, b: near, length: 1 m}
  second: {kind: rod, a: near, b: far, length: 1 m}
"""
HANGING = """\
title: Two points fall
model: net.yaml
duration: 1 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 9 ms}
"""
ADAPTIVE = STIFF.replace("rosenbrock", "dop853")


def run(folder, text, output, *overrides, restart=None):
    path = folder / "scenario.yaml"
    path.write_text(text, encoding="utf-8")
    (folder / "ball.yaml").write_text(BALL, encoding="utf-8")
    (folder / "net.yaml").write_text(NET, encoding="utf-8")
    for system in ("double_pendulum", "parallelogram"):
        shutil.copy(SYSTEMS / f"{system}.yaml", folder)
    loaded = load_scenario(path, overrides)
    return run_scenario(
        loaded,
        output=folder / output,
        backend="auto",
        progress=lambda *_: None,
        restart=None if restart is None else folder / restart,
    )


def assert_same(first, second, tolerance=0.0):
    with open_result(first) as one, open_result(second) as two:
        assert one.status == two.status == "ok"
        assert one.channels == two.channels
        assert np.array_equal(one.time, two.time)
        for name in one.channels:
            values = one.channel(name).values, two.channel(name).values
            if tolerance:
                assert np.allclose(*values, rtol=tolerance, atol=tolerance), name
            else:
                assert np.array_equal(*values, equal_nan=True), name
        assert one.events == two.events
        assert one.pictures == two.pictures
        if not tolerance:
            assert np.array_equal(one.states.values, two.states.values, equal_nan=True)
            assert one.summary == two.summary


def test_a_run_goes_on_without_the_times_of_its_beginning_in_memory(tmp_path, monkeypatch):
    run(tmp_path, PLAIN, "first.h5", "duration=1 s")
    opened = []

    def noted(path, most=None):
        opened.append(open_result(path, most))
        return opened[-1]

    monkeypatch.setattr(restart, "open_result", noted)
    outcome = run(tmp_path, PLAIN, "second.h5", restart="first.h5")
    assert outcome.status == "ok"
    (known,) = opened
    assert known.samples == 201 and len(known.time) == 2


@pytest.mark.parametrize("text", [PLAIN, LOOPED, BOUNCING, STIFF])
def test_a_run_in_two_pieces_is_that_in_one(tmp_path, text):
    run(tmp_path, text, "whole.h5")
    run(tmp_path, text, "first.h5", "duration=0.4 s")
    outcome = run(tmp_path, text, "second.h5", restart="first.h5")
    assert outcome.status == "ok"
    assert "went on from t = 0.4 s" in " ".join(outcome.messages)
    assert_same(tmp_path / "whole.h5", tmp_path / "second.h5")
    if text == BOUNCING:
        with open_result(tmp_path / "second.h5") as result:
            assert len(result.events) > 3


@pytest.mark.parametrize("method", ["rosenbrock", "cvodes", "idas"])
@pytest.mark.parametrize(("samples", "begin"), [(5, 0.0), (70, 0.32)])
def test_a_chunk_that_the_end_cut_short_is_computed_again(tmp_path, method, samples, begin):
    """Steps lead to the end of a call of the integrator, which a longer run has elsewhere."""
    text = STIFF.replace("rosenbrock", method)
    run(tmp_path, text, "whole.h5")
    run(tmp_path, text, "first.h5", f"duration={5 * samples} ms")
    outcome = run(tmp_path, text, "second.h5", restart="first.h5")
    assert f"went on from t = {begin:g} s" in " ".join(outcome.messages)
    assert_same(tmp_path / "whole.h5", tmp_path / "second.h5")


@pytest.mark.parametrize("text", [LOOPED, STIFF])
def test_histories_of_former_files_are_left_alone(tmp_path, text):
    """They hold other numbers in other places: read as today's, the motion would be wrong."""
    run(tmp_path, text, "whole.h5")
    run(tmp_path, text, "first.h5", "duration=0.4 s")
    with h5py.File(tmp_path / "first.h5", "r+") as file:
        del file["restart/kept"]
    outcome = run(tmp_path, text, "second.h5", restart="first.h5")
    assert "to the accuracy of the method" in " ".join(outcome.messages)
    assert_same(tmp_path / "whole.h5", tmp_path / "second.h5", tolerance=1e-3)


def _without_last(numbers):
    return numbers[:-1]


def _without_any(numbers):
    return numbers[:0]


def _ahead(numbers):
    return np.concatenate([[1e6], numbers[1:]])


def _doubled(numbers):
    return np.concatenate([numbers, numbers])


def _infinite(numbers):
    return np.full_like(numbers, np.inf)


@pytest.mark.long
@pytest.mark.parametrize(
    ("text", "spoil"),
    [
        (PLAIN, _without_last),
        (PLAIN, _ahead),
        (LOOPED, _doubled),
        (LOOPED, _without_any),
        (STIFF, _without_last),
        (STIFF, _ahead),
        (HANGING, _without_any),
        (HANGING, _infinite),
    ],
)
def test_a_history_of_something_else_is_refused(tmp_path, text, spoil):
    """A file with other numbers and the right checksum, which damage would not have."""
    run(tmp_path, text, "first.h5", "duration=0.36 s")
    with h5py.File(tmp_path / "first.h5", "r+") as file:
        rows = file["restart/history"]
        noted = [(k, row) for k, row in enumerate(rows[()]) if np.isfinite(row[0])]
        for k, row in noted:
            numbers = spoil(row[4 : 4 + int(row[1])])[: rows.shape[1] - 4]
            row[1] = len(numbers)
            row[4:] = np.nan
            row[4 : 4 + len(numbers)] = numbers
            rows[k] = row
            file["restart/crc"][k] = zlib.crc32(row.data)
    with pytest.raises(InputError, match="does not belong to it: run without"):
        run(tmp_path, text, "second.h5", "duration=0.72 s", restart="first.h5")


@pytest.mark.parametrize("interval", ["9 ms", "100 ms", "450 ms"])
def test_a_run_with_multipliers_goes_on_from_where_it_was_projected(tmp_path, interval):
    """Put back onto the constraints at other samples, the motion would be another one."""
    sampled = HANGING.replace("9 ms", interval)
    run(tmp_path, sampled, "whole.h5", "duration=1.8 s")
    run(tmp_path, sampled, "first.h5", "duration=0.9 s")
    run(tmp_path, sampled, "second.h5", "duration=1.8 s", restart="first.h5")
    assert_same(tmp_path / "whole.h5", tmp_path / "second.h5")


@pytest.mark.parametrize("constraints", ["reduced", "index3", "stabilised_index2"])
def test_an_implicit_run_with_multipliers_goes_on_with_what_its_steps_carry(tmp_path, constraints):
    text = HANGING.replace("rk4", "generalised_alpha").replace(
        "step: 1 ms", f"step: 1 ms, constraints: {constraints}"
    )
    run(tmp_path, text, "whole.h5", "duration=1.8 s")
    run(tmp_path, text, "first.h5", "duration=0.9 s")
    run(tmp_path, text, "second.h5", "duration=1.8 s", restart="first.h5")
    assert_same(tmp_path / "whole.h5", tmp_path / "second.h5")


@pytest.mark.parametrize("text", [PLAIN, LOOPED, BOUNCING])
def test_a_continued_run_is_judged_as_a_whole(tmp_path, text):
    """The watch of the second piece sees the samples of the first one too."""
    run(tmp_path, text, "whole.h5")
    run(tmp_path, text, "first.h5", "duration=0.4 s")
    run(tmp_path, text, "second.h5", restart="first.h5")
    with open_result(tmp_path / "whole.h5") as one, open_result(tmp_path / "second.h5") as two:
        for name in ("accuracy", "estimated_error", "least_accurate", "accuracy_steps"):
            assert one.solver[name] == two.solver[name], name


def test_what_a_coarser_step_began_stays_inaccurate(tmp_path):
    coarse = ("solver.kind=symplectic_euler", "solver.step=100 ms", "output.interval=100 ms")
    first = run(tmp_path, PLAIN, "first.h5", "duration=1 s", *coarse)
    assert any("the step is too long" in text for text in first.messages)
    fine = ("solver.step=1 ms", "output.interval=100 ms")
    outcome = run(tmp_path, PLAIN, "second.h5", *fine, restart="first.h5")
    (note,) = [text for text in outcome.messages if text.startswith("went on from t = 1 s")]
    assert note.endswith("judged from there on, before it is inaccurate by that result")
    with open_result(tmp_path / "second.h5") as result:
        assert result.solver["accuracy"] == "inaccurate"


def test_an_adaptive_run_goes_on_to_the_accuracy_of_its_method(tmp_path):
    run(tmp_path, ADAPTIVE, "whole.h5")
    run(tmp_path, ADAPTIVE, "first.h5", "duration=0.4 s")
    outcome = run(tmp_path, ADAPTIVE, "second.h5", restart="first.h5")
    assert "to the accuracy of the method" in " ".join(outcome.messages)
    assert_same(tmp_path / "whole.h5", tmp_path / "second.h5", tolerance=1e-5)


KILLED = """
import os, sys
from pathlib import Path
from vehicledyn.results.store import writer
import vehicledyn.catalogue
from vehicledyn.analyses import run_scenario
from vehicledyn.files.scenario import load_scenario
writer.FLUSH_INTERVAL = 0.0
folder, most = Path(sys.argv[1]), int(sys.argv[2])
count = [0]
write = writer.ResultWriter._write
def until(self, *arguments):
    write(self, *arguments)
    count[0] += 1
    if count[0] == most:
        os.kill(os.getpid(), 9)
writer.ResultWriter._write = until
loaded = load_scenario(folder / "scenario.yaml", ["duration=200 s"])
run_scenario(loaded, output=folder / "killed.h5", backend="auto",
             progress=lambda *_: None)
"""


@pytest.mark.parametrize(
    ("text", "most"),
    [
        (PLAIN, 3),
        *(pytest.param(*more, marks=pytest.mark.long) for more in ((LOOPED, 3), (PLAIN, 6))),
        pytest.param(LOOPED, 6, marks=pytest.mark.long),
    ],
)
def test_a_killed_run_goes_on_into_its_own_file(tmp_path, text, most):
    run(tmp_path, text, "short.h5", "duration=0.1 s")  # compiled once
    done = subprocess.run(
        [sys.executable, "-c", KILLED, str(tmp_path), str(most)], check=False, timeout=120.0
    )
    assert done.returncode == -9
    with open_result(tmp_path / "killed.h5") as result:
        assert result.status == "running"
        end = float(result.time[-1])
        begin = result.history(end).time
    duration = f"duration={end + 1.0} s"
    run(tmp_path, text, "whole.h5", duration)
    outcome = run(tmp_path, text, "killed.h5", duration, restart="killed.h5")
    assert f"went on from t = {begin:.9g} s" in " ".join(outcome.messages)
    assert_same(tmp_path / "whole.h5", tmp_path / "killed.h5")
    assert not list(tmp_path.glob(".*.new"))


@pytest.mark.parametrize("text", [PLAIN, STIFF])
def test_a_run_that_is_stopped_as_it_goes_on_can_go_on_again(tmp_path, text, monkeypatch):
    """It holds what the method goes on with from the first moment on."""
    run(tmp_path, text, "whole.h5")
    run(tmp_path, text, "first.h5", "duration=0.4 s")

    def stopped(*_, **__):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(simulation, "simulate_monitored", stopped)
        assert run(tmp_path, text, "second.h5", restart="first.h5").status == "interrupted"
    outcome = run(tmp_path, text, "second.h5", restart="second.h5")
    assert "accuracy of the method" not in " ".join(outcome.messages)
    assert_same(tmp_path / "whole.h5", tmp_path / "second.h5")


@pytest.mark.parametrize("text", [PLAIN, LOOPED])
def test_a_run_that_was_killed_at_its_very_end_is_completed(tmp_path, text, monkeypatch):
    run(tmp_path, text, "whole.h5", "duration=0.4 s")

    def killed(_run, results):
        results.flush()
        raise Killed

    with monkeypatch.context() as patched:
        patched.setattr(simulation._Run, "_summarise", killed)
        patched.setattr(writer.ResultWriter, "__exit__", lambda self, *_: self._release())
        with pytest.raises(Killed):
            run(tmp_path, text, "left.h5", "duration=0.4 s")
    run(tmp_path, text, "left.h5", "duration=0.4 s", restart="left.h5")
    assert_same(tmp_path / "whole.h5", tmp_path / "left.h5", tolerance=1e-12)


class Killed(BaseException):
    pass


def test_a_broken_off_run_that_is_longer_than_the_one_to_come_is_refused(tmp_path):
    """No step is left to go, nor less than none."""
    run(tmp_path, PLAIN, "first.h5", "duration=0.3 s")
    with h5py.File(tmp_path / "first.h5", "r+") as file:
        file.attrs["status"] = "running"
    with pytest.raises(InputError, match=r"reaches t = 0.3 s already"):
        run(tmp_path, PLAIN, "second.h5", "duration=0.2 s", restart="first.h5")


def test_channels_that_are_not_kept_count_for_the_summary(tmp_path):
    text = PLAIN.replace("animation: true", "animation: true, channels: [upper.*]")
    run(tmp_path, text, "whole.h5")
    run(tmp_path, text, "first.h5", "duration=0.4 s")
    run(tmp_path, text, "second.h5", restart="first.h5")
    with open_result(tmp_path / "whole.h5") as one, open_result(tmp_path / "second.h5") as two:
        assert one.summary.keys() == two.summary.keys()
        for name, entry in one.summary.items():
            assert two.summary[name].value == pytest.approx(entry.value, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["parameters.length=2 m"], "another parameters"),
        (["output.interval=10 ms"], "not sampled every 0.01 s"),
        (["output.channels=[upper.*]"], "other channels"),
        (["duration=0.2 s"], "reaches t = 0.2 s already; to go on, give a longer duration"),
    ],
)
def test_what_does_not_fit_is_refused_and_left_alone(tmp_path, overrides, message):
    run(tmp_path, PLAIN, "first.h5", "duration=0.2 s")
    before = (tmp_path / "first.h5").read_bytes()
    with pytest.raises(InputError, match=message):
        run(tmp_path, PLAIN, "first.h5", *overrides, restart="first.h5")
    assert (tmp_path / "first.h5").read_bytes() == before


def test_another_model_is_refused(tmp_path):
    run(tmp_path, PLAIN, "first.h5", "duration=0.2 s")
    with pytest.raises(InputError, match="its scenario has another model"):
        run(tmp_path, LOOPED, "second.h5", restart="first.h5")
    assert not (tmp_path / "second.h5").exists()
