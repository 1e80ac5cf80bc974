"""A thousand spoilt inputs of every kind: refused or computed, and nothing else.

``python tests/hostile --number 100000 --processes 8`` does the same at length.
"""

import os
from pathlib import Path

import campaign
import harness
import programs
import pytest
import watch

pytestmark = pytest.mark.xdist_group("hostile")  # warmed up once

FOLDER = Path(__file__).parent


@pytest.mark.hostile
def test_the_program_holds(monkeypatch):
    """In a small process of its own: a fork of the test runner costs as much as ten cases."""
    monkeypatch.setattr(programs, "TIMEOUT", 1200)
    command = ["python", FOLDER, "--number", "1000", "--processes", "1"]
    done = programs.call(command, FOLDER.parents[1])
    assert done.returncode == 0, done.stdout + done.stderr


WITH_TIMES = ("result", "table", "resumed", "command")
"""Kinds whose seeds hold the time at which they were computed."""


def test_cases_follow_from_their_numbers():
    for kind in campaign.KINDS:
        if kind not in WITH_TIMES:
            first, again = campaign.case_of(kind, 7), campaign.case_of(kind, 7)
            assert (first.command, first.files) == (again.command, again.files)
            other = campaign.case_of(kind, 8)
            assert (other.command, other.files) != (first.command, first.files)


def test_a_kind_that_hardly_ever_succeeds_is_a_failure():
    table = campaign.Table()
    for kind, code in (("worn", 2), ("sharp", 0)):
        for number in range(campaign.FEWEST_JUDGED):
            table.enter(kind, number, code if number == 0 else 2, 0, 0.1, 1, [])
    table.judge()
    assert table.failures == [("worn", 0, "0 of 30 cases succeed: its cases are worn out")]


@pytest.mark.parametrize(
    ("program", "fault"),
    [
        ("import os; os.kill(os.getpid(), 11)", "killed by signal 11"),
        ("raise SystemExit(70)", "exit code 70"),
        ("raise ValueError('no')", "exit code 99"),
        ("raise SystemExit(2)", "exit code 2 without a word"),
        ("print('x' * 300_000)", "letters of output"),
        ("import pathlib; pathlib.Path('rest.tmp').write_text('')", "leaves rest.tmp"),
        ("import warnings; warnings.warn('no')", "a warning of Python's"),
        ("x = b'1' * (200 << 20); del x", "MiB of memory"),
        ("import time; time.sleep(99)", "hangs"),
        ("import os; os.fork() or __import__('time').sleep(99); os.wait()", "hangs"),
    ],
)
def test_the_harness_sees_faults(monkeypatch, program, fault):
    monkeypatch.setattr(watch, "LOOK_SECONDS", 0.05)
    monkeypatch.setattr(watch, "ASLEEP_SECONDS", 0.3)

    def call(_):
        try:
            exec(program)
        except SystemExit as end:
            return end.code
        return 0

    monkeypatch.setattr(harness, "call", call)
    monkeypatch.setattr(harness, "MOST_MEMORY", 300 << 20)
    outcome = harness.run_alone(harness.Case("fault", {}, []))
    assert any(fault in found for found in outcome.faults), outcome


WORK = """
import os, time
for _ in range({steps}):
    end = time.process_time() + 0.05
    while time.process_time() < end: pass
    {step}
"""


@pytest.mark.parametrize(
    ("step", "steps", "code", "faults"),
    [
        ("open('out.h5', 'w').close()", 2, 0, []),
        ("open('out.h5', 'w').close()", 99, 130, []),
        ("pass", 99, 130, ["more than 0.5 s of processor time, and nothing kept lately"]),
        ("os.path.exists('out.h5') or open('out.h5', 'w').close()", 99, 130,
         ["more than 0.5 s of processor time, and nothing kept lately"]),
    ],
)  # fmt: skip
def test_long_work_is_interrupted_and_must_have_kept_what_it_did(
    monkeypatch, step, steps, code, faults
):
    def call(_):
        try:
            exec(WORK.format(step=step, steps=steps))
        except KeyboardInterrupt:
            os.write(1, b"stopped")
            return 130
        return 0

    monkeypatch.setattr(harness, "call", call)
    monkeypatch.setattr(harness, "PROCESSOR_SECONDS", 0.5)
    case = harness.Case("work", {}, [], ("out.h5",))
    company = harness.Company()
    try:
        found = company.run(case)
    finally:
        company.end()
    assert (found.code, found.faults) == (code, faults)


def test_work_that_cannot_be_interrupted_is_a_fault(monkeypatch):
    monkeypatch.setattr(harness, "PROCESSOR_SECONDS", 0.5)
    monkeypatch.setattr(harness, "SECONDS_TO_END", 1)
    deaf = "import signal\nsignal.signal(signal.SIGPROF, signal.SIG_IGN)\nwhile True: pass"
    monkeypatch.setattr(harness, "call", lambda _: exec(deaf))
    outcome = harness.run_alone(harness.Case("deaf", {}, []))
    assert outcome.faults == ["more than 0.5 s of processor time"]


@pytest.mark.parametrize("wait", ["", "os.fork() and (os.wait(), os._exit(0))"])
def test_what_wants_the_processor_does_not_hang(monkeypatch, wait):
    """However long it takes to get it; its own children may do the work."""
    busy = "while time.process_time() < end: pass"
    program = f"import os, time\n{wait}\nend = time.process_time() + 0.5\n{busy}"
    monkeypatch.setattr(watch, "LOOK_SECONDS", 0.02)
    monkeypatch.setattr(watch, "ASLEEP_SECONDS", 0.3)
    monkeypatch.setattr(harness, "call", lambda _: exec(program) or 0)
    assert harness.run_alone(harness.Case("busy", {}, [])).faults == []


def test_cases_in_company_are_as_alone(monkeypatch, tmp_path):
    """Folder, variables, output, time and memory are each one's own; a fault is one alone too."""

    def call(command):
        exec(command[0])
        return 0

    monkeypatch.setattr(harness, "call", call)
    monkeypatch.setattr(harness, "MOST_MEMORY", 300 << 20)
    programs = [
        "import os; print(os.environ.get('LEFT'), os.listdir()); os.environ['LEFT'] = 'here'",
        "import os; print(os.environ.get('LEFT'), os.listdir()); os.chdir('/')",
        "import os; os.kill(os.getpid(), 11)",
        "x = b'1' * (200 << 20); del x",
        "import os; print(os.environ.get('LEFT'), os.listdir())",
    ]
    company = harness.Company()
    try:
        found = [company.run(harness.Case("case", {"a": b""}, [text])) for text in programs]
    finally:
        company.end()
    whole = [outcome for outcome in found if not outcome.faults]
    assert [outcome.text for outcome in whole] == ["None ['a']\n"] * 3
    assert max(outcome.memory for outcome in whole) < min(300 << 20, found[3].memory)
    assert found[2].faults == ["killed by signal 11"]
    assert "MiB of memory" in found[3].faults[0]
