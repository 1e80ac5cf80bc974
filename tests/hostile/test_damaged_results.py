"""Damaged results of every kind are refused or read right: no hang, no traceback, no wrong sample.

By hand with more cases: set VEHICLEDYN_HOSTILE_CASES, such as 300 for each kind of file.
"""

import os

import pytest
from damage import COMMANDS, cases, silently_wrong, write_originals
from harness import run

pytestmark = pytest.mark.xdist_group("hostile")  # warmed up once

COUNT = int(os.environ.get("VEHICLEDYN_HOSTILE_CASES", "24"))


@pytest.fixture(scope="module")
def originals(tmp_path_factory):
    folder = tmp_path_factory.mktemp("originals")
    return {name: (folder / name).read_bytes() for name in write_originals(folder)}


@pytest.mark.parametrize("name", [*COMMANDS, "killed.h5", "killed_study.h5"])
def test_damaged_files_are_refused_or_read_right(originals, name):
    faults = []
    for case in cases(name, originals[name], COUNT):
        outcome = run(case)
        if silently_wrong(outcome):
            outcome.faults.append("silently wrong")
        if outcome.faults:
            faults.append((case.name, outcome.faults, outcome.text[-300:]))
    assert not faults
