"""The memory that the benchmark of sweeps tells."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
HELD = 64  # MiB


@pytest.mark.skipif(
    not Path("/proc/self/smaps_rollup").exists(), reason="the system tells no memory"
)
def test_memory_counts_processes_below(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    import sweeps

    before = sweeps.memory_of(os.getpid())
    code = f"held = bytearray({HELD} << 20); held[::4096] = b'x' * len(held[::4096]); "
    code += "print('ready', flush=True); input()"
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    with process:
        process.stdout.readline()
        grown = sweeps.memory_of(os.getpid()) - before
        process.communicate("\n")
    assert HELD < grown < HELD + 32
    monkeypatch.delitem(sys.modules, "sweeps")
