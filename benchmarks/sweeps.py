"""Measure sweeps and a warm run: ``python benchmarks/sweeps.py [--quick] [--json FILE]``.

Runs the study of slaloms with 20 parameters drawn at random in processes of its own, as a user
would, and tells wall time, processor time and memory; the time of the first cases, in which the
kernel is compiled, is not counted. The cost of a case is the processor time that further cases
take, so that start-up does not hide whether it grows with their number. Writes nothing but the
JSON file where one is asked for; caches and results go to temporary folders.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import asdict, dataclass
from pathlib import Path

SCENARIOS = Path(__file__).resolve().parents[1] / "scenarios"
STUDY, SLALOM = SCENARIOS / "studies" / "iltis_slalom_sweep.yaml", SCENARIOS / "iltis_slalom.yaml"
FEW, COUNTS, SHORT = 8, (100, 1000, 10000), "1 s"
PAUSE = 0.1  # s between looks at the memory


@dataclass(frozen=True)
class Figure:
    """A measured quantity over its repetitions; ``goal`` is what the project asks for."""

    name: str
    unit: str
    values: list[float]
    goal: str = ""

    @property
    def median(self) -> float:
        return statistics.median(self.values)

    def line(self) -> str:
        low, high = min(self.values), max(self.values)
        return (
            f"{self.name:60} {self.median:>9.4g} {self.unit:4} {low:.4g} ... {high:.4g} {self.goal}"
        )


@dataclass(frozen=True)
class Cost:
    """Wall and processor time [s] of a command with all its processes, and their memory [MiB]."""

    wall: float
    processor: float
    memory: float


def memory_of(root):
    """Return the memory of a process and all below it, shared pages divided among them [MiB]."""
    parents = {}
    for entry in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = entry.read_text(encoding="utf-8").rpartition(")")[2].split()
        except OSError:
            continue
        parents.setdefault(int(fields[1]), []).append(int(entry.parent.name))
    total, waiting = 0, [root]
    while waiting:
        number = waiting.pop()
        waiting += parents.get(number, [])
        try:
            lines = Path(f"/proc/{number}/smaps_rollup").read_text(encoding="utf-8").splitlines()
        except OSError:
            continue
        total += sum(int(line.split()[1]) for line in lines if line.startswith("Pss:"))
    return total / 1024


def run(arguments, cache):
    """Run a verb and return what it costs."""
    environment = {**os.environ, "VEHICLEDYN_CACHE": str(cache)}
    before, started = os.times(), time.perf_counter()
    process = subprocess.Popen(
        [sys.executable, "-m", "vehicledyn", *map(str, arguments)],
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    most, done = [0.0], threading.Event()

    def look():
        while not done.wait(PAUSE):
            most.append(memory_of(process.pid))

    watcher = threading.Thread(target=look)
    watcher.start()
    code = process.wait()
    wall, after = time.perf_counter() - started, os.times()
    done.set()
    watcher.join()
    if code:
        raise SystemExit(f"vehicledyn {arguments[0]} ended with exit code {code}")
    processor = sum(after[2:4]) - sum(before[2:4])
    return Cost(wall, processor, max(most))


def sweep(folder, number, *changes):
    """Return the cost of a sweep of so many cases by two processes."""
    output = folder / "sweep.h5"
    output.unlink(missing_ok=True)
    sets = [item for change in (f"cases.number={number}", *changes) for item in ("--set", change)]
    return run(["sweep", STUDY, *sets, "--workers", 2, "-q", "-o", output], folder / "cache")


def sweeps(folder, counts):
    """Return time and memory of 1,000 slaloms, and the cost of further cases by their number."""
    sweep(folder, FEW)
    whole, some = sweep(folder, 1000), sweep(folder, 100)
    figures = [
        Figure("sweep of 1,000 slaloms of 10 s by 2 processes", "s", [whole.wall], "<= 20"),
        Figure("its processor time", "s", [whole.processor]),
        Figure("of which a case", "ms", [1e3 * (whole.processor - some.processor) / 900]),
        Figure("its memory", "MiB", [whole.memory], "<= 2048"),
    ]
    known = 0, Cost(0.0, 0.0, 0.0)
    for count in counts:
        cost = sweep(folder, count, f"duration={SHORT}")
        further, seconds = count - known[0], cost.processor - known[1].processor
        name = f"a slalom of {SHORT}, from the {known[0] + 1}st to the {count}th"
        if known[0]:
            figures.append(Figure(f"{name}, processor time", "ms", [1e3 * seconds / further]))
        figures.append(Figure(f"memory of the sweep of {count}", "MiB", [cost.memory]))
        known = count, cost
    return figures


def warm_runs(folder, repeats):
    """Return wall and processor time of the slalom that was run before."""
    output, costs = folder / "slalom.h5", []
    for _ in range(repeats + 1):
        output.unlink(missing_ok=True)
        command = ["run", SLALOM, "--no-plots", "-q", "-o", output]
        costs.append(run(command, folder / "cache"))
    return [
        Figure(
            "vehicledyn run slalom without plots, warm", "s", [c.wall for c in costs[1:]], "<= 1.2"
        ),
        Figure("its processor time", "s", [c.processor for c in costs[1:]]),
    ]


def main(arguments=None):
    """Measure, print and, if asked, write the figures as JSON."""
    parser = argparse.ArgumentParser(description="Measure sweeps and a warm run.")
    parser.add_argument("--quick", action="store_true", help="no sweep of 10,000 cases")
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    options = parser.parse_args(arguments)
    figures = []
    with tempfile.TemporaryDirectory() as name:
        for measure in (
            lambda: warm_runs(Path(name), 3 if options.quick else 9),
            lambda: sweeps(Path(name), COUNTS[:2] if options.quick else COUNTS),
        ):
            found = measure()
            figures += found
            print("\n".join(figure.line() for figure in found), flush=True)
    if options.json:
        content = [{**asdict(f), "median": f.median} for f in figures]
        options.json.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
