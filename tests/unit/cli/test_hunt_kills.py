"""Hunting studies that are killed: what is left is readable, and is gone on with."""

import contextlib
import os
import signal
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from programs import call, run, started

from vehicledyn.results.hdf5.checkpoint import checkpoint_path
from vehicledyn.results.tables.hunt_table import read_hunt

pytestmark = pytest.mark.long

SYSTEM = Path(__file__).parent / "self_excited.yaml"
OPTIONS = ["--parameter", "gain", "--from", "-1 N*s/m", "--to", "2 N*s/m", "--points", "60",
           "--no-plots", "--quiet"]  # fmt: skip


def command(output, *more):
    return ["vehicledyn", "hunt", SYSTEM, *OPTIONS, "-o", output, *more]


def wait_until(process, happened):
    """Wait until something has happened or the process has ended; return whether it runs."""
    while process.poll() is None and not happened():
        time.sleep(0.02)
    return process.poll() is None


def stopped(process, how):
    process.send_signal(how)
    process.wait()


def size_of(output):
    with contextlib.suppress(FileNotFoundError):
        return checkpoint_path(output).stat().st_size
    return 0


def arrays(path):
    with h5py.File(path) as file:
        return {name: file[name][()] for name in file}


def same(first, second):
    return first.keys() == second.keys() and all(
        np.array_equal(first[k], second[k], equal_nan=first[k].dtype.kind == "f") for k in first
    )


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The study without any kill."""
    output = tmp_path_factory.mktemp("whole") / "hunt.h5"
    run(command(output), output.parent)
    assert not checkpoint_path(output).exists()
    return output


def test_a_study_killed_again_and_again_finds_the_same(tmp_path, whole):
    output, killed, found = tmp_path / "hunt.h5", 0, [0]
    for _ in range(4):
        before = size_of(output)
        process = started(command(output, "--resume"), tmp_path)
        if not wait_until(process, lambda before=before: size_of(output) > before + 60_000):
            break
        stopped(process, signal.SIGKILL)
        killed += 1
        if output.exists():
            table = read_hunt(output)
            assert table.status == "interrupted" and "resume" in table.message
            found.append(len(table.cycles))
    assert killed >= 2 and found[-1] > 0 and found == sorted(found)
    run(command(output, "--resume"), tmp_path)
    assert read_hunt(output).status == "ok"
    assert same(arrays(output), arrays(whole))
    assert read_hunt(output).figures == read_hunt(whole).figures
    left = {path.name for path in tmp_path.iterdir() if not path.name.endswith(".lock")}
    assert left == {"hunt.h5"}


def test_interrupted_studies_go_on(tmp_path, whole):
    output = tmp_path / "hunt.h5"
    process = started(command(output), tmp_path)
    assert wait_until(process, lambda: size_of(output) > 100_000)
    stopped(process, signal.SIGINT)
    assert process.returncode == 130
    table = read_hunt(output)
    assert table.status == "interrupted" and table.cycles
    run(command(output, "--resume"), tmp_path)
    assert same(arrays(output), arrays(whole))


def test_a_finished_study_is_not_computed_again(tmp_path, whole):
    output = tmp_path / "hunt.h5"
    os.link(whole, output)
    begun = output.stat().st_mtime_ns
    loud = [word for word in command(output, "--resume") if word != "--quiet"]
    done = call(loud, tmp_path)
    assert done.returncode == 0
    assert "is finished" in done.stderr and output.stat().st_mtime_ns == begun


def test_another_study_is_not_gone_on_with(tmp_path, whole):
    output = tmp_path / "hunt.h5"
    os.link(whole, output)
    done = call(command(output, "--resume", "--set", "parameters.stiffness=90 N/m"), tmp_path)
    assert done.returncode == 2 and "holds another study" in done.stderr
    assert "Traceback" not in done.stderr
