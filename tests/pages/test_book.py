"""The documentation: every page has its place, links lead somewhere, formulas can be drawn."""

import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
GENERATED = DOCS / "reference"
PAGES = [p for p in sorted(DOCS.rglob("*.md")) if not p.is_relative_to(GENERATED)]
CODE = re.compile(r"```.*?```|`[^`\n]*`", re.DOTALL)
BLOCK_FORMULA, FORMULA = re.compile(r"\$\$(.*?)\$\$", re.DOTALL), re.compile(r"\$([^$]+)\$")


@pytest.fixture(scope="module", autouse=True)
def parts():
    """Make the package beside the pages importable, where what it needs is installed."""
    for name in ("sphinx", "ziamath"):
        pytest.importorskip(name)
    sys.path.insert(0, str(DOCS))
    yield
    sys.path.remove(str(DOCS))


def test_every_page_is_in_a_chapter():
    from sphinx_parts.links import contents

    found, waiting = {"index"}, ["index"]
    while waiting:
        page = waiting.pop()
        below = contents(page, (DOCS / f"{page}.md").read_text(encoding="utf-8"))
        found |= set(below)
        waiting += below
    assert found == {p.relative_to(DOCS).with_suffix("").as_posix() for p in PAGES}


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_links_lead_to_files(page):
    text = CODE.sub("", page.read_text(encoding="utf-8"))
    links = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text)
    assert [link for link in links if not (page.parent / link).exists()] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_formulas_can_be_drawn(page):
    from sphinx_parts.formulas import draw

    text = CODE.sub("", page.read_text(encoding="utf-8"))
    formulas = BLOCK_FORMULA.findall(text) + FORMULA.findall(BLOCK_FORMULA.sub("", text))
    for formula in formulas:
        assert "<svg" in draw(formula.strip(), as_block=False)


def test_formulas_that_cannot_be_drawn_are_told():
    from sphinx_parts.formulas import FormulaError, draw

    for wrong in (r"\omgea", r"\frac{1}{2"):
        with pytest.raises(FormulaError, match="formula"):
            draw(wrong, as_block=False)


def test_links_out_of_the_book_are_turned_inwards():
    from sphinx_parts.links import turn_inwards

    text = "[a](../systems/bicycle.yaml) [b](../systems) [c](../reports/validation.md) [d](e.md)"
    turned = turn_inwards(text, page=DOCS / "page.md", docs=DOCS)
    assert turned == ("[a](../systems/bicycle.yaml) `b` [c](reference/validation.md) [d](e.md)")
    deeper = turn_inwards(
        "[a](../loops.md) [b](../../README.md) [c](../../docs)", page=DOCS / "t/p.md", docs=DOCS
    )
    assert deeper == "[a](../loops.md) [b](../index.md) [c](../index.md)"


def test_docstrings_keep_their_equations():
    from sphinx_parts.docstrings import render

    text = "Force of |x| and a*b, x_ and ``c*d``.\n\nF = k x:\n    y = z\nand more.\n\n- one\n  two"
    assert render(text).splitlines() == [
        r"Force of \|x\| and a\*b, x\_ and ``c*d``.",
        "", "F = k x:", "", "    y = z", "", "and more.", "", "- one", "  two",
    ]  # fmt: skip


def test_reference_covers_commands_catalogues_and_files():
    from sphinx_parts import catalogues, commands, schemas

    import vehicledyn.catalogue
    from vehicledyn.base.registry import families, kinds

    vehicledyn.catalogue.counts()
    made = catalogues.pages()
    for family in {f for f in families() if not f.endswith("_type")} - {"model", "model_file"}:
        headings = re.findall(r"^## (\S+)$", made[f"catalogue_{family}"][0], re.MULTILINE)
        assert tuple(headings) == kinds(family)
    creep = made["catalogue_creep"][0]
    assert "| `friction_decay` (optional) | s/m |" in creep
    text = commands.pages()["commands"][0]
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    told = set(re.findall(r"^\| `(\w+)", readme, re.MULTILINE))
    assert told == set(re.findall(r"^## vehicledyn (\w+)$", text, re.MULTILINE))
    assert "| `--relative" in text
    scenario = schemas.pages()["scenario_files"][0]
    assert "| `manoeuvre` | [manoeuvre](#scenario-manoeuvre) | What the vehicle does |" in scenario
    assert "\n(scenario-manoeuvre)=\n" in scenario
