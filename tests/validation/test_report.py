"""The stored report shows what the program computes today."""

import importlib.util
from pathlib import Path

import pytest
from reference_cases.groups import GROUPS, computed
from reference_cases.motions import is_compiled

import vehicledyn

REPORTS = Path(__file__).parents[2] / "reports"
COMPUTED = 3  # column of figures whose last digits may differ between processors

pytestmark = [pytest.mark.validation, pytest.mark.xdist_group("comparisons")]  # computed once


@pytest.fixture(scope="module")
def generator():
    specification = importlib.util.spec_from_file_location("generate", REPORTS / "generate.py")
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def page():
    return (REPORTS / "validation.md").read_text(encoding="utf-8")


def test_rows_and_verdicts(generator, page):
    if not is_compiled():
        pytest.skip("without a compiler the runs of the report take minutes")
    stored = [_steady(row) for row in generator.table_rows(page)]
    rows = [row for name in GROUPS for row in computed(name).rows]
    assert stored == [_steady(generator.cells(row)) for row in rows]


def test_nothing_is_out_of_its_band(generator, page):
    rows = generator.table_rows(page)
    assert len(rows) >= 100
    assert {row[-1] for row in rows} == {"PASS"}


def test_version_and_figures(page):
    assert f"Version {vehicledyn.__version__}." in page
    shown = {line.split("(figures/")[1].rstrip(")") for line in page.splitlines() if "![" in line}
    assert len(shown) == 6
    assert shown <= {path.name for path in (REPORTS / "figures").iterdir()}


def _steady(cells):
    return cells[:COMPUTED] + cells[COMPUTED + 1 :]
