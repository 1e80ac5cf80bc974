"""Exit codes follow from how a result ended; nothing below the command line knows them."""

import re
from pathlib import Path
from types import SimpleNamespace

import pytest

import vehicledyn
from vehicledyn.base.errors import InputError, Interrupted, UnknownNameError
from vehicledyn.cli.exit_codes import code_of_error, code_of_result
from vehicledyn.cli.performing import perform

PACKAGE = Path(vehicledyn.__file__).parent


@pytest.mark.parametrize(
    ("status", "failed", "code"),
    [("ok", 0, 0), ("ok", 2, 5), ("derailed", 0, 1), ("partial", 0, 3), ("failed", 2, 3),
     ("interrupted", 0, 130)],
)  # fmt: skip
def test_codes_of_results(status, failed, code):
    report = SimpleNamespace(counts={"failed": failed})
    assert code_of_result(SimpleNamespace(status=status, report=report)) == code


def test_codes_of_errors():
    assert code_of_error(UnknownNameError("no such name")) == 2
    assert code_of_error(vehicledyn.NumericalError("diverges")) == 3


def test_a_stopped_analysis_gives_what_it_has():
    def stopped(*, progress):
        raise Interrupted("partial")

    assert perform(stopped) == "partial"


def test_place_for_figures_is_checked_before_the_run(tmp_path):
    (tmp_path / "taken").touch()
    with pytest.raises(InputError, match="is a file; choose another folder"):
        perform(lambda **_: pytest.fail("was run"), plots=tmp_path / "taken")


def test_nothing_below_the_command_line_knows_exit_codes():
    word = re.compile(r"exit_?code|\bEXIT_")
    found = [
        f"{path.relative_to(PACKAGE)}: {line.strip()}"
        for path in PACKAGE.rglob("*.py")
        if "cli" not in path.relative_to(PACKAGE).parts
        for line in path.read_text(encoding="utf-8").splitlines()
        if word.search(line)
    ]
    assert found == []
