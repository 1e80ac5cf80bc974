"""Catalogues read their modules and import those whose entries are asked for."""

import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from vehicledyn.base import plugins, registry
from vehicledyn.base.errors import InputError
from vehicledyn.base.plugins import load_plugin

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


THREADS = 8


def at_once(call):
    """Return what several threads get that call something at the same time."""
    ready = threading.Barrier(THREADS, timeout=10.0)

    def wait_and_call(_):
        ready.wait()
        return call()

    with ThreadPoolExecutor(THREADS) as pool:
        return list(pool.map(wait_and_call, range(THREADS)))


def test_threads_that_ask_at_once_get_one_class(monkeypatch):
    """Each makes one, as all are in the maker before any is done; the first counts."""
    monkeypatch.setattr(registry, "_catalogues", {})
    inside = threading.Barrier(THREADS, timeout=10.0)

    def make():
        inside.wait()
        return type("Bell", (), {})

    registry.announce("bell", "slow", make)
    found = at_once(lambda: registry.find("bell", "slow"))
    assert len(set(found)) == 1
    assert registry.find("bell", "slow") is found[0]
    assert (found[0].family, found[0].kind) == ("bell", "slow")
    registry.announce("bell", "slow", make)  # as catalogues do that are loaded twice
    assert registry.find("bell", "slow") is found[0]


def test_threads_that_import_at_once_get_one_class(belfry):
    assert len(set(at_once(lambda: registry.find("bell", "hand")))) == 1


def test_threads_that_load_a_plugin_at_once_run_it_once(tmp_path, monkeypatch):
    monkeypatch.setattr(registry, "_catalogues", {})
    monkeypatch.setattr(plugins, "_loaded", {})
    path = tmp_path / "gong.py"
    count = f"from pathlib import Path\nwith Path({str(tmp_path / 'runs')!r}).open('a') as file:\n"
    path.write_text(f"{count}    file.write('once')\n" + PLAIN.format(name="gong"))
    assert at_once(lambda: load_plugin(path)) == [[("bell", "gong")]] * THREADS
    assert registry.find("bell", "gong").kind == "gong"
    assert (tmp_path / "runs").read_text() == "once"
