"""The package imports nothing that ``pip install`` does not bring, or an extra that it names."""

import ast
import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[3]
_IMPORTED_AS = {"ruamel.yaml": "ruamel"}
_BROUGHT = {"pydantic": "pydantic_core"}
"""Packages whose very version another one asks for."""


def _declared():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    own = ("cluster", "xarray", "parquet", "control", "mdf")
    lines = [*project["dependencies"], *(line for extra in own for line in extras[extra])]
    names = {re.match(r"[\w.-]+", line).group() for line in lines}
    return {_IMPORTED_AS.get(name, name) for name in names} | {
        _BROUGHT[n] for n in names & {*_BROUGHT}
    }


def _imported(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (item.name.partition(".")[0] for item in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module.partition(".")[0]


def test_every_import_is_declared():
    own = {*sys.stdlib_module_names, "vehicledyn", *_declared()}
    found = {
        f"{path.relative_to(ROOT)}: {name}"
        for path in (ROOT / "vehicledyn").rglob("*.py")
        for name in _imported(path)
        if name not in own
    }
    assert not found
