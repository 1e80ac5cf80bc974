"""Caches that stay bounded, and modules whose caches grow with their use."""

import ast
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import vehicledyn
from vehicledyn.base.bounded_cache import BoundedCache

PACKAGE = Path(vehicledyn.__file__).parent
BOUNDED_BY_THEIR_KEYS = {
    "analyses/preparation/memory/origins.py:_program": "nothing",
    "cli/verbs.py:_command_of": "verbs",
    "codegen/ir/instructions.py:_operations": "nothing",
    "codegen/passes/local_slopes.py:_rules": "nothing",
    "codegen/passes/local_slopes.py:_step_codes": "nothing",
    "codegen/passes/local_slopes.py:_template": "operations and their operands",
    "files/system/declared_sets.py:declared_set": "types of elements",
    "files/system/joint_sets.py:joint_set": "types of joints",
    "files/expressions/dimensions.py:_common_units": "nothing",
    "files/system/kinds.py:_enter_own": "nothing",
    "library/names.py:entries": "kinds of files",
    "library/names.py:library_folder": "nothing",
    "rail/profiles/profile_names.py:_standard_file": "standard profiles",
    "results/plots/canvas.py:_figure_class": "nothing",
    "road/tyre_files/names.py:coefficients": "nothing",
    "studies/block.py:program_fingerprint": "nothing",
    "symbolic/rotations.py:_unit": "axes",
}
"""Functions that keep all results, with what there is a fixed number of."""

FILLED = {
    "base/plugins.py:_loaded",
    "base/registry.py:_catalogues",
    "files/expressions/algebra.py:_VECTORS",
    "results/hdf5/output.py:_lending",  # outputs that are being written
    "studies/block.py:_workers",  # one at most
}


def test_values_used_last_are_kept():
    cache, made = BoundedCache(2), []

    def value(key):
        return cache.get(key, lambda: made.append(key) or key.upper())

    assert [value(key) for key in "abacab"] == ["A", "B", "A", "C", "A", "B"]
    assert made == ["a", "b", "c", "b"]  # c pushed b out, since a was used after it
    assert len(cache) == 2


def test_threads_share_a_cache():
    cache = BoundedCache(2)

    def ask(number):
        return all(cache.get(k % 5, lambda k=k: k % 5) == k % 5 for k in range(number, 3000))

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(ask, range(8)))
    assert len(cache) == 2


def test_what_fails_is_not_kept():
    cache = BoundedCache(2)
    for _ in range(2):
        try:
            cache.get("a", lambda: 1 / 0)
        except ZeroDivisionError:
            continue
        raise AssertionError
    assert len(cache) == 0


def test_no_function_keeps_results_without_bound():
    found = set()
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef):
                marks = {ast.unparse(mark) for mark in node.decorator_list}
                if marks & {"cache", "functools.cache", "lru_cache(maxsize=None)"}:
                    found.add(f"{path.relative_to(PACKAGE).as_posix()}:{node.name}")
    assert found == set(BOUNDED_BY_THEIR_KEYS)


def test_no_module_has_an_empty_dictionary_to_fill_but_registries():
    found = set()
    for path in PACKAGE.rglob("*.py"):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            value = getattr(node, "value", None)
            if not isinstance(node, ast.AnnAssign | ast.Assign) or value is None:
                continue
            if ast.unparse(value) in ("{}", "dict()", "[]", "set()", "OrderedDict()"):
                target = node.target if isinstance(node, ast.AnnAssign) else node.targets[0]
                found.add(f"{path.relative_to(PACKAGE).as_posix()}:{ast.unparse(target)}")
    assert found == FILLED
