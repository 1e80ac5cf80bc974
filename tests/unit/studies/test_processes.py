"""Worker processes of a sweep on this machine: whom they hear, and what their deaths cost."""

import os
import socket
import stat
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from small_study import swept
from sockets import family_of, open_sockets
from test_sweep import same

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.results.store.study_layout import FAILED
from vehicledyn.results.store.study_reader import open_study
from vehicledyn.studies import load_study, processes
from vehicledyn.studies.block import work_of

pytestmark = pytest.mark.long

LINUX = pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="needs Linux's /proc")


@pytest.fixture
def poisoned(monkeypatch):
    monkeypatch.setattr(processes, "_MODULE", "poisoned_worker")
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parent))
    return lambda case: monkeypatch.setenv("POISON", str(case))


@LINUX
def test_the_list_of_sockets_shows_those_there_are(tmp_path):
    with socket.socket() as door, socket.socket(socket.AF_UNIX) as other:
        before = len(open_sockets(os.getpid()))
        door.bind(("127.0.0.1", 0))
        door.listen()
        other.bind(str(tmp_path / "door"))
        other.listen()
        assert len(open_sockets(os.getpid())) == before + 2


@LINUX
def test_nobody_can_connect_to_a_running_sweep(study, tmp_path, needs_compiler):
    """Neither this process nor its workers hold a network socket or listen on any other."""
    own, looks, done = set(open_sockets(os.getpid())), [], threading.Event()

    def look():
        while not done.wait(0.02):
            family = family_of(os.getpid())
            for process in family:
                try:
                    looks.append((len(family), set(open_sockets(process)) - own))
                except OSError:  # it has just ended
                    continue

    watcher = threading.Thread(target=look)
    watcher.start()
    try:
        changes = ["cases.number=200", "duration=1 s"]
        outcome = swept(study, tmp_path / "out.h5", *changes, workers=2, lanes=1)
    finally:
        done.set()
        watcher.join()
    assert outcome.counts["done"] == 200
    assert sum(size >= 3 for size, _ in looks) > 10  # both workers were there while we looked
    assert {line for _, found in looks for line in found} == set()


def test_pipes_of_workers_have_no_names(study):
    work = work_of(load_study(study), lanes=1, backend="interpreted")
    with processes.own_processes(work, 1) as pool:
        (worker,) = pool._workers
        for stream in (worker.process.stdin, worker.process.stdout):
            assert stat.S_ISFIFO(os.fstat(stream.fileno()).st_mode)
            assert str(Path(f"/proc/self/fd/{stream.fileno()}").readlink()).startswith("pipe:[")


def test_two_processes_compute_what_one_does(study, tmp_path):
    alone = swept(study, tmp_path / "alone.h5", workers=1, backend="interpreted")
    both = swept(study, tmp_path / "both.h5", workers=2, backend="interpreted")
    assert (alone.status, both.status) == ("ok", "ok")
    assert "24 cases computed by 2 processes" in both.messages[-1]
    same(alone.path, both.path)


def test_no_more_processes_than_cases(study, tmp_path):
    outcome = swept(study, tmp_path / "o.h5", "cases.number=2", workers=64, backend="interpreted")
    assert "2 cases computed by 2 processes" in outcome.messages[-1]


def test_a_case_that_kills_workers_fails_alone(study, tmp_path, poisoned):
    poisoned(5)
    outcome = swept(study, tmp_path / "out.h5", workers=2, backend="interpreted")
    assert (outcome.counts["done"], outcome.counts["failed"]) == (23, 1)
    (failure,) = outcome.failures
    assert failure[0] == 5
    assert "the worker process died 3 times computing this case" in failure[2]
    assert "6 worker processes ended unexpectedly (signal 9, SIGKILL)" in outcome.messages[0]
    with open_study(outcome.path) as file:
        assert np.flatnonzero(file.case_status() == FAILED).tolist() == [5]


def test_workers_that_cannot_start_end_the_sweep(study, tmp_path, poisoned):
    poisoned("start")
    started = time.monotonic()
    outcome = swept(study, tmp_path / "out.h5", workers=2, backend="interpreted")
    assert time.monotonic() - started < 60.0
    assert outcome.status == "failed"
    assert "worker processes end before they are ready" in outcome.messages[0]
    assert "exit code 1: no such luck" in outcome.messages[0]


def test_another_program_on_a_worker_ends_the_study(study, tmp_path, monkeypatch):
    monkeypatch.setattr("vehicledyn.studies.block.program_fingerprint", lambda: "another")
    with pytest.raises(InputError, match="another vehicledyn"):
        swept(study, tmp_path / "out.h5", workers=2, backend="interpreted")


def test_a_bug_in_a_worker_is_not_taken_for_a_failed_case(study, monkeypatch):
    work = work_of(load_study(study), lanes=1, backend="interpreted")
    with (
        processes.own_processes(work, 1) as pool,
        pytest.raises(RuntimeError, match=r"\w+Error: "),
    ):
        pool.compute(iter([("no", "span")]), print)


def test_no_process_outlives_the_pool(study):
    work = work_of(load_study(study), lanes=1, backend="interpreted")
    with processes.own_processes(work, 2) as pool:
        started = [worker.process for worker in pool._workers]
        assert [process.poll() for process in started] == [None, None]
    assert all(process.poll() is not None for process in started)


def test_errors_of_ours_cross_the_pipe():
    import pickle

    for error in (InputError("in", about=["here"]), NumericalError("no")):
        copy = pickle.loads(pickle.dumps(error))
        assert (type(copy), str(copy), copy.about) == (type(error), str(error), error.about)
