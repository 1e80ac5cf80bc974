"""What the benchmarks import from the package is there; most of them run by hand only."""

import ast
import importlib
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[3] / "benchmarks"


def imported(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("vehicledyn"):
            yield from ((node.module, item.name) for item in node.names)


def is_there(module, name):
    try:
        return hasattr(importlib.import_module(module), name) or bool(
            importlib.import_module(f"{module}.{name}")
        )
    except ModuleNotFoundError:
        return False


@pytest.mark.parametrize("path", sorted(FOLDER.rglob("*.py")), ids=lambda path: path.name)
def test_benchmarks_import_what_exists(path):
    assert [wanted for wanted in imported(path) if not is_there(*wanted)] == []
