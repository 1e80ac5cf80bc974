"""The campaign: so many cases of each kind, over some processes, and a table of what happened."""

import multiprocessing
import random
from collections import Counter, defaultdict
from dataclasses import dataclass, field

import analysed_cases
import command_cases
import finite_element_cases
import harness
import mechanism_cases
import result_cases
import resume_cases
import road_file_cases
import table_cases
import warm
import yaml_cases

KINDS = {
    "scenario": yaml_cases.scenario,
    "system": yaml_cases.system,
    "study": yaml_cases.study,
    "option": yaml_cases.option,
    "command": command_cases.command,
    "expression": yaml_cases.expression,
    "profile": table_cases.profile,
    "track": table_cases.track,
    "road": table_cases.road,
    "opencrg": road_file_cases.opencrg,
    "tyre": road_file_cases.tyre,
    "motion": table_cases.motion,
    "cases": table_cases.cases_table,
    "result": result_cases.result,
    "table": result_cases.table,
    "resumed": resume_cases.resumed,
    "cam": mechanism_cases.cam,
    "ground": mechanism_cases.ground,
    "driven": mechanism_cases.driven,
    "beam": mechanism_cases.beam,
    "finite_elements": finite_element_cases.finite_elements,
    "gradient_study": mechanism_cases.gradient_study,
    "analysed": analysed_cases.analysed,
    "fitted": analysed_cases.fitted,
}
TOLD = 200  # cases after which a long campaign says how far it is
FEWEST_JUDGED, LEAST_WHOLE = 30, 0.01
"""Cases of a kind from which on a share at least must succeed: else nothing behind its first check
is attacked."""
WEIGHTS = {"scenario": 3, "system": 3, "option": 2, "result": 4, "table": 2, "analysed": 2}


@dataclass
class Table:
    """Exit codes, the longest time and the most memory by kind, and what failed."""

    codes: dict = field(default_factory=lambda: defaultdict(Counter))
    seconds: dict = field(default_factory=lambda: defaultdict(float))
    memory: dict = field(default_factory=lambda: defaultdict(int))
    failures: list = field(default_factory=list)

    @property
    def total(self):
        """Cases so far."""
        return sum(counter.total() for counter in self.codes.values())

    def enter(self, kind, number, code, signal, seconds, memory, faults):
        self.codes[kind][f"signal {signal}" if signal else str(code)] += 1
        self.seconds[kind] = max(self.seconds[kind], seconds)
        self.memory[kind] = max(self.memory[kind], memory)
        if faults:
            self.failures.append((kind, number, "; ".join(faults)))

    def judge(self):
        """Enter a failure of each kind that hardly ever succeeds."""
        for kind, codes in self.codes.items():
            enough = max(1.0, LEAST_WHOLE * codes.total())
            if codes.total() >= FEWEST_JUDGED and codes["0"] < enough:
                words = f"{codes['0']} of {codes.total()} cases succeed: its cases are worn out"
                self.failures.append((kind, 0, words))
        self.failures.sort()

    def as_text(self, wall):
        lines = [f"{self.total} cases in {wall:.0f} s, {len(self.failures)} failed"]
        for kind, codes in self.codes.items():
            shown = ", ".join(f"{code}: {count}" for code, count in sorted(codes.items()))
            lines.append(
                f"  {kind:10} {codes.total():6} cases, at most {self.seconds[kind]:5.2f} s and "
                f"{self.memory[kind] / 2**20:4.0f} MiB; exit codes {shown}"
            )
        lines += [f"FAILED {kind} {number}: {words}" for kind, number, words in self.failures]
        return "\n".join(lines)


def case_of(kind, number):
    """Return a case, which follows from its kind and number alone."""
    return KINDS[kind](random.Random(f"{kind} {number}"), f"{kind} {number}")


def shares(number, kinds=None):
    """Return how many cases each kind gets."""
    chosen = kinds or list(KINDS)
    whole = sum(WEIGHTS.get(kind, 1) for kind in chosen)
    return {kind: max(1, number * WEIGHTS.get(kind, 1) // whole) for kind in chosen}


def attack(number, *, first=0, kinds=None, processes=2, keep=None, tell=None):
    """Run a campaign and return its table."""
    warm.up()
    counts = shares(number, kinds)
    if counts.keys() & {"result", "table", "resumed", "command"}:
        result_cases.seeds()
    numbered = [(kind, k) for kind, count in counts.items() for k in range(first, first + count)]
    random.Random(1).shuffle(numbered)
    table = Table()
    context = multiprocessing.get_context("fork")
    with context.Pool(processes, initializer=_begin, initargs=(keep,)) as pool:
        for found in pool.imap_unordered(_attack_one, numbered, chunksize=4):
            table.enter(*found)
            if tell is not None and table.total % TOLD == 0:
                tell(f"{table.total} of {len(numbered)} cases")
            if tell is not None and found[-1]:
                tell(f"FAILED {found[0]} {found[1]}: {'; '.join(found[-1])}")
    table.judge()
    return table


_KEEP = []


def _begin(keep):
    _KEEP.append(keep)


def _attack_one(item):
    kind, number = item
    outcome = harness.run(case_of(kind, number), keep=_KEEP[0])
    return (
        kind, number, outcome.code, outcome.signal, outcome.seconds, outcome.memory,
        outcome.faults,
    )  # fmt: skip
