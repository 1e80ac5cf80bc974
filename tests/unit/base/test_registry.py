"""Catalogues read their modules and import those whose entries are asked for."""

import sys
from pathlib import Path

import pytest

from vehicledyn.base import registry
from vehicledyn.base.errors import InputError

PLAIN = """
from vehicledyn.base.registry import register


@register("bell", "{name}")
class Bell:
    pass
"""
COMPUTED = """
from vehicledyn.base.registry import register

for name in ("treble", "tenor"):
    register("bell", name)(type(name.title(), (), {}))
"""


@pytest.fixture
def belfry(tmp_path, monkeypatch):
    """A package of bells: two modules that say what they register, one that computes it."""
    monkeypatch.setattr(registry, "_catalogues", {})
    package = tmp_path / "belfry"
    package.mkdir()
    (package / "__init__.py").write_text(
        "from vehicledyn.base.registry import discover\n\ndiscover(__name__, __path__)\n"
    )
    (package / "hand.py").write_text(PLAIN.format(name="hand"))
    (package / "lazy_exports.py").write_text(PLAIN.format(name="door"))
    (package / "changes.py").write_text(COMPUTED)
    (package / "notes.py").write_text("raise RuntimeError('registers nothing')\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    yield __import__("belfry")
    for name in [name for name in sys.modules if name.partition(".")[0] == "belfry"]:
        del sys.modules[name]


def test_a_module_is_imported_when_its_entry_is_named(belfry):
    assert registry.families() == ("bell",)
    assert registry.kinds("bell") == ("door", "hand", "tenor", "treble")
    assert "belfry.changes" in sys.modules
    assert not {"belfry.hand", "belfry.door"} & set(sys.modules)
    found = registry.find("bell", "hand")
    assert (found.__name__, found.family, found.kind) == ("Bell", "bell", "hand")
    assert "belfry.door" not in sys.modules
    assert registry.find("bell", "tenor").__name__ == "Tenor"


def test_a_name_that_no_module_registers_is_unknown(belfry):
    with pytest.raises(InputError, match="did you mean 'door'"):
        registry.find("bell", "dor")


def test_a_name_is_registered_once(belfry):
    registry.find("bell", "hand")
    with pytest.raises(ValueError, match="bell 'hand' is registered twice"):
        registry.register("bell", "hand")(type("Other", (), {}))


def test_two_modules_with_one_name_are_told_before_they_are_imported(belfry):
    path = belfry.__path__[0]
    Path(path, "other.py").write_text(PLAIN.format(name="door"))
    with pytest.raises(ValueError, match="bell 'door' is registered twice"):
        registry.discover("belfry", [path])
