"""Measure vehicledyn beside other engines: ``python benchmarks/peers.py --peers FOLDER``.

FOLDER is a virtual environment with pinocchio (package pin), mujoco and exudyn; ``--install``
makes it. Equal systems are built in all engines, their accelerations must agree, and the
candidates take turns. An engine that is missing is named and left out. Writes the page
reports/speed.md, or another file with ``--report``.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import venv
from dataclasses import dataclass
from pathlib import Path

import chains
import numpy as np
import own
import speed
from speed_page import page

from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive

ROOT = Path(__file__).resolve().parents[1]
WORKER = Path(__file__).with_name("peer_worker.py")
PACKAGES = {"pinocchio": "pin", "MuJoCo": "mujoco", "EXUDYN": "exudyn"}
AGREEMENT = 1e-9  # largest difference of accelerations over the largest acceleration
ERROR = 1e-4  # m, of B0 in the four-bar chain
LINKAGES, DURATION, INTERVAL = 20, 4.0, 0.02
STEPS = (1000, 1250, 1600, 2000, 2500, 3200, 4000, 5000, 6400, 8000)


class Peer:
    """Another engine, in a process and an environment of its own."""

    def __init__(self, name, python):
        self.name = name
        limits = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        self._process = subprocess.Popen(
            [str(python), "-W", "ignore", str(WORKER), name],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env={**os.environ, **limits},
        )
        line = self._process.stdout.readline()
        hello = json.loads(line or '{"missing": "its Python does not start, or lacks NumPy"}')
        self.version, self.missing = hello.get("version", ""), hello.get("missing", "")

    def ask(self, request, *arguments):
        self._process.stdin.write(json.dumps([request, arguments]) + "\n")
        self._process.stdin.flush()
        return self._answer()

    def close(self):
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()

    def _answer(self):
        line = self._process.stdout.readline()
        if not line:
            raise SystemExit(f"{self.name} ended without an answer")
        return json.loads(line)


@dataclass(frozen=True)
class Row:
    """What one system costs in each engine [ns]; ``differences`` are those of accelerations.

    ``in_lanes`` is what one of ``lanes`` cases side by side costs.
    """

    system: str
    own: float
    in_lanes: float
    lanes: int
    others: dict[str, float]
    differences: dict[str, float]


def find_peers(folder, *, install):
    """Return the engines that can be started; tell of the others in a line each."""
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if install and not python.exists():
        venv.create(folder, with_pip=True)
    if install:
        for package in PACKAGES.values():
            command = [str(python), "-m", "pip", "install", "--quiet", package]
            if subprocess.run(command, check=False).returncode:
                print(f"{package} cannot be installed")
    if not python.exists():
        print(f"no environment in {folder}; --install makes it")
        return []
    found = []
    for name, package in PACKAGES.items():
        peer = Peer(name, python)
        if peer.missing:
            peer.close()
            print(f"{name} is left out: {peer.missing}; install the package {package}")
        else:
            found.append(peer)
    return found


def forward_dynamics(peers, lengths, repeats):
    """Compare chains and a tree in all engines."""
    cases = [(f"chain of {n}", n, chains.serial) for n in lengths]
    cases.append(("binary tree of 30", 30, chains.binary))
    rows = []
    for name, joints, parent in cases:
        system = chains.build(name, joints, parent)
        kernel = compile_kernel(derive(system), backend="compiled")
        angles, rates = np.random.default_rng(joints).uniform(-1.0, 1.0, (2, joints))
        mine = own.accelerations(kernel, angles, rates)
        model, differences = own.describe(system, parent), {}
        for peer in peers:
            peer.ask("load", model)
            peer.ask("move", angles.tolist(), rates.tolist())
            theirs = np.array(peer.ask("accelerations"))
            differences[peer.name] = float(np.abs(theirs - mine).max() / np.abs(mine).max())
            if not differences[peer.name] <= AGREEMENT:
                raise SystemExit(f"{name}: {peer.name} differs by {differences[peer.name]:.1e}")
        times = {peer.name: [] for peer in peers}
        ours, aside, lanes = [], [], own.Lanes(kernel, angles, rates)
        for _ in range(repeats):
            ours.append(own.nanoseconds(kernel, angles, rates))
            aside.append(lanes.nanoseconds())
            for peer in peers:
                times[peer.name].append(1e9 * peer.ask("seconds", 100_000 // joints))
        medians = {key: statistics.median(values) for key, values in times.items()}
        mine, in_lanes = statistics.median(ours), statistics.median(aside)
        rows.append(Row(name, mine, in_lanes, lanes.lanes, medians, differences))
        print(_words(rows[-1]), flush=True)
    return rows


def _words(row):
    parts = [
        f"{k} {v:.0f} ns ({v / row.own:.1f}x, {v / row.in_lanes:.1f}x)"
        for k, v in row.others.items()
    ]
    own_words = f"vehicledyn {row.own:.0f} ns, {row.in_lanes:.0f} ns of {row.lanes} lanes"
    return f"{row.system:18} " + ", ".join([own_words, *parts])


def four_bars(peers, repeats):
    """Compare the four-bar chain with EXUDYN, each with the longest step of error ERROR."""
    chain = own.FourBarChain()
    error = chain.run()["error"]
    lines = [("vehicledyn", f"RK4, {1e3 * chain.step:g} ms", error, [], [])]
    exudyn = next((peer for peer in peers if peer.name == "EXUDYN"), None)
    request = None
    if exudyn is not None:
        for steps in STEPS:
            request = ("four_bars", LINKAGES, DURATION / steps, DURATION, INTERVAL)
            time, x, y = np.array(exudyn.ask(*request)["samples"]).T
            error = own.four_bar_error(time, x, y)
            if error <= ERROR:
                break
        words = f"generalised-alpha, {1e3 * DURATION / steps:g} ms"
        lines.append((f"EXUDYN {exudyn.version}", words, error, [], []))
    for _ in range(repeats):
        found = [chain.run()] + ([exudyn.ask(*request)] if request else [])
        for line, item in zip(lines, found, strict=True):
            line[3].append(item["seconds"])
            line[4].append(item["wall"])
    rows = [
        (n, w, e, statistics.median(cpu), statistics.median(wall)) for n, w, e, cpu, wall in lines
    ]
    for name, words, error, cpu, wall in rows:
        print(f"{name}: {words}, error {error:.1e} m, {cpu:.4f} s processor, {wall:.4f} s wall")
    return rows


def iltis(repeats):
    """Return the rows on the Iltis: right-hand sides, and the time of the slalom [s]."""
    frequency = own.processor_frequency()
    found, slalom = own.iltis(repeats)
    rows = []
    for words, operations, times in found:
        median = statistics.median(times)
        a_cycle = f"{operations / (median * frequency):.2f}" if frequency else "unknown"
        rows.append((f"right-hand side, {words}", operations, 1e9 * median, a_cycle))
        print(f"{rows[-1][0]}: {operations} operations, {1e9 * median:.0f} ns, {a_cycle} a cycle")
    seconds = statistics.median(slalom)
    print(f"slalom: {seconds:.3f} s, {speed.DURATION / seconds:.0f} times real time")
    return rows, seconds


def main(arguments=None):
    """Measure, print and write the page."""
    parser = argparse.ArgumentParser(description="Measure vehicledyn beside other engines.")
    default = Path(tempfile.gettempdir()) / "vehicledyn_peers"
    parser.add_argument("--peers", type=Path, default=default, help="environment of the engines")
    parser.add_argument("--install", action="store_true", help="make it, install the engines")
    parser.add_argument("--quick", action="store_true", help="up to 30 joints, few repetitions")
    parser.add_argument("--report", type=Path, default=ROOT / "reports" / "speed.md")
    options = parser.parse_args(arguments)
    repeats, lengths = (3, (6, 12, 30)) if options.quick else (9, chains.LENGTHS)
    peers = find_peers(options.peers, install=options.install)
    rows = forward_dynamics(peers, lengths, repeats)
    bars = four_bars(peers, repeats)
    cars, slalom = iltis(repeats)
    for peer in peers:
        peer.close()
    options.report.write_text(
        page(peers, rows, bars, cars, slalom, error=ERROR, duration=DURATION), encoding="utf-8"
    )
    print(f"written: {options.report}", file=sys.stderr)


if __name__ == "__main__":
    main()
