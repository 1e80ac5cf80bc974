"""Spoilt files that a computation goes on from: results to restart from, checkpoints, motions."""

import mechanism_cases
import result_cases
import yaml_cases
from harness import Case
from result_cases import CHECKPOINT, HUNT, PENDULUM, QUIET

LONGER = ["--set", "duration=60 ms", *result_cases.SETS[2:], *QUIET]
COMMANDS = {
    "run.h5": ["run", PENDULUM, "--restart", "run.h5", *LONGER, "-o", "out.h5"],
    "inverse.h5": ["inverse", "scenarios/systems/slider_crank.yaml", "--motion", "inverse.h5",
                   *result_cases.SETS[:4], *QUIET, "-o", "out.h5"],
    "study.h5": ["sweep", "study.yaml", "--resume", "--workers", "1", "-q", "--backend",
                 "interpreted", "-o", "study.h5"],
    CHECKPOINT: [*HUNT, "--resume"],
}  # fmt: skip
OUTPUTS = ("out.h5", "hunt.h5", CHECKPOINT)


def resumed(rng, name):
    """A computation that goes on from a spoilt file."""
    file = rng.choice([name for name in COMMANDS for _ in range(1 if name == CHECKPOINT else 4)])
    files = {
        "study.yaml": yaml_cases.STUDY.encode(),
        "self_excited.yaml": mechanism_cases.SELF_EXCITED.encode(),
    }
    if file == CHECKPOINT:
        files[file] = _cut_or_changed(result_cases.seeds()[file], rng)
    else:
        files[file] = result_cases.spoilt(result_cases.seeds()[file], rng)
    return Case(name, yaml_cases.around(files), COMMANDS[file], OUTPUTS)


def _cut_or_changed(content, rng):
    found = bytearray(content)
    if rng.random() < 0.3:
        return bytes(found[: rng.randrange(len(found))])
    for _ in range(rng.choice([1, 3, 20])):
        found[rng.randrange(len(found))] = rng.randrange(256)
    return bytes(found)
