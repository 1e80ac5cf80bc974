"""A small catalogue in place of the real one, so that these tests rest on nothing else."""

import importlib

import pytest
from small_catalogue import ENTRIES, SCENARIO

from vehicledyn.base import registry
from vehicledyn.codegen.toolchain.compiler import suitable_lanes


@pytest.fixture
def catalogue(monkeypatch):
    """Show the small catalogue only; the real parts register before, as modules load once."""
    importlib.import_module("vehicledyn.catalogue").counts()  # which loads every catalogue
    for family in registry.families():
        for kind in registry.kinds(family):
            registry.find(family, kind)
    monkeypatch.setattr(registry, "_catalogues", {})
    for family, kind, entry in ENTRIES:
        registry.register(family, kind)(entry)


@pytest.fixture
def write(tmp_path, catalogue):
    """Write the good scenario with pieces of its text replaced; return the file."""

    def write_file(*changes, text=SCENARIO):
        for old, new in changes:
            assert text.count(old) == 1, f"'{old}' is not in the scenario exactly once"
            text = text.replace(old, new)
        path = tmp_path / "cart.yaml"
        path.write_text(text, encoding="utf-8")
        return path

    return write_file


@pytest.fixture(params=["compiled", "interpreted"])
def backend(request):
    if request.param == "compiled":
        request.getfixturevalue("needs_compiler")
    return request.param


@pytest.fixture(params=[4, 8])
def lanes(request, needs_compiler):
    if request.param > suitable_lanes():
        pytest.skip(f"this processor carries no {request.param} lanes")
    return request.param
