"""The wheel holds the library: in an empty folder its scenarios run by name."""

import os
import shutil
import subprocess
import sys
import venv
from importlib import metadata
from pathlib import Path

import pytest

from vehicledyn.library import entries

pytestmark = pytest.mark.long

ROOT = Path(__file__).parents[3]
ISOLATION = int(metadata.version("setuptools").partition(".")[0]) < 77


LISTING = """
from vehicledyn.library import entries
print(*(entry.place for entry in entries("scenario", "study", "system")), sep="\\n")
"""


def run(command, folder):
    environment = {key: text for key, text in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(
        [str(word) for word in command], cwd=folder, env=environment, check=False,
        capture_output=True, text=True, timeout=500,
    )  # fmt: skip
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """Return the command of a wheel in a virtual environment that shares the dependencies."""
    place = tmp_path_factory.mktemp("installed")
    options = ["--no-deps", *([] if ISOLATION else ["--no-build-isolation"])]
    source = place / "source"
    source.mkdir()
    for name in ("pyproject.toml", "setup.py", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    for name in ("vehicledyn", "scenarios", "systems", "profiles"):
        shutil.copytree(ROOT / name, source / name)
    run([sys.executable, "-m", "pip", "wheel", *options, "-w", place, source], place)
    (wheel,) = place.glob("*.whl")
    venv.create(place / "venv")
    python = place / "venv" / "bin" / "python"
    (packages,) = (place / "venv").glob("lib/python*/site-packages")
    others = [path for path in sys.path if path.endswith("-packages")]
    packages.joinpath("shared.pth").write_text("\n".join(others))
    install = ["install", "--no-deps", "--ignore-installed"]  # another may stand on the shared path
    run([sys.executable, "-m", "pip", "--python", python, *install, wheel], place)
    return place / "venv" / "bin" / "vehicledyn"


def test_scenarios_run_by_name_in_an_empty_folder(installed, tmp_path):
    done = run([installed, "run", "double_pendulum"], tmp_path)
    assert str(installed.parents[1]) in done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "double_pendulum.h5", "double_pendulum_plots",
    ]  # fmt: skip


def test_all_names_are_known(installed, tmp_path):
    names = [entry.place for entry in entries("scenario", "study", "system")]
    python = installed.with_name("python")
    assert run([python, "-c", LISTING], tmp_path).stdout.split() == [str(n) for n in names]
    done = run([installed, "validate", *names[::8]], tmp_path)
    assert done.stdout.count(": ok") == len(names[::8])
    listed = run([installed, "models", "list"], tmp_path).stdout
    assert all(f"\n{entry.name} " in f"\n{listed}" for entry in entries("system"))


def test_copies_can_be_used(installed, tmp_path):
    run([installed, "examples", "copy", "iltis_slalom_sweep"], tmp_path)
    run([installed, "examples", "copy", "s1002", "-o", "profiles"], tmp_path)
    run([installed, "validate", "studies/iltis_slalom_sweep.yaml", "iltis_slalom.yaml"], tmp_path)
    assert (tmp_path / "profiles" / "s1002.csv").is_file()
