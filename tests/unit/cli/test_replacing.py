"""Verbs replace what they can compute again, and say so; everything else is kept."""

import h5py
import numpy as np
import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.cli import verbs
from vehicledyn.cli.replacing import HUNT, MODES, RUN, STUDY, check_replacing
from vehicledyn.cli.terminal import is_quiet, set_quiet


@pytest.fixture(autouse=True)
def aloud():
    """Another test of the same process may have called a verb with --quiet."""
    set_quiet(False)


@pytest.fixture
def result(tmp_path):
    def write(kind, status="ok"):
        path = tmp_path / "result.h5"
        with h5py.File(path, "w") as file:
            file.attrs.update(
                {"format": kind, "status": status, "created": "2026-11-22", "title": "A run"}
            )
        return path

    return write


@pytest.mark.parametrize("status", ["ok", "failed"])
@pytest.mark.parametrize("kind", [RUN, MODES])
def test_results_that_ended_are_replaced_and_said_so(result, capsys, kind, status):
    path = result(kind, status)
    check_replacing(path, kind)
    assert f"{path}: replacing the result of 2026-11-22, 'A run'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("found", "wanted", "status", "words"),
    [
        (RUN, RUN, "interrupted", "holds an unfinished run;"),
        (RUN, RUN, "running", "holds an unfinished run;"),
        (STUDY, STUDY, "ok", "holds a study; continue it with --resume"),
        (HUNT, HUNT, "ok", "holds a study; continue it with --resume"),
        (STUDY, RUN, "ok", "holds a sweep, not a run"),
        (RUN, HUNT, "ok", "holds a run, not a hunting study"),
        ("other", RUN, "ok", "holds other, not a run"),
    ],
)
def test_everything_else_is_kept(result, found, wanted, status, words):
    path = result(found, status)
    with pytest.raises(InputError, match=f"{words}.*choose another output with -o, or use --over"):
        check_replacing(path, wanted)
    check_replacing(path, wanted, overwrite=True)


def test_a_run_that_was_killed_before_its_first_sample_is_replaced(result):
    """There is nothing to lose, and nothing that '--restart' could go on from."""
    path = result(RUN, "running")
    with h5py.File(path, "a") as file:
        file["time"] = np.zeros(0)
    check_replacing(path, RUN, goes_on_by="--restart")
    with h5py.File(path, "a") as file:
        del file["time"]
        file["time"] = np.zeros(1)
    with pytest.raises(InputError, match="holds an unfinished run"):
        check_replacing(path, RUN, goes_on_by="--restart")


def test_unfinished_runs_are_gone_on_with_where_the_verb_can(result):
    path = result(RUN, "running")
    with pytest.raises(InputError, match=r"unfinished run; continue it with '--restart .*'"):
        check_replacing(path, RUN, goes_on_by="--restart")
    with pytest.raises(InputError, match="unfinished run; choose another output"):
        check_replacing(path, RUN)


def test_unreadable_results_are_kept(tmp_path):
    path = tmp_path / "result.h5"
    path.write_bytes(b"\x89HDF\r\n\x1a\n and nothing more")
    with pytest.raises(InputError, match="exists and is not a readable result"):
        check_replacing(path, RUN)


def test_nothing_is_said_where_nothing_is_lost(tmp_path, capsys):
    check_replacing(tmp_path / "new.h5", RUN)
    (tmp_path / "empty.h5").touch()
    check_replacing(tmp_path / "empty.h5", RUN)
    assert not capsys.readouterr().err


def test_studies_are_gone_on_with_or_begun_anew(result):
    path = result(STUDY)
    check_replacing(path, STUDY, resume=True)
    with pytest.raises(InputError, match="choose one"):
        check_replacing(path, STUDY, resume=True, overwrite=True)


def test_quiet_verbs_say_nothing(result, capsys):
    set_quiet(True)
    try:
        check_replacing(result(RUN), RUN)
    finally:
        set_quiet(False)
    assert not capsys.readouterr().err


def test_the_option_makes_one_verb_quiet(result):
    app, path = verbs.command_line(["run"]), result(STUDY)
    for option, expected in ((["-q"], True), ([], False)):
        with pytest.raises(InputError, match="holds a sweep"):
            app(["run", "double_pendulum", "-o", str(path), *option], standalone_mode=False)
        assert is_quiet() is expected
