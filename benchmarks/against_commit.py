"""Compare with an earlier commit: ``python benchmarks/against_commit.py REVISION [--quick]``.

Unpacks the revision of this repository into a temporary folder and measures it and the working
tree in turns, each with its own package, benchmark and cache: forward dynamics of chains, the
Iltis' right-hand side and slalom alone and in lanes (``lanes.py``), a sweep of slaloms, and the
warm run of the slalom with its figures. All are processor times or made of them; medians and their
ratio are printed, with the ratio of the best values, which other work on the machine moves least.
Above 1 the working tree is better. Writes nothing but the JSON file where one is asked for.

Each turn runs from a new copy of the cache. How fast a kernel runs depends on where its file lies
in memory: of the same bytes one file took 0.42 us a right-hand side and another 0.53 us, each time
anew, so that two trees with one cache each can differ by a quarter where their code is the same.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tarfile
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LARGER_IS_BETTER = ("x",)
"""Units of figures of which more is better: multiples of real time."""

STUDY, SLALOM = "scenarios/studies/iltis_slalom_sweep.yaml", "scenarios/iltis_slalom.yaml"


@dataclass(frozen=True)
class Tree:
    """A source tree to measure, with a folder for its cache and results."""

    name: str
    source: Path
    scratch: Path

    def run(self, *words):
        """Run Python with this tree's package; return the processor time of all its processes."""
        environment = os.environ | {
            "PYTHONPATH": str(self.source),
            "VEHICLEDYN_CACHE": str(self.scratch / "cache"),
        }
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [sys.executable, *map(str, words)]
        done = subprocess.run(
            command, cwd=self.scratch, env=environment, capture_output=True, text=True, check=False
        )
        if done.returncode:
            sys.exit(f"{self.name}: {' '.join(command)} failed:\n{done.stderr.strip()}")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout

    def check(self):
        """Stop if Python finds another package than the tree's."""
        _, place = self.run("-c", "import vehicledyn; print(vehicledyn.__file__)")
        if not Path(place.strip()).is_relative_to(self.source):
            sys.exit(f"{self.name}: Python takes the package from {place.strip()}")

    def renew_cache(self):
        """Let the kernels be in other files, and so in other places of the memory."""
        kept, fresh = self.scratch / "cache", self.scratch / "fresh"
        shutil.copytree(kept, fresh)
        shutil.rmtree(kept)
        fresh.rename(kept)

    def lanes(self):
        """Return the figures of the tree's own benchmark of lanes: name, unit and median."""
        target = self.scratch / "lanes.json"
        self.run(self.source / "benchmarks" / "lanes.py", "--quick", "--json", target)
        found = json.loads(target.read_text(encoding="utf-8"))
        return [(item["name"], item["unit"], item["median"]) for item in found]

    def command(self, name, *words):
        """Return the processor time of a command."""
        return [(name, "s", self.run("-m", "vehicledyn", *words)[0])]

    def sweep(self, number):
        """Return the processor time of a sweep of so many slaloms in one process."""
        study, target = self.source / STUDY, self.scratch / "study.h5"
        target.unlink(missing_ok=True)
        size = f"cases.number={number}"
        words = ["sweep", study, "--workers", 1, "--set", size, "-o", target, "-q"]
        return self.command(f"sweep of {number} slaloms", *words)

    def slalom(self):
        """Return the processor time of the slalom with its figures."""
        target = self.scratch / "slalom.h5"
        target.unlink(missing_ok=True)
        return self.command(
            "warm run of the slalom, with figures", "run", self.source / SLALOM, "-o", target, "-q"
        )


def unpacked(revision, folder):
    """Return the folder of a revision's files."""
    done = subprocess.run(
        ["git", "archive", "--format=tar", revision], cwd=ROOT, capture_output=True, check=False
    )
    if done.returncode:
        sys.exit(f"{revision}: {done.stderr.decode().strip()}")
    with tarfile.open(fileobj=io.BytesIO(done.stdout)) as archive:
        archive.extractall(folder, filter="data")
    return folder


def measure(trees, rounds, cases):
    """Return units and values by name of a figure and tree, the trees taking turns."""
    values, units = {}, {}
    for number in range(rounds):
        for tree in trees if number % 2 == 0 else trees[::-1]:
            tree.renew_cache()
            for name, unit, value in (*tree.lanes(), *tree.sweep(cases), *tree.slalom()):
                units[name] = unit
                values.setdefault(name, {}).setdefault(tree.name, []).append(value)
        print(f"round {number + 1} of {rounds} is measured", file=sys.stderr, flush=True)
    return units, values


def compared(unit, before, now):
    """Return how many times as good the present is: by medians and by the best values."""
    larger = unit in LARGER_IS_BETTER
    best = max if larger else min
    ratios = [f(before) / f(now) for f in (statistics.median, best)]
    return [1.0 / ratio if larger else ratio for ratio in ratios]


def main(arguments=None):
    """Measure, print and, if asked, write the figures as JSON."""
    parser = argparse.ArgumentParser(description="Compare the speed with an earlier commit.")
    parser.add_argument("revision", help="commit, tag or branch to compare the working tree with")
    parser.add_argument("--quick", action="store_true", help="two rounds, a sweep of 40 cases")
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    options = parser.parse_args(arguments)
    rounds, cases = (2, 40) if options.quick else (5, 200)
    with tempfile.TemporaryDirectory(prefix="vehicledyn-") as place:
        folders = [Path(place) / name for name in ("source", "before", "now")]
        for folder in folders:
            folder.mkdir()
        before = Tree(options.revision, unpacked(options.revision, folders[0]), folders[1])
        now = Tree("working tree", ROOT, folders[2])
        for tree in (before, now):
            tree.check()
            tree.sweep(8)  # kernels are compiled here, not where it is measured
            tree.slalom()
        units, values = measure((before, now), rounds, cases)
    head = f"{options.revision:>12} {'now':>10}      times as fast (of the best)"
    print(f"{'':62}{head}")
    content = []
    for name, found in values.items():
        if len(found) < 2:
            continue
        old, new = found[before.name], found[now.name]
        ratio, of_best = compared(units[name], old, new)
        middle = [statistics.median(item) for item in (old, new)]
        print(
            f"{name:62}{middle[0]:>12.4g} {middle[1]:>10.4g} {units[name]:4} "
            f"{ratio:.2f} ({of_best:.2f})"
        )
        entry = {"name": name, "unit": units[name], "before": old, "now": new, "ratio": ratio}
        content.append(entry | {"ratio_of_best": of_best})
    if options.json:
        options.json.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
