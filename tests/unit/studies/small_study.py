"""A small study: pendulums of many lengths and masses."""

import os
import subprocess
import sys
from pathlib import Path

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.studies import load_study
from vehicledyn.studies.sweep import run_study

ROOT = Path(__file__).parents[3]
PENDULUM = ROOT / "scenarios" / "systems" / "double_pendulum.yaml"
STUDY = f"""\
title: Double pendulums
scenario: {PENDULUM}
set:
  solver: {{kind: rk4, step: 1 ms}}
  duration: 0.2 s
cases:
  kind: latin_hypercube
  number: 24
  seed: 5
  vary:
    parameters.length: {{from: 0.5 m, to: 2 m}}
    parameters.mass: {{from: 500 g, to: 2 kg, scale: log}}
output:
  interval: 20 ms
  channels: [upper.*, tip.*]
"""


def written(folder, text=STUDY, name="study.yaml"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def swept(path, output, *overrides, **changes):
    options = {"workers": 1, "lanes": None, "resume": False, "backend": "auto"}
    study = load_study(path, overrides)
    return run_study(study, output=output, progress=lambda *_: None, **options | changes)


def environment(folder):
    """Let programs run the copy of the package in a folder, which nobody edits meanwhile."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return os.environ | {"PATH": path, "PYTHONPATH": str(folder)}


def command(*words, folder, cwd_of=None):
    words = [sys.executable, "-m", "vehicledyn", *map(str, words)]
    return subprocess.run(
        words, cwd=cwd_of.parent if cwd_of else folder, env=environment(folder), check=False,
        capture_output=True, text=True, timeout=300,
    )  # fmt: skip
