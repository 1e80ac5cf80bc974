"""Sweeps by several processes, stopped and killed in all ways: nothing is lost."""

import contextlib
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from programs import run
from small_study import STUDY, command, environment, swept, written
from test_sweep import same

import vehicledyn
from vehicledyn.results.store.study_reader import open_study

pytestmark = pytest.mark.long

LONG = STUDY.replace("duration: 0.2 s", "duration: 20 s").replace("number: 24", "number: 160")
LONG = LONG.replace("interval: 20 ms", "interval: 1 s").replace("seed: 5", "seed: 5\n  # long")
PATIENCE = 120.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory, needs_compiler):
    place = tmp_path_factory.mktemp("long")
    shutil.copytree(Path(vehicledyn.__file__).parent, place / "vehicledyn")
    swept(written(place, LONG, "long.yaml"), place / "whole.h5")
    return place


def start(folder, *words):
    words = [sys.executable, "-m", "vehicledyn", "sweep", "long.yaml", "-v", "--lanes", "1", *words]
    return subprocess.Popen(
        words, cwd=folder, env=environment(folder), stderr=subprocess.PIPE, stdout=subprocess.PIPE,
        text=True, start_new_session=True,
    )  # fmt: skip


def await_cases(process):
    """Wait until some cases are done."""
    told = []
    for line in process.stderr:
        told.append(line)
        if re.match(r"computing: [1-9]", line):
            return
    raise AssertionError("".join(told))


def kept(path):
    with open_study(path) as file:
        counts = file.counts()
        return counts["done"], file.status, file.state


def finish(folder, name, *words):
    run(["vehicledyn", "sweep", "long.yaml", "-o", name, "--resume", *words], folder)
    same(folder / "whole.h5", folder / name)


def end(process):
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.communicate()


def children_of(process):
    listed = subprocess.run(
        ["ps", "-o", "pid=", "--ppid", str(process.pid)],
        capture_output=True,
        text=True,
        check=False,
    )
    return [int(number) for number in listed.stdout.split()]


def test_ctrl_c_keeps_what_is_done(folder):
    process = start(folder, "-o", "stopped.h5", "--workers", "2")
    try:
        await_cases(process)
        process.send_signal(signal.SIGINT)
        _, told = process.communicate(timeout=PATIENCE)
    finally:
        end(process)
    assert process.returncode == 130, told
    assert "Traceback" not in told
    assert "cases are kept in stopped.h5, continue with --resume" in told
    done, status, state = kept(folder / "stopped.h5")
    assert 0 < done < 160
    assert (status, state) == ("interrupted", "partial: stopped by the user")
    finish(folder, "stopped.h5", "--workers", "1")


def test_a_killed_command_goes_on(folder):
    process = start(folder, "-o", "killed.h5", "--workers", "2")
    try:
        await_cases(process)
        workers = children_of(process)
    finally:
        end(process)
    done, status, state = kept(folder / "killed.h5")
    assert 0 < done < 160
    assert (status, state[:32]) == ("running", "partial: its process ended unexp")
    assert len(workers) == 2
    await_end(workers)
    finish(folder, "killed.h5", "--workers", "2")


def await_end(processes):
    """Wait until orphaned workers have ended themselves."""
    ending = time.monotonic() + PATIENCE
    while time.monotonic() < ending:
        if not any(Path(f"/proc/{number}/cmdline").exists() for number in processes):
            return
        time.sleep(0.2)
    raise AssertionError("workers outlive the command")


def test_a_killed_worker_is_replaced(folder):
    process = start(folder, "-o", "worker.h5", "--workers", "2")
    try:
        await_cases(process)
        os.kill(children_of(process)[0], signal.SIGKILL)
        _, told = process.communicate(timeout=PATIENCE)
    finally:
        end(process)
    assert process.returncode == 0, told
    assert "1 worker process ended unexpectedly (signal 9, SIGKILL); its cases were" in told
    same(folder / "whole.h5", folder / "worker.h5")


@pytest.fixture(scope="module")
def certificates(tmp_path_factory):
    """Return a folder with a certificate that trusts itself, made as docs/sweeps.md says."""
    pytest.importorskip("distributed")
    place = tmp_path_factory.mktemp("certificates")
    page = (Path(__file__).parents[3] / "docs" / "sweeps.md").read_text(encoding="utf-8")
    commands = re.findall(r"^(?:mkdir|openssl|cp) .*$", page, re.MULTILINE)
    assert len(commands) == 3
    subprocess.run(["sh", "-ec", "\n".join(commands)], cwd=place, check=True, capture_output=True)
    return place / "certificates"


@contextlib.contextmanager
def cluster(folder, count, certificates):
    """A scheduler and workers as processes of their own, as on other machines."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tls://127.0.0.1:{free.getsockname()[1]}"
    trust = [
        *("--tls-ca-file", certificates / "ca.pem", "--tls-cert", certificates / "cert.pem"),
        *("--tls-key", certificates / "key.pem"),
    ]
    port = address.rpartition(":")[2]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": environment(folder)}
    module = [sys.executable, "-m", "distributed.cli.dask_scheduler"]
    options = ["--host", "tls://127.0.0.1", "--port", port, "--no-dashboard", *trust]
    scheduler = subprocess.Popen([*module, *options], **quiet)
    module = [sys.executable, "-m", "distributed.cli.dask_worker", address]
    options = ["--no-nanny", "--nthreads", "1", "--no-dashboard", *trust]
    workers = [subprocess.Popen([*module, *options], **quiet) for _ in range(count)]
    try:
        yield address, scheduler, workers
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()


def test_the_workers_of_a_cluster_give_the_same(folder, certificates):
    with cluster(folder, 2, certificates) as (address, _, _):
        words = ["-o", "cluster.h5", "--scheduler", address, "--tls", certificates]
        done = command("sweep", "long.yaml", *words, folder=folder)
    assert done.returncode == 0, done.stderr
    assert f"computed by the cluster at {address}" in done.stderr
    same(folder / "whole.h5", folder / "cluster.h5")


def test_a_cluster_refuses_other_certificates(folder, certificates, tmp_path):
    names = ["-keyout", tmp_path / "key.pem", "-out", tmp_path / "cert.pem"]
    make = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=other"]
    subprocess.run([*make, *names], check=True, capture_output=True)
    shutil.copy(tmp_path / "cert.pem", tmp_path / "ca.pem")
    with cluster(folder, 0, certificates) as (address, _, _):
        words = ["-o", "other.h5", "--scheduler", address, "--tls", tmp_path]
        done = command("sweep", "long.yaml", *words, folder=folder)
    assert done.returncode == 2
    assert "no scheduler answers there that trusts the certificates in" in done.stderr
    assert not (folder / "other.h5").exists()


def test_a_scheduler_that_goes_away_loses_nothing(folder, certificates):
    with cluster(folder, 2, certificates) as (address, scheduler, _):
        process = start(folder, "-o", "gone.h5", "--scheduler", address, "--tls", certificates)
        try:
            await_cases(process)
            scheduler.kill()
            _, told = process.communicate(timeout=PATIENCE)
        finally:
            end(process)
    assert process.returncode == 3, told
    assert f"the scheduler at {address} has gone away" in told
    assert "Traceback" not in told
    assert 0 < kept(folder / "gone.h5")[0] < 160
    finish(folder, "gone.h5", "--workers", "1")


def test_no_scheduler_at_the_address(folder, certificates):
    words = ["-o", "none.h5", "--scheduler", "tls://127.0.0.1:9", "--tls", certificates]
    done = command("sweep", "long.yaml", *words, folder=folder)
    assert done.returncode == 2
    assert "--scheduler tls://127.0.0.1:9: no scheduler answers there" in done.stderr
    assert not (folder / "none.h5").exists()
