"""Finding compilers, keeping what they build, and what happens when either fails."""

import ast
import ctypes
import hashlib
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from solve_examples import oscillator, slider_crank, starts

from vehicledyn.base.errors import MissingPartError
from vehicledyn.codegen.toolchain import fingerprint
from vehicledyn.codegen.toolchain.compiler import CompilationError, build_library, find_compiler
from vehicledyn.kernel.make_kernel import compile_kernel

RATES = [0.0, -4.0]


@pytest.fixture
def folder(tmp_path, monkeypatch, needs_compiler):
    """An empty cache of this test."""
    monkeypatch.setenv("VEHICLEDYN_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def script(path, text):
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return str(path)


def rates_of(kernel):
    return kernel.rates(0.0, [1.0, 0.0], [])


def test_second_kernel_comes_from_the_cache(folder):
    assert not compile_kernel(oscillator()).report.cached
    again = compile_kernel(oscillator(stiffness=9.0))
    assert again.report.cached
    assert again.report.operations["rates"] > 0
    assert rates_of(again) == pytest.approx([0.0, -9.0])
    assert not compile_kernel(slider_crank()).report.cached


@pytest.mark.parametrize("damage", ["truncate", "flip", "empty"])
def test_damaged_entry_is_rebuilt(folder, damage):
    compile_kernel(oscillator())
    (entry,) = folder.glob("*.so")
    content = bytearray(entry.read_bytes())
    content[len(content) // 2] ^= 0xFF
    damaged = {"truncate": content[: len(content) // 3], "flip": content, "empty": b""}[damage]
    entry.unlink()
    entry.write_bytes(damaged)
    kernel = compile_kernel(oscillator())
    assert not kernel.report.cached
    assert rates_of(kernel) == pytest.approx(RATES)
    assert compile_kernel(oscillator()).report.cached


def test_whole_entry_that_is_no_library_is_rebuilt(folder):
    compile_kernel(oscillator())
    (entry,) = folder.glob("*.so")
    key = entry.stem.partition("-")[0]
    entry.unlink()
    text = b"not a library"
    (folder / f"{key}-{hashlib.sha256(text).hexdigest()}.so").write_bytes(text)
    kernel = compile_kernel(oscillator())
    assert kernel.backend == "compiled"
    assert rates_of(kernel) == pytest.approx(RATES)


BUILD = """
import sys
sys.path.insert(0, sys.argv[1])
from solve_examples import slider_crank
from vehicledyn.kernel.make_kernel import compile_kernel
kernel = compile_kernel(slider_crank(), backend="compiled")
print(kernel.rates(0.0, [0.3, 3.0], [0.15, 2.9])[1])
"""


def test_two_processes_build_the_same_entry(folder):
    command = [sys.executable, "-c", BUILD, str(Path(__file__).parents[1])]
    processes = [
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(3)
    ]
    results = [process.communicate(timeout=120) for process in processes]
    assert [process.returncode for process in processes] == [0, 0, 0], results
    assert len({out for out, _ in results}) == 1
    assert len(list(folder.glob("*.so"))) == 1
    assert not list(folder.glob("build-*"))


def test_folder_that_cannot_be_written(tmp_path, monkeypatch, needs_compiler):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("VEHICLEDYN_CACHE", str(tmp_path / "file" / "cache"))
    kernel = compile_kernel(oscillator())
    assert kernel.backend == "compiled"
    assert "cannot be used" in kernel.report.remark
    assert rates_of(kernel) == pytest.approx(RATES)


EVIL = """
#include <stdlib.h>
__attribute__((constructor)) static void run(void) { system("touch '%s'"); }
"""


def planted(folder, tmp_path):
    """Put a library that leaves a trace in place of the one entry, named by its own checksum."""
    (entry,) = folder.glob("*.so")
    trace, source = tmp_path / "trace", tmp_path / "evil.c"
    source.write_text(EVIL % trace)
    library = tmp_path / "evil.so"
    compiler = find_compiler().command
    subprocess.run([*compiler, "-shared", "-fPIC", "-o", library, source], check=True)
    content = library.read_bytes()
    name = f"{entry.stem.partition('-')[0]}-{hashlib.sha256(content).hexdigest()}.so"
    entry.unlink()
    target = folder / name
    target.write_bytes(content)
    return target, trace


needs_owners = pytest.mark.skipif(not hasattr(os, "geteuid"), reason="needs owners and modes")


@needs_owners
@pytest.mark.parametrize("how", ["mode", "owner", "link"])
def test_a_library_that_others_could_write_is_not_run(folder, tmp_path, how):
    compile_kernel(oscillator())
    target, trace = planted(folder, tmp_path)
    if how == "mode":
        target.chmod(0o666)
    elif how == "owner":
        if os.geteuid():
            pytest.skip("only root gives files away")
        os.chown(target, 54321, -1)
    else:
        target.replace(tmp_path / "elsewhere.so")
        target.symlink_to(tmp_path / "elsewhere.so")
    kernel = compile_kernel(oscillator())
    assert not trace.exists()
    assert not kernel.report.cached
    assert kernel.report.remark.endswith("; the kernel is compiled again")
    assert str(target) in kernel.report.remark
    assert rates_of(kernel) == pytest.approx(RATES)
    again = compile_kernel(oscillator())
    assert (again.report.cached, again.report.remark) == (True, "")


@needs_owners
def test_a_folder_that_others_can_write_is_not_used(folder, tmp_path):
    compile_kernel(oscillator())
    target, trace = planted(folder, tmp_path)
    folder.chmod(0o777)
    kernel = compile_kernel(oscillator())
    assert not trace.exists()
    assert target.exists()
    assert f"the cache folder is not used, since others can write to the folder {folder}" in (
        kernel.report.remark
    )
    assert kernel.report.remark.endswith("; the kernel is compiled for this run only")
    assert rates_of(kernel) == pytest.approx(RATES)
    folder.chmod(0o700)
    compile_kernel(oscillator())
    assert trace.exists()  # the library would have run: in a private folder it is the user's own


@needs_owners
def test_what_is_kept_is_private(folder):
    old = os.umask(0)
    try:
        compile_kernel(oscillator())
    finally:
        os.umask(old)
    (entry,) = folder.glob("*.so")
    assert [path.stat().st_mode & 0o777 for path in (folder, entry)] == [0o700, 0o700]
    assert compile_kernel(oscillator()).report.cached


def test_what_killed_builds_left_is_removed(folder):
    for name, age in (("build-old", 2 * 86_400), ("build-new", 0)):
        (folder / name).mkdir(parents=True)
        os.utime(folder / name, (time.time() - age,) * 2)
    compile_kernel(oscillator())
    assert [path.name for path in folder.glob("build-*")] == ["build-new"]


def test_cache_on_a_full_disk(folder, tmp_path, monkeypatch):
    real = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    full = f"""
case "$*" in *{folder}*) echo "fatal error: No space left on device" >&2; exit 1;; esac
exec {real} "$@" """
    monkeypatch.setenv("VEHICLEDYN_CC", script(tmp_path / "cc", full))
    kernel = compile_kernel(oscillator())
    assert kernel.backend == "compiled"
    assert "No space left" in kernel.report.remark
    assert not list(folder.iterdir())


def test_no_place_to_build_in(folder, monkeypatch, needs_compiler):
    def full(*_arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("vehicledyn.kernel.make_kernel.build_library", full)
    kernel = compile_kernel(oscillator())
    assert kernel.backend == "interpreted"
    assert "No space left" in kernel.report.remark
    assert not list(folder.glob("*"))


def test_clang_is_given_no_options_of_gcc(folder, tmp_path, monkeypatch):
    real = " ".join(find_compiler().command)
    clang = f"""
for word; do case "$word" in
--version) echo "Debian clang version 14.0.6"; exit 0;;
-fno-tree-[df]*|-fno-dse|-mtune-ctrl=*) echo "clang: error: unknown argument '$word'" >&2; exit 1;;
esac; done
exec {real} "$@" """
    monkeypatch.setenv("VEHICLEDYN_CC", script(tmp_path / "cc", clang))
    kernel = compile_kernel(oscillator())
    assert kernel.report.remark == ""
    assert kernel.backend == "compiled"
    assert find_compiler().version == "clang 14.0.6"
    assert rates_of(kernel) == pytest.approx(RATES)


@pytest.mark.parametrize(("named", "words"), [('gcc "', "No closing quotation"), (" ", "blank")])
def test_compiler_named_badly(monkeypatch, named, words):
    monkeypatch.setenv("VEHICLEDYN_CC", named)
    with pytest.raises(CompilationError, match=words):
        find_compiler()


def test_no_compiler_wanted(monkeypatch):
    monkeypatch.setenv("VEHICLEDYN_CC", "none")
    kernel = compile_kernel(oscillator())
    assert kernel.backend == "interpreted"
    assert "VEHICLEDYN_CC=none" in kernel.report.remark
    with pytest.raises(MissingPartError, match="VEHICLEDYN_CC=none"):
        compile_kernel(oscillator(), backend="compiled")


def test_no_compiler_found(monkeypatch, tmp_path):
    monkeypatch.delenv("VEHICLEDYN_CC", raising=False)
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(CompilationError, match="no C compiler"):
        find_compiler()
    assert compile_kernel(oscillator()).backend == "interpreted"


VERSION = 'case "$*" in *--version*) echo "gcc 1.0"; exit 0;; esac; '
BROKEN = {
    "fails": VERSION + 'echo "x.c:1: error: math.h" >&2; exit 1',
    "is silent": "exit 1",
    "writes nothing": VERSION,
    "writes nonsense": VERSION
    + 'while [ $# -gt 1 ]; do [ "$1" = -o ] && echo no > "$2"; shift; done',
}


@pytest.mark.parametrize("fault", BROKEN)
def test_broken_compiler(folder, tmp_path, monkeypatch, caplog, fault):
    monkeypatch.setenv("VEHICLEDYN_CC", script(tmp_path / "brokencc", BROKEN[fault]))
    kernel = compile_kernel(oscillator())
    assert kernel.backend == "interpreted"
    assert "\n" not in kernel.report.remark
    assert [record.getMessage() for record in caplog.records] == [kernel.report.remark]
    assert rates_of(kernel) == pytest.approx(RATES)
    assert not list(folder.glob("*")) if folder.exists() else True


@pytest.mark.parametrize("limit", ["_ANSWER_LIMIT", "_LEAST_LIMIT"])
def test_compiler_that_hangs(folder, tmp_path, monkeypatch, limit):
    hangs = "exec sleep 60" if limit == "_ANSWER_LIMIT" else VERSION + "exec sleep 60"
    monkeypatch.setenv("VEHICLEDYN_CC", script(tmp_path / "slowcc", hangs))
    monkeypatch.setattr(f"vehicledyn.codegen.toolchain.compiler.{limit}", 0.5)
    monkeypatch.setattr("vehicledyn.codegen.toolchain.compiler._LIMIT_OF_LETTER", 0.0)
    kernel = compile_kernel(oscillator())
    assert kernel.backend == "interpreted"
    assert "does not end within 0.5 s" in kernel.report.remark


def test_a_compiler_is_asked_once_for_its_version(tmp_path, monkeypatch):
    """One that hangs would else hold up a command several times over."""
    asked = tmp_path / "asked"
    monkeypatch.setenv("VEHICLEDYN_CC", script(tmp_path / "mutecc", f'echo x >> "{asked}"; exit 1'))
    for _ in range(3):
        with pytest.raises(CompilationError, match="mutecc failed"):
            find_compiler()
    assert asked.read_text() == "x\n"


def test_progress_is_told(folder):
    told = []
    compile_kernel(slider_crank(), progress=lambda what, part: told.append((what, part)))
    assert any("compiling" in what for what, _ in told)
    assert told[-1][1] == 1.0


def test_interpreted_and_compiled_agree(needs_compiler):
    equations = slider_crank()
    state, unknowns = starts(equations)
    one, two = (compile_kernel(equations, backend=b) for b in ("compiled", "interpreted"))
    assert one.description != two.description
    z = one.solve_unknowns(0.0, state, unknowns)
    assert z == pytest.approx(two.solve_unknowns(0.0, state, unknowns), abs=1e-15)
    assert np.array_equal(one.rates(0.0, state, z), two.rates(0.0, state, z))


def test_entries_depend_on_all_modules_that_print_code():
    """Modules of the toolchain are reached for the limits of a compiler only."""
    folder = Path(fingerprint.__file__).parents[1]
    waiting, reached = ["printers.c_printer", "printers.kernel_source"], set()
    while waiting:
        name = waiting.pop()
        if name not in reached:
            reached.add(name)
            file = folder / f"{name.replace('.', '/')}.py"
            nodes = ast.walk(ast.parse(file.read_text(encoding="utf-8")))
            imported = [item.module or "" for item in nodes if isinstance(item, ast.ImportFrom)]
            inner = [item for item in imported if item.startswith("vehicledyn.codegen.")]
            waiting += [item.removeprefix("vehicledyn.codegen.") for item in inner]
    read = {file for pattern in fingerprint._GENERATORS for file in folder.glob(pattern)}
    printing = {name for name in reached if not name.startswith("toolchain.")}
    assert len(printing) > 10
    assert {folder / f"{name.replace('.', '/')}.py" for name in printing} <= read
    assert folder / "runtime" / "steps.c" in read


def test_units_are_compiled_while_others_are_made(tmp_path, needs_compiler):
    """The second unit is made only once the compiler has finished the first."""
    finished = tmp_path / "kernel_0.o"

    def units():
        yield "double one(void) { return 1.0; }"
        for _ in range(1000):
            if finished.is_file():
                break
            time.sleep(0.01)
        assert finished.is_file()
        seen = '__attribute__((visibility("default")))'
        yield f"double one(void);\n{seen} double two(void) {{ return 2.0 * one(); }}"

    library = ctypes.CDLL(str(build_library(find_compiler(), units(), tmp_path)))
    library.two.restype = ctypes.c_double
    assert library.two() == 2.0


def test_a_unit_that_does_not_compile_is_named(tmp_path, needs_compiler):
    with pytest.raises(CompilationError, match=r"error: .*nonsense"):
        build_library(find_compiler(), iter(["int x;", "nonsense y;"]), tmp_path)


def test_a_kernel_in_units_is_the_same_to_the_bit(tmp_path, monkeypatch, needs_compiler):
    equations, found = slider_crank(), []
    x, guess = starts(equations)
    for least in (0, 10**9):
        monkeypatch.setattr("vehicledyn.codegen.printers.kernel_source._LARGE", least)
        monkeypatch.setenv("VEHICLEDYN_CACHE", str(tmp_path / str(least)))
        kernel = compile_kernel(equations, backend="compiled")
        assert not kernel.report.cached
        z = kernel.solve_unknowns(0.0, x, guess)
        found.append([*kernel.rates(0.0, x, z), *kernel.outputs(0.0, x, z)])
    assert found[0] == found[1]
