"""A run's samples go to its file, and what its summary needs comes from there."""

import shutil
import subprocess
import sys
from pathlib import Path

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
from vehicledyn.analyses.simulation import simulation
memory = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
summarise, before = simulation._Run._summarise, []
def watched(*arguments):
    before.append(memory())
    summarise(*arguments)
simulation._Run._summarise = watched
sys.argv = ["vehicledyn", "run", "long.yaml", "--no-plots", "-q", "--set", sys.argv[1]]
try:
    main()
except SystemExit as end:
    print(end.code, before[0], memory())
"""


def test_memory_does_not_hold_the_samples(tmp_path):
    shutil.copy(SYSTEM, tmp_path)
    (tmp_path / "long.yaml").write_text(SCENARIO, encoding="utf-8")
    found = []
    for seconds in (10, 130, 630):
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, f"duration={seconds} s"],
            cwd=tmp_path, capture_output=True, text=True, check=True, timeout=300.0,
        )  # fmt: skip
        code, *memory = map(int, done.stdout.split())
        assert code == 0
        found.append(memory)
    samples = 500_000
    while_running, at_the_end = (long - short for long, short in zip(*found[:0:-1], strict=True))
    assert while_running < 10e6  # one column of the samples would be 4 MB
    assert at_the_end < 10 * 8 * samples
