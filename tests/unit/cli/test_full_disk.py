"""What a disk that fills up leaves: whole files, partial results with their summary, no others.

The disk is a real one: a file system of some kilobytes in memory, mounted for some processes.
"""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from programs import Server, connected, run, start_server

from vehicledyn.results.store.reader import open_result

pytestmark = pytest.mark.long

SCENARIO = """\
title: A long swing
model: double_pendulum.yaml
duration: 1000 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""
SYSTEM = Path(__file__).parents[3] / "systems" / "double_pendulum.yaml"
APART = ("unshare", "-rm")
MOUNTED = """
import os, subprocess, sys
import vehicledyn.cli
size, folder, kept, *sys.argv = sys.argv[2:]
subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", folder], check=True)
os.chdir(folder)
try:
    vehicledyn.cli.main()
finally:
    subprocess.run(["cp", "-a", ".", kept], check=True)
"""
"""Runs a command on a file system of a size and copies what it leaves."""


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """The program where file systems may be mounted that others do not see."""
    folder = tmp_path_factory.mktemp("apart")
    trial = [*APART, "mount", "-t", "tmpfs", "tmpfs", folder]
    if shutil.which(APART[0]) is None or subprocess.run(trial, check=False).returncode:
        pytest.skip("file systems cannot be mounted here")
    process = start_server(folder / "socket", *APART)
    found = Server(connected(folder / "socket"))
    yield found
    found.close()
    process.kill()
    process.wait()


@pytest.fixture
def disk(server, tmp_path):
    folder, kept = tmp_path / "disk", tmp_path / "kept"
    folder.mkdir()
    kept.mkdir()

    def run_on(size, *command):
        words = ["python", "-c", MOUNTED, size, folder, kept, "vehicledyn", *command]
        environment = os.environ | {"VEHICLEDYN_TRACEBACK": ""}
        done = server.call([str(word) for word in words], tmp_path, environment)
        assert "Traceback" not in done.stderr
        return done, sorted(kept.rglob("*"))

    return run_on


@pytest.fixture
def scenario(tmp_path):
    shutil.copy(SYSTEM, tmp_path)
    path = tmp_path / "long.yaml"
    path.write_text(SCENARIO, encoding="utf-8")
    return path


@pytest.mark.parametrize("size", ["900k", "1700k", "2500k"])
def test_a_run_on_a_disk_that_fills_up_keeps_samples_and_summary(disk, scenario, size):
    done, left = disk(size, "run", scenario, "--no-plots", "-q")
    assert done.returncode == 2, done.stderr
    assert "No space left on device; free some space" in done.stderr
    assert [path.name for path in left] == ["long.h5"]
    with open_result(left[0]) as result:
        assert result.status == "failed" and not result.is_whole
        assert len(result.time) > 1000 and result.summary
        assert "No space left" in result.status_message
        for name in result.channels:
            assert len(result.channel(name).values) == len(result.time)


def test_a_run_on_a_full_disk_leaves_nothing(disk, scenario):
    done, left = disk("16k", "run", scenario, "--no-plots", "-q")
    assert done.returncode == 2 and "No space left on device" in done.stderr
    assert left == []


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    shutil.copy(SYSTEM, folder)
    text = SCENARIO.replace("1000 s", "5 s").replace("{interval", "{animation: true, interval")
    (folder / "short.yaml").write_text(text, encoding="utf-8")
    run("vehicledyn run short.yaml --no-plots -q", folder)
    return folder / "short.h5"


@pytest.mark.parametrize(
    "command",
    [
        ("report", "RESULT", "-o", "page.html"),
        ("animate", "RESULT", "-o", "page.html"),
        ("animate", "RESULT", "--film", "film.gif", "--to", "0.2 s"),
        ("animate", "RESULT", "--picture", "still.png"),
        ("plot", "RESULT", "-o", "figures"),
        ("schema", "-o", "schema.json"),
        ("export", "MODEL", "--to", "c", "-o", "new/model.c"),
        ("export", "MODEL", "--to", "fmu", "-o", "new/model.fmu"),
        ("eig", "SCENARIO", "-o", "modes.h5"),
        ("init", "new/project"),
    ],
    ids=lambda command: " ".join(word for word in command if word.islower()),
)
def test_no_file_is_left_empty_or_cut_off(disk, result, command):
    names = {"RESULT": result, "MODEL": SYSTEM, "SCENARIO": result.with_name("short.yaml")}
    done, left = disk("8k", *(names.get(word, word) for word in command))
    files = [path for path in left if path.is_file()]
    assert done.returncode == 2, (done.stdout, done.stderr)
    assert "No space left on device" in done.stderr or "failed" in done.stderr
    assert done.stderr.strip().count("\n") < 5
    # What came whole before the disk was full may stay; nothing hidden, empty or cut off may.
    assert all(not path.name.startswith(".") and path.stat().st_size for path in files)
    assert all(any(path.iterdir()) for path in left if path.is_dir())
    assert not {"page.html", "film.gif", "schema.json", "model.fmu"} & {p.name for p in files}


def test_failed_figures_change_the_exit_code(disk, scenario):
    done, left = disk(
        "420k", "run", scenario, "--set", "duration=5 s", "--set", "output.interval=20 ms"
    )
    assert done.returncode == 2 and "but not its figures" in done.stderr
    (path,) = [path for path in left if path.suffix == ".h5"]
    with open_result(path) as result:
        assert result.is_whole and result.summary
    assert all(p.stat().st_size and not p.name.startswith(".") for p in left if p.is_file())
