"""Exported functions, run in their own languages, give what the kernel gives."""

import ctypes
import json
import math
import shutil
import subprocess
import sys

import numpy as np
import pytest
from export_cases import CASES, case

from vehicledyn.base.errors import MissingPartError
from vehicledyn.codegen.printers.operations import MATLAB, PYTHON, C
from vehicledyn.codegen.toolchain.compiler import CompilationError, find_compiler
from vehicledyn.export.document import ExportedStart
from vehicledyn.export.files import export_files, export_text
from vehicledyn.export.identifiers import safe_names

EQUAL = 1e-12
SEEDS = (1, 2)
LOADERS = """
import json, sys
for name in ("casadi", "vehicledyn", "scipy"):
    sys.modules[name] = None
import importlib.util
spec = importlib.util.spec_from_file_location("exported", sys.argv[1])
m = importlib.util.module_from_spec(spec)
sys.modules["exported"] = m
spec.loader.exec_module(m)
import numpy as np
answers = []
for point in json.load(sys.stdin):
    p = m.Parameters(*point["p"])
    values = {k: np.array(v) for k, v in point.items()}
    values["p"] = p
    answer = {}
    for name, arguments in json.loads(sys.argv[2]).items():
        found = getattr(m, name)(*(values[k] for k in arguments))
        found = found if isinstance(found, tuple) else (found,)
        answer[name] = [item.ravel().tolist() for item in found]
    answers.append(answer)
json.dump(answers, sys.stdout)
"""


def signatures(c):
    """Names of the arguments of every exported function."""
    return {p.name: [a.name for a in p.arguments] for p in c.procedures} | {
        "solve_loops": ["t", "x", "z", "p"]
    }


def disturbed(point):
    """The point with unknowns a little off, for the function that solves them."""
    return point | {"z": point["z"] + 1e-4}


def compare(c, point, answer):
    """Each element of each result is that of the kernel."""
    expected = c.expected(point)
    assert set(answer) == set(expected)
    for name, wanted in expected.items():
        for target, (value, right) in enumerate(zip(answer[name], wanted, strict=True)):
            there = np.asarray(right)
            here = np.asarray(value, dtype=float).reshape(there.shape)
            assert np.all(np.abs(here - there) <= EQUAL * np.maximum(1.0, np.abs(there))), (
                name,
                target,
            )


def plain(value):
    return value.tolist() if isinstance(value, np.ndarray) else value


@pytest.mark.long
@pytest.mark.parametrize("name", CASES)
def test_python(name, tmp_path):
    c = case(name)
    (path,) = export_files(c.ingredients, "python", tmp_path / f"{name}.py")
    points = [c.point(seed) for seed in SEEDS]
    command = [sys.executable, "-I", "-c", LOADERS, str(path)]
    for change, chosen in (
        (dict, set(signatures(c)) - {"solve_loops"}),
        (disturbed, {"solve_loops"}),
    ):
        wanted = {k: v for k, v in signatures(c).items() if k in chosen}
        given = json.dumps([{k: plain(v) for k, v in change(p).items()} for p in points])
        done = subprocess.run(
            [*command, json.dumps(wanted)], input=given, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        for point, answer in zip(points, json.loads(done.stdout), strict=True):
            rest = {k: v for k, v in c.expected(point).items() if k not in chosen}
            compare(c, point, rest | answer)


def compiled(c, folder):
    """The exported C as a library, compiled alone and without any warning."""
    try:
        compiler = find_compiler()
    except CompilationError as error:
        pytest.skip(str(error))
    source, _ = export_files(c.ingredients, "c", folder / "exported.c")
    library = folder / "exported.so"
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror"]
    options = [*strict, "-O1", "-ffp-contract=off", "-fPIC", "-shared"]
    done = subprocess.run(
        [*compiler.command, *options, str(source), "-o", str(library), "-lm"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return ctypes.CDLL(str(library)), source.stem


def argument_of_c(value):
    if isinstance(value, float):
        return ctypes.c_double(value)
    return np.ascontiguousarray(value, dtype=float).ctypes.data_as(ctypes.c_void_p)


@pytest.mark.long
@pytest.mark.parametrize("name", CASES)
def test_c(name, tmp_path):
    c = case(name)
    library, prefix = compiled(c, tmp_path)
    for seed in SEEDS:
        point, answer = c.point(seed), {}
        for procedure in c.procedures:
            results = [np.full(t.shape, math.nan) for t in procedure.targets]
            arguments = [point[a.name] for a in procedure.arguments]
            function = getattr(library, f"{prefix}_{procedure.name}")
            function(*(argument_of_c(item) for item in (*arguments, *results)))
            answer[procedure.name] = results
        z = disturbed(point)["z"]
        solve = getattr(library, f"{prefix}_solve_loops")
        iterations = solve(*(argument_of_c(v) for v in (point["t"], point["x"], z, point["p"])))
        assert 0 < iterations < 6 if z.size else iterations == 0
        answer["solve_loops"] = [z]
        compare(c, point, answer)


def text_of_matlab(value):
    if isinstance(value, float):
        return repr(value)
    return f"[{'; '.join(repr(float(item)) for item in value)}]" if len(value) else "zeros(0, 1)"


@pytest.mark.parametrize("name", CASES)
def test_matlab(name, tmp_path):
    octave = shutil.which("octave-cli") or shutil.which("octave")
    if octave is None:
        pytest.skip("no Octave on the path, which runs the exported MATLAB")
    c = case(name)
    (path,) = export_files(c.ingredients, "matlab", tmp_path / f"{name}.m")
    lines = [f"m = {path.stem}();", "names = fieldnames(m.parameters);"]
    points = [c.point(seed) for seed in SEEDS]
    for point in points:
        lines += [f"{k} = {text_of_matlab(v)};" for k, v in point.items() if k != "p"]
        lines += [f"values = {text_of_matlab(point['p'])};", "p = struct();"]
        lines += ["for k = 1:numel(values), p.(names{k}) = values(k); end"]
        for procedure in c.procedures:
            outputs = ", ".join(f"r{k}" for k in range(len(procedure.targets)))
            arguments = ", ".join(a.name for a in procedure.arguments)
            lines.append(f"[{outputs}] = m.{procedure.name}({arguments});")
            lines += [
                f"printf('%.17g ', r{k}.'); printf('\\n');" for k in range(len(procedure.targets))
            ]
        lines.append("r = m.solve_loops(t, x, z + 1e-4, p); printf('%.17g ', r); printf('\\n');")
    (tmp_path / "ask.m").write_text("\n".join(lines), encoding="utf-8")
    done = subprocess.run(
        [octave, "--no-gui", "--norc", "--quiet", "ask.m"],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    rows = iter(done.stdout.split("\n"))
    for point in points:
        answer = {
            p.name: [[float(v) for v in next(rows).split()] for _ in p.targets]
            for p in c.procedures
        }
        answer["solve_loops"] = [[float(v) for v in next(rows).split()]]
        compare(c, point, answer)


@pytest.mark.parametrize("language", ["c", "python", "matlab"])
def test_exports_are_the_same_every_time_and_tell_what_everything_is(language):
    c = case("motor_on_a_shaker")
    fresh = type(c)(CASES["motor_on_a_shaker"]())
    texts = export_text(c.ingredients, language, "shaken")
    assert texts == export_text(fresh.ingredients, language, "shaken")
    text = "\n".join(texts.values())
    e = c.equations
    for item in (*e.states, *e.channels, *c.ingredients.variables):
        assert f"{item.name} [{item.unit}]  {item.description}" in text
    for parameter in e.parameters:
        assert f"[{parameter.unit}] {parameter.name}: {parameter.description}" in text
    for section in ("Link 2: R2 first.angle", "Force and torque through joint 3: R3 for.angle"):
        assert section in text
    assert "\n".join(texts.values()).count("Mass matrix") >= 1


def test_operation_counts_in_the_head_are_those_of_the_functions():
    """Every operator and function of the C text is one operation."""
    text = export_text(case("double_pendulum").ingredients, "python", "model")[".py"]
    told = int(text.split("#   bias ")[1].split("\n")[0])
    body = text.split("def bias(")[1].split('"""')[2].split("c = np.zeros")[0]
    statements = [line.partition("=")[2] for line in body.splitlines() if " = " in line]
    counted = sum(s.count(o) for s in statements for o in (" + ", " - ", " * ", " / ", "np."))
    counted += sum(s.count("(-") + s.strip().startswith("-") for s in statements)
    assert counted == told > 20


def test_values_to_carry_along():
    c = case("four_bar")
    start = ExportedStart(tuple(range(1, 8)), (0.25, -0.5), (0.125, 2.0))
    assert len(c.equations.parameters) == 7
    text = export_text(c.ingredients, "python", "model", start)[".py"]
    assert "crank_length: float = 1.0  # [m] crank.length: Length of the crank rod" in text
    assert "gravity: float = 7.0" in text
    assert "x_start = np.array([0.25, -0.5])" in text
    assert "z_start = np.array([0.125, 2.0])" in text


def test_names_are_allowed_in_every_language():
    names = safe_names(["for.mass", "for", "end", "double", "a.b", "a_b", "2nd", "ä", "_"])
    assert names == ["for_mass", "for_", "end_", "double_", "a_b", "a_b_", "n2nd", "n", "n_"]


@pytest.mark.parametrize("language", [C, PYTHON, MATLAB], ids=lambda item: item.name)
def test_an_operation_without_translation_is_named(language):
    with pytest.raises(MissingPartError, match=f"ERFINV has no translation to {language.name}"):
        language.apply("ERFINV", [language.number(0.5)])
