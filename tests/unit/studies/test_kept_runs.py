"""Runs that a stopped study has kept: damaged lines are computed again, refusals leave no file."""

import json

import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.studies.kept_runs import KeptRuns


def kept(path, resume=True):
    return KeptRuns(path, ["a study"], resume=resume)


def test_a_study_that_is_refused_before_its_first_run_leaves_no_file(tmp_path):
    path = tmp_path / "out.h5.runs.jsonl"
    kept(path, resume=False)
    assert not path.exists()


def test_runs_are_recalled_and_damaged_ones_computed_again(tmp_path):
    path = tmp_path / "out.h5.runs.jsonl"
    first = kept(path, resume=False)
    for number in range(3):
        first.entry([number], lambda number=number: {"value": 1.5 * number, "2": [0.1, None]})
    lines = path.read_text(encoding="utf-8").splitlines()
    broken = lines[2].replace("1.5", "1.6")
    assert broken != lines[2]
    path.write_text("\n".join([lines[0], lines[1], broken, lines[3][:-9]]), encoding="utf-8")
    again = kept(path)
    assert again.n_known == 1
    assert again.entry([0], lambda: {})["value"] == 0.0
    assert again.entry([1], lambda: {"value": 7})["value"] == 7
    assert kept(path).n_known == 2


def test_runs_of_another_study_are_refused(tmp_path):
    path = tmp_path / "out.h5.runs.jsonl"
    path.write_text(json.dumps({"study": "another"}) + "\n", encoding="utf-8")
    with pytest.raises(InputError, match="holds runs of another study"):
        kept(path)


@pytest.mark.parametrize("length", [0, 1, 30])
def test_what_a_kill_leaves_of_the_first_line_is_no_other_study(tmp_path, length):
    path = tmp_path / "out.h5.runs.jsonl"
    kept(path, resume=False).entry([0], lambda: {"value": 1})
    path.write_bytes(path.read_bytes()[:length])
    again = kept(path)
    assert again.entry([0], lambda: {"value": 2})["value"] == 2
    assert kept(path).n_known == 1
