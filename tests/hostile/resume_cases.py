"""Spoilt files that a computation goes on from: results to restart from, checkpoints, motions."""

import functools
import tempfile
from pathlib import Path

import harness
import result_cases
import yaml_cases
from harness import Case
from result_cases import PENDULUM, QUIET

HUNT = ["hunt", "systems/simple_wheelset.yaml", "--from", "50 m/s", "--to", "70 m/s",
        "--points", "4", "--no-simulation", *QUIET, "-o", "h.h5"]  # fmt: skip
CHECKPOINT = "h.h5.checkpoint"
LONGER = ["--set", "duration=60 ms", *result_cases.SETS[2:], *QUIET]
COMMANDS = {
    "run.h5": ["run", PENDULUM, "--restart", "run.h5", *LONGER, "-o", "out.h5"],
    "inverse.h5": ["inverse", "scenarios/systems/slider_crank.yaml", "--motion", "inverse.h5",
                   *result_cases.SETS[:4], *QUIET, "-o", "out.h5"],
    "study.h5": ["sweep", "study.yaml", "--resume", "--workers", "1", "-q", "--backend",
                 "interpreted", "-o", "study.h5"],
    CHECKPOINT: [*HUNT, "--resume"],
}  # fmt: skip
OUTPUTS = ("out.h5", "h.h5", CHECKPOINT)


@functools.cache
def checkpoint():
    """Return what a hunting study keeps until it is finished."""
    from vehicledyn.results.hdf5.checkpoint import Checkpoint

    with tempfile.TemporaryDirectory(prefix="hostile-seeds-") as name:
        folder = Path(name)
        harness.write(yaml_cases.around({}), folder)
        removed, Checkpoint.remove = Checkpoint.remove, Checkpoint.close
        try:
            outcome = harness._run_in(folder, Case("hunt", {}, HUNT), limited=False)
        finally:
            Checkpoint.remove = removed
        if outcome.code != 0:
            raise RuntimeError(outcome)
        return (folder / CHECKPOINT).read_bytes()


def resumed(rng, name):
    """A computation that goes on from a spoilt file."""
    file = rng.choice([name for name in COMMANDS for _ in range(1 if name == CHECKPOINT else 4)])
    files = {"study.yaml": yaml_cases.STUDY.encode()}
    if file == CHECKPOINT:
        files[file] = _cut_or_changed(checkpoint(), rng)
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
