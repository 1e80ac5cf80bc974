"""Damaged copies of result files of every kind, and what the program must make of them."""

import os
import shutil
from pathlib import Path

import numpy as np
from harness import Case
from starting import start

ROOT = Path(__file__).parents[2]
SYSTEMS = ROOT / "systems"

SCENARIO = """\
title: A swing
model: double_pendulum.yaml
duration: 3 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms, animation: true}
"""
STUDY = """\
title: Double pendulums
scenario: short.yaml
set:
  duration: 0.2 s
cases:
  kind: latin_hypercube
  number: 24
  seed: 5
  vary:
    parameters.length: {from: 0.5 m, to: 2 m}
output:
  interval: 20 ms
  channels: [upper.*, tip.*]
"""
COMMANDS = {
    "run.h5": ["run", "short.yaml", "--no-plots", "-q", "-o", "run.h5"],
    "study.h5": ["sweep", "study.yaml", "--workers", "1", "-q", "-o", "study.h5"],
    "kinematics.h5": [
        "kinematics", str(SYSTEMS / "four_bar.yaml"), "--drive", "crank.angle=-60 deg:300 deg:72",
        "--no-plots", "-o", "kinematics.h5",
    ],
    "modes.h5": ["eig", str(SYSTEMS / "quarter_car.yaml"), "-o", "modes.h5"],
    "response.h5": [
        "response", str(SYSTEMS / "quarter_car.yaml"), "--input", "road.height",
        "--output", "body.height", "-o", "response.h5",
    ],
}  # fmt: skip
VERBS = {
    "run.h5": ("info", "compare", "compare", "report", "animate", "plot"),
    "killed.h5": ("info", "compare", "compare", "report", "animate"),
    "study.h5": ("info", "compare", "report"),
    "killed_study.h5": ("info", "compare", "report"),
}
OTHERS = ("info", "compare", "report", "plot")


def write_originals(folder):
    """Write a file of each kind into a folder and return their names."""
    shutil.copy(SYSTEMS / "double_pendulum.yaml", folder)
    (folder / "short.yaml").write_text(SCENARIO, encoding="utf-8")
    (folder / "study.yaml").write_text(STUDY, encoding="utf-8")
    for name, command in COMMANDS.items():
        code = start(folder, command).wait()
        assert (folder / name).exists(), (command, code)
    for name in ("run", "study"):
        leave_as_killed(folder / f"{name}.h5", folder / f"killed_{name}.h5".replace("_run", ""))
    return [*COMMANDS, "killed.h5", "killed_study.h5"]


def leave_as_killed(whole, left):
    """Copy a file as a kill just before its end would have left it: without a seal."""
    from vehicledyn.results.store import study_writer, writer

    def keep(path, change):
        shutil.copyfile(path, left)
        os._exit(0)

    def change():
        writer.finish = study_writer.finish = keep

    command = [word.replace(whole.name, "again.h5") for word in COMMANDS[whole.name]]
    assert start(whole.parent, command, change).wait() == 0
    for file in whole.parent.glob("*again.h5*"):
        file.unlink()


def damaged(data, random):
    """Return a copy with some bytes changed, zeroed, exchanged, or its end cut off."""
    broken = bytearray(data)
    kind = random.choice(["flip", "flips", "zeros", "zeros", "noise", "moved", "cut"])
    place = int(random.integers(len(data)))
    length = min(int(2 ** random.uniform(2, 12)), len(data) - place)
    if kind == "flip":
        broken[place] ^= 1 << int(random.integers(8))
    elif kind == "flips":
        for other in random.integers(0, len(data), 20):
            broken[other] = int(random.integers(256))
    elif kind == "zeros":
        broken[place : place + length] = bytes(length)
    elif kind == "noise":
        broken[place : place + length] = random.bytes(length)
    elif kind == "moved":
        start = int(random.integers(len(data) - length))
        broken[place : place + length] = data[start : start + length]
    else:
        del broken[place:]
    return kind, bytes(broken)


def heap_damage(data):
    """Yield copies in each of which the objects of one heap of texts are zeroed."""
    place = data.find(b"GCOL\1")
    while place >= 0:
        broken = bytearray(data)
        size = int.from_bytes(data[place + 8 : place + 16], "little")
        broken[place + 16 : place + size] = bytes(max(0, min(size, len(data) - place) - 16))
        yield bytes(broken)
        place = data.find(b"GCOL\1", place + 1)


def cases(name, data, count, seed=14):
    """Yield commands on damaged copies of a file."""
    random = np.random.default_rng(seed)
    copies = [("heap", broken) for broken in heap_damage(data)]
    copies += [damaged(data, random) for _ in range(max(0, count - len(copies)))]
    verbs = VERBS.get(name, OTHERS)
    for number, (kind, broken) in enumerate(copies):
        if broken == data:
            continue
        verb = verbs[number % len(verbs)]
        command = [verb, "broken.h5"] + (["whole.h5"] if verb == "compare" else [])
        outputs = ("broken_plots", "broken_report.html", "broken_animation.html", "broken.html")
        files = {"broken.h5": broken, "whole.h5": data}
        yield Case(f"{name} {number} {kind} {verb}", files, command, outputs)


def silently_wrong(outcome):
    """Return whether a damaged file was compared as if it were sound, and found to differ."""
    return (
        outcome.case.command[0] == "compare"
        and outcome.code == 1
        and ("partial" not in outcome.text or "differ" in outcome.text)
    )
