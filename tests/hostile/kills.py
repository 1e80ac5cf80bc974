"""Kills commands at random times and says what must not have been lost, or be taken for whole.

Half of the kills leave it to the command's own workers to end. Only those count that it did not
forestall by ending itself. Some that go on are killed once more and must not hold less then. What
is computed twice is measured by the processor time of the commands themselves: that behind the last
step that one kept, and that until the next one comes to a step that it does not know.

By hand: ``python tests/hostile/kills.py 200 [run sweep hunt ...]``.
"""

import itertools
import shutil
import sys
import tempfile
import time
import zipfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from clock import Clock
from damage import SCENARIO, STUDY, SYSTEMS
from mechanism_cases import CAM, STUDIES
from starting import start
from table_cases import LAYOUT, MOTION

LOST = 1.0  # s
TWICE = 1.5  # s of processor time: one second, as it is where others use the processor too
SAME = (".c", ".h", ".csv", ".json", ".dxf", ".yaml")
"""Files that are the same whenever they are written."""
KEPT = ".checkpoint"
"""Ending of what a computation goes on from, behind the name of its result."""
REFUSED = 2
ORPHANED = 20  # s
SLOW = 2.5  # how much slower a busy machine may be


@dataclass(frozen=True)
class Kill:
    """When a process was killed [s] and what part of the time it had the processor for."""

    at: float
    share: float

    def seconds_since(self, time):
        """Return the processor time since a time [s]: others have the rest on a busy machine."""
        return self.share * (self.at - time)


SWING = STUDIES["optimise-manoeuvre"]
for _old, _new in (
    ("scenarios/systems/double_pendulum.yaml", "short.yaml"),
    ("-5 N*m, to: 5 N*m, rate: 60", "-40 N*m, to: 40 N*m, rate: 900"),
    ("from: 0.1 s, to: 1 s, guess: 0.2 s", "from: 0.2 s, to: 2 s, guess: 0.6 s"),
    ("intervals: 4", "intervals: 40"),
    ("most_iterations: 4", "most_iterations: 200"),
):
    SWING = SWING.replace(_old, _new)


@dataclass(frozen=True)
class Victim:
    """A command, the file it writes, how it goes on with what a kill left, further files.

    ``codes`` are the exit codes of the whole: a search for a motion may end without an optimum.
    ``by_others`` says that other processes compute for it.
    """

    name: str
    command: list
    output: str
    go_on: list = field(default_factory=list)
    beside: tuple = ()
    codes: tuple = (0, 1)
    by_others: bool = False


VICTIMS = [
    Victim(
        "run", ["run", "long.yaml", "--no-plots", "-q", "-o", "r.h5"], "r.h5",
        ["--restart", "r.h5"],
    ),
    Victim(
        "sweep", ["sweep", "study.yaml", "--workers", "1", "-q", "-o", "s.h5"], "s.h5",
        ["--resume"],
    ),
    Victim(
        "sweep of two", ["sweep", "study.yaml", "--workers", "2", "-q", "-o", "s.h5"], "s.h5",
        ["--resume"], by_others=True,
    ),
    Victim(
        "hunt",
        ["hunt", str(SYSTEMS / "simple_wheelset.yaml"), "--from", "50 m/s", "--to", "70 m/s",
         "--points", "12", "--no-simulation", "--no-plots", "-o", "h.h5"], "h.h5", ["--resume"],
    ),
    Victim("equilibrium", ["equilibrium", "short.yaml", "-o", "b.h5"], "b.h5"),
    Victim("report", ["report", "short.h5", "-o", "p.html"], "p.html"),
    Victim("animate", ["animate", "short.h5", "-o", "a.html"], "a.html"),
    Victim("plot", ["plot", "short.h5", "-o", "figures"], "figures"),
    Victim("eig", ["eig", str(SYSTEMS / "quarter_car.yaml"), "-o", "m.h5"], "m.h5"),
    Victim(
        "eig along speeds",
        ["eig", str(SYSTEMS / "manchester_bogie.yaml"), "--speed", "5 m/s:60 m/s:12", "-o",
         "ms.h5"], "ms.h5", ["--resume"],
    ),
    Victim(
        "response",
        ["response", str(SYSTEMS / "quarter_car.yaml"), "--input", "road.height",
         "--output", "body.height", "-o", "f.h5"], "f.h5",
    ),
    Victim(
        "kinematics",
        ["kinematics", str(SYSTEMS / "four_bar.yaml"), "--drive",
         "crank.angle=-60 deg:300 deg:500", "--no-plots", "-o", "k.h5"], "k.h5", ["--resume"],
    ),
    Victim("optimise", ["optimise", "best.yaml", "-o", "o.h5"], "o.h5", ["--resume"]),
    Victim(
        "optimise-manoeuvre", ["optimise-manoeuvre", "swing.yaml", "-o", "w.h5"], "w.h5",
        ["--resume"],
    ),
    Victim("linearise", ["linearise", "short.yaml", "-u", "force:upper.angle", "-y", "upper.angle",
                         "-o", "l.npz"], "l.npz"),
    Victim(
        "inverse",
        ["inverse", str(SYSTEMS.parent / "scenarios/systems/slider_crank.yaml"), "--motion",
         "motion.csv", "--set", "duration=60 ms", "--set", "output.interval=0.02 ms",
         "--no-plots", "-o", "v.h5"], "v.h5", ["--resume"],
    ),
    Victim(
        "profiles", ["profiles", "S1002", "60E1", "--shift", "-7:7:200", "-o", "n.h5"], "n.h5",
        ["--resume"],
    ),
    Victim("track", ["track", "track.yaml", "-o", "q.h5"], "q.h5"),
    Victim("cam", ["cam", "cam.yaml", "-o", "c.h5"], "c.h5"),
    Victim("drawn cam", ["cam", "cam.yaml", "--profile", "c.dxf"], "c.dxf"),
    Victim("identify", ["identify", "known.yaml", "-o", "i.h5"], "i.h5", ["--resume"]),
    Victim("identify from figures", ["identify", "curves.yaml", "-o", "j.h5"], "j.h5",
           ["--resume"]),
    Victim("uncertainty", ["uncertainty", "scatter.yaml", "-o", "u.h5"], "u.h5", ["--resume"]),
    Victim(
        "sensitivity",
        ["sensitivity", "short.yaml", "--of", "max(lower.angle)", "--set", "duration=300 s",
         "--set", "output.interval=50 ms", "-o", "d.h5"], "d.h5", ["--resume"],
    ),
    Victim(
        "sensitivity of a critical speed",
        ["sensitivity", str(SYSTEMS / "manchester_bogie.yaml"), "--of", "critical_speed",
         "--speed", "20 m/s", "-o", "dc.h5"], "dc.h5", ["--resume"],
    ),
    Victim(
        "sensitivity of cycles",
        ["sensitivity", str(SYSTEMS / "simple_wheelset.yaml"), "--of", "cycle_period", "--speed",
         "60 m/s", "-o", "dd.h5"], "dd.h5", ["--resume"],
    ),
    Victim(
        "sensitivity of kinematics",
        ["sensitivity", str(SYSTEMS / "five_link_suspension.yaml"), "--of",
         "kinematics(wheel.toe_angle, wheel.z, 236 mm:396 mm:100)", "--to", "*.z", "-o", "dk.h5"],
        "dk.h5", ["--resume"],
    ),
    Victim(
        "steady", ["steady", "small_car", "--speed", "90 km/h", "-o", "t.h5"], "t.h5",
        ["--resume"],
    ),
    Victim("steady page", ["steady", "small_car", "--report", "t.html"], "t.html"),
    Victim(
        "rig", ["rig", "wishbone_arms_axle", "--test", "parallel", "--no-plots", "-o", "x.h5"],
        "x.h5", ["--resume"],
    ),
    Victim(
        "handling", ["handling", "small_car", "-o", "y.h5", "--report", "y.html"], "y.h5",
        ["--resume"], beside=("y.html",),
    ),
    Victim(
        "export C", ["export", "double_pendulum.yaml", "--to", "c", "-o", "e.c"], "e.c",
        beside=("e.h",),
    ),
    Victim("export FMU", ["export", "short.yaml", "--to", "fmu", "-o", "fmus"], "fmus"),
    Victim("tyre", ["tyre", "passenger_R0394_mf61.tir", "-o", "g.h5"], "g.h5"),
    Victim("table", ["export-data", "short.h5", "-o", "e.csv"], "e.csv"),
    Victim("schema", ["schema", "-o", "e.json"], "e.json"),
    Victim("init", ["init", "project"], "project"),
]  # fmt: skip


CURVES = """\
experiments:
  shaker:
    scenario: shaker.yaml
    data: shaker.csv
    figures:
      gain(body.height, road.height): {over: f, column: gain, noise: 0.05}
      max(strut.force): {value: 1.6 kN, noise: 100 N}
parameters:
  body.stiffness: {from: 5 kN/m, to: 60 kN/m}
"""


class Campaign:
    """Commands in folders of their own, killed after a part of the time that they take."""

    def __init__(self, folder, seed=14):
        self._folder, self._random = Path(folder), np.random.default_rng(seed)
        self._seconds, self._whole, self.twice = {}, {}, {}
        self.kills = 0
        shutil.copy(SYSTEMS / "double_pendulum.yaml", self._folder)
        measured = "\n".join(f"{k / 100},{0.1 * k % 0.7}" for k in range(100))
        texts = {
            "measured.csv": f"time [s],upper.angle [rad]\n{measured}\n",
            "known.yaml": STUDIES["identify"]
            .replace("scenarios/systems/double_pendulum.yaml", "short.yaml")
            .replace("duration: 20 ms", "duration: 1 s"),
            "curves.yaml": CURVES,
            "shaker.yaml": "title: A quarter car\nmodel: quarter_car\nduration: 3 s\n"
            "solver: {kind: rk4, step: 1 ms}\noutput: {interval: 10 ms}\n",
            "shaker.csv": "f [Hz], gain [1]\n1, 1.8\n2, 1.0\n5, 0.2\n",
            "scatter.yaml": STUDIES["uncertainty"]
            .replace("scenarios/systems/double_pendulum.yaml", "short.yaml")
            .replace("duration: 20 ms", "duration: 2 s")
            .replace("number: 4", "number: 64"),
            "swing.yaml": SWING,
            "motion.csv": MOTION,
            "track.yaml": LAYOUT,
            "short.yaml": SCENARIO,
            "long.yaml": SCENARIO.replace("3 s", "300 s"),
            "best.yaml": STUDIES["optimise"]
            .replace("scenarios/systems/double_pendulum.yaml", "short.yaml")
            .replace("duration: 20 ms", "duration: 1 s")
            .replace("most_runs: 4", "most_runs: 40"),
            "cam.yaml": CAM,
            "study.yaml": STUDY.replace("number: 24", "number: 100").replace("0.2 s", "2 s"),
        }
        for name, text in texts.items():
            (self._folder / name).write_text(text, encoding="utf-8")
        start(self._folder, ["run", "short.yaml", "--no-plots", "-q", "-o", "short.h5"]).wait()

    def kill(self, victim, *, go_on):
        """Kill a command once, begun again where it ended too soon; return what is wrong then."""
        if victim.name not in self._seconds:
            self._measure(victim)
        while True:
            folder, clock = self._copy(), Clock()
            process, kill = self._killed(victim, folder, [], clock)
            if kill:
                break
            shutil.rmtree(folder, ignore_errors=True)
        faults = [*_orphans(process), *self._faults(victim, folder, kill)]
        if go_on and not faults:
            faults += self._gone_on(victim, folder, clock.lost(process.seconds))
        shutil.rmtree(folder, ignore_errors=True)
        return faults

    def _killed(self, victim, folder, words, clock):
        """Start a command and kill it; return its process and the kill, None where it had ended."""
        process = start(folder, [*victim.command, *words], clock.change)
        time.sleep(self._random.uniform(0.0, self._seconds[victim.name]))
        at = time.time()
        is_hit = process.kill(with_children=self._random.random() < 0.5)
        self.kills += is_hit
        share = 1.0 if victim.by_others else process.share
        return process, Kill(at, share) if is_hit else None

    def _copy(self):
        folder = Path(tempfile.mkdtemp(dir=self._folder))
        for path in self._folder.iterdir():
            if path.is_file():
                shutil.copy(path, folder)
        return folder

    def _measure(self, victim):
        for _ in range(2):  # the first time it is compiled
            folder = self._copy()
            begin = time.time()
            code = start(folder, victim.command).wait()
            self._seconds[victim.name] = time.time() - begin
            assert code in victim.codes, (victim.name, code)
        self._whole[victim.name] = folder / victim.output

    def _faults(self, victim, folder, kill):
        path = folder / victim.output
        before = {p.name for p in self._folder.iterdir() if p.is_file()}
        others = {p.name for p in folder.iterdir() if not p.name.startswith(".")} - before
        extra = {victim.output, victim.output + KEPT}
        extra |= set(victim.beside)
        if others - extra:
            yield f"leaves {sorted(others - extra)}"
        files = [path] if path.is_file() else list(path.rglob("*"))
        for file in [*files, *(folder / name for name in victim.beside)]:
            if file.is_file() and not file.name.startswith("."):
                yield from self._cut_off(file, self._whole[victim.name].parent, folder)
        if path.is_file() and path.suffix == ".h5":
            yield from self._faults_of_result(victim, path, kill)

    def _cut_off(self, file, whole, folder):
        known = whole / file.relative_to(folder)
        if file.stat().st_size == 0:
            yield f"{file.name} is empty"
        elif (
            (file.suffix == ".html" and not file.read_text("utf-8").rstrip().endswith("html>"))
            or (file.suffix == ".png" and not file.read_bytes().endswith(b"IEND\xaeB`\x82"))
            or (file.suffix == ".fmu" and not zipfile.is_zipfile(file))
            or (file.suffix in SAME and file.read_bytes() != known.read_bytes())
        ):
            yield f"{file.name} is cut off"

    def _faults_of_result(self, victim, path, kill):
        from vehicledyn.base.errors import InputError
        from vehicledyn.results.store.reader import open_result
        from vehicledyn.results.store.study_reader import open_study

        code = start(path.parent, ["info", path.name]).wait()
        if code:
            yield f"info leaves with {code}"
        try:
            if victim.name == "run":
                with open_result(path) as result, open_result(self._whole["run"]) as whole:
                    count = len(result.time)
                    lost = kill.seconds_since(path.stat().st_mtime) if kill else 0.0
                    if not result.is_whole and count and lost > SLOW * LOST:
                        yield f"the last {lost:.1f} s are lost"
                    if result.is_whole and count != len(whole.time):
                        yield "is taken for whole"
                    for name in result.channels:
                        known = whole.channel(name).values[:count]
                        if not np.array_equal(result.channel(name).values, known):
                            yield f"{name} is wrong"
            elif victim.name.startswith("sweep"):
                with open_study(path) as study:
                    if study.is_whole and study.counts()["pending"]:
                        yield "is taken for whole"
        except InputError as error:
            yield str(error)

    def _gone_on(self, victim, folder, lost):
        """Go on with what was left, or begin again where that cannot be, and compare the ends."""
        path, whole = folder / victim.output, self._whole[victim.name]
        words = victim.go_on if self._is_begun(victim, path) else []
        if self._random.random() < 0.5:
            before, clock = self._held(victim, path), Clock()
            process, kill = self._killed(victim, folder, words, clock)
            yield from [*_orphans(process), *self._faults(victim, folder, None)]
            if (held := self._held(victim, path)) < before:
                yield f"held {before} parts and, when it was killed going on, {held}"
            yield from self._twice(victim, lost, clock)
            lost = clock.lost(process.seconds) if kill else 0.0
            words = victim.go_on if self._is_begun(victim, path) else []
        clock = Clock()
        code = start(folder, [*victim.command, *words], clock.change).wait()
        if code == REFUSED and not words:
            code = start(folder, [*victim.command, "--overwrite"]).wait()  # an unfinished run
        if code not in victim.codes:
            yield f"cannot be continued: exit code {code}"
            return
        yield from self._faults(victim, folder, None)
        yield from self._twice(victim, lost, clock)
        left = [item.name for item in folder.rglob("*") if item.name.startswith(".")]
        left += [item.name for item in folder.glob(f"*{KEPT}")]
        missing = [name for name in (victim.output, *victim.beside) if not (folder / name).exists()]
        if left or missing:
            yield f"leaves {left} and lacks {missing} when it has gone on"
        if path.suffix == ".h5":
            shutil.copy(whole, folder / "whole.h5")
            if start(folder, ["compare", path.name, "whole.h5"]).wait():
                yield "differs from a run in one piece"

    def _twice(self, victim, lost, clock):
        """Yield whether too much was computed twice: what was lost, and what is between steps."""
        self.twice[victim.name] = max(self.twice.get(victim.name, 0.0), lost + clock.repeated)
        if lost + clock.repeated > TWICE:
            words = f"{lost:.2f} s behind the last step, {clock.repeated:.2f} s before the next"
            yield f"computes too much twice: {words}"

    def _held(self, victim, path):
        """Return how many samples, cases or bytes of steps it can go on with."""
        from vehicledyn.results.store.reader import open_result
        from vehicledyn.results.store.study_reader import open_study

        if victim.name == "run" and path.exists():
            with open_result(path) as result:
                history = result.history(np.inf)
                return 0 if history is None else int((result.time[:] <= history.time).sum())
        if victim.name.startswith("sweep") and path.exists():
            with open_study(path) as study:
                return sum(study.counts().values()) - study.counts()["pending"]
        steps = Path(f"{path}{KEPT}")
        if steps.exists():
            return steps.stat().st_size
        return np.inf if path.exists() else 0  # at its end

    def _is_begun(self, victim, path):
        """Return whether there is something to go on with."""
        from vehicledyn.results.store.reader import open_result

        if victim.name == "run" and path.exists():
            with open_result(path) as result:
                return not result.is_whole and len(result.time) > 0
        return path.exists() or Path(f"{path}{KEPT}").exists()


def _orphans(process):
    """Yield whether processes outlive the one that started them."""
    end = time.monotonic() + ORPHANED
    while process.has_children():
        if time.monotonic() > end:
            process.kill_children()
            yield f"its workers live on for {ORPHANED} s"
            return
        time.sleep(0.05)


def main():
    """Kill all or the named commands in turn as often as asked for; print what went wrong."""
    import warm

    warm.up()
    count, bad = int(sys.argv[1]), 0
    victims = [v for v in VICTIMS if v.name in sys.argv[2:] or not sys.argv[2:]]
    with tempfile.TemporaryDirectory() as folder:
        campaign = Campaign(folder)
        for number in itertools.count():
            victim = victims[number % len(victims)]
            for fault in campaign.kill(victim, go_on=number // len(victims) % 3 == 0):
                bad += 1
                print(f"kill {campaign.kills}, {victim.name}: {fault}", flush=True)  # noqa: T201
            if campaign.kills >= count:
                break
            if number % 10 == 9:
                print(f"{campaign.kills} kills, {bad} faults", flush=True)  # noqa: T201
    worst = sorted(campaign.twice.items(), key=lambda item: -item[1])
    listed = ", ".join(f"{name} {seconds:.2f}" for name, seconds in worst)
    print(f"{campaign.kills} kills, {bad} faults; most computed twice [s]: {listed}")  # noqa: T201
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
