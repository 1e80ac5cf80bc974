"""What a disk that fills up leaves: whole files, partial results with their summary, no others.

The disk is a real one: a file system of some kilobytes in memory, mounted for one process.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

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
MOUNT = 'mount -t tmpfs -o "size=$1" tmpfs "$2" && cd "$2" && shift 2 && "$@"; code=$?;'
COPY = 'cp -a . "$KEPT"; exit $code'


def mounted(size, folder, kept, command):
    """Run a command on a file system of a size and copy what it leaves."""
    done = subprocess.run(
        ["unshare", "-rm", "sh", "-c", MOUNT + COPY, "sh", size, str(folder), *command],
        env={**os.environ, "KEPT": str(kept), "VEHICLEDYN_TRACEBACK": ""},
        capture_output=True,
        text=True,
        check=False,
        timeout=120.0,
    )
    assert "Traceback" not in done.stderr
    return done


@pytest.fixture
def disk(tmp_path):
    folder, kept = tmp_path / "disk", tmp_path / "kept"
    folder.mkdir()
    kept.mkdir()
    if shutil.which("unshare") is None or mounted("64k", folder, kept, ["true"]).returncode:
        pytest.skip("file systems cannot be mounted here")

    def run(size, *command):
        program = [sys.executable, "-m", "vehicledyn", *map(str, command)]
        done = mounted(size, folder, kept, program)
        return done, sorted(kept.rglob("*"))

    return run


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
    command = [sys.executable, "-m", "vehicledyn", "run", "short.yaml", "--no-plots", "-q"]
    subprocess.run(command, cwd=folder, check=True)
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
