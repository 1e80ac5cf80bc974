"""A run's samples go to its file, and what its summary needs comes from there."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SYSTEM = Path(__file__).parents[3] / "systems" / "double_pendulum.yaml"
SCENARIO = """\
title: A long swing
model: double_pendulum.yaml
duration: 10 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 1 ms}
"""
PROGRAM = """
import resource, sys
from vehicledyn.cli import main
sys.argv = ["vehicledyn", "run", "long.yaml", "--no-plots", "-q", *sys.argv[1:]]
try:
    main()
except SystemExit as end:
    print(end.code, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
"""


def most_memory(folder, seconds, *options):
    """Return the most memory of a process of its own that runs so long [bytes]."""
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, "--set", f"duration={seconds} s", *options],
        cwd=folder, capture_output=True, text=True, check=True,
    )  # fmt: skip
    code, memory = map(int, done.stdout.split())
    assert code == 0
    return memory


@pytest.mark.long
def test_memory_does_not_grow_with_the_samples(tmp_path):
    shutil.copy(SYSTEM, tmp_path)
    (tmp_path / "long.yaml").write_text(SCENARIO, encoding="utf-8")
    most_memory(tmp_path, 1)  # builds the kernel
    short, long = (most_memory(tmp_path, seconds) for seconds in (130, 1130))
    continued = most_memory(tmp_path, 1131, "--restart", "long.h5", "-o", "longer.h5")
    samples = 1_000_000
    # Half of one column of the further samples.
    assert long - short < 4 * samples
    assert continued - short < 4 * samples
