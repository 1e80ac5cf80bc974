"""Find the system's C compiler and build a shared library with it."""

from __future__ import annotations

import hashlib
import os
import platform
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from vehicledyn.base.processors import cores

UNIT_BREAK = "\n/* ---- another unit ---- */\n"
"""Where one unit of a source ends and another begins."""

OPTIONS = (
    *("-std=gnu11", "-O1", "-ffp-contract=off", "-fPIC", "-shared", "-fvisibility=hidden"),
    *("-fno-math-errno", "-fno-trapping-math"),
)
"""Options of every build; on a known x86-64 processor -march=native comes on top.

Measured with gcc 12 on a vehicle of 24,000 operations, -O1, -O2, -O1 -march=native: 2.3, 3.7,
2.2 s to compile and 3.54, 3.62, 3.25 us a right-hand side. Without contraction only those
operations are fused that the source fuses, so results do not depend on the number of lanes.
"""

_NO_SEARCH = ("-fno-tree-dse", "-fno-dse", "-fno-tree-fre")
"""Printed functions hold neither dead stores nor an expression twice, so gcc need not search for
them: 5.0 s in place of 7.2 s for 80,000 operations, with the same run time."""

_NO_MOVES = "-mtune-ctrl=^inter_unit_moves_from_vec,^inter_unit_moves_to_vec"
"""Numbers that find no register are kept in memory, not in those of integers.

Moves to these take the ports of sums and products: a chain of joints takes 5 % less without.
"""

_DISABLED = "none"
_CANDIDATES = ("cc", "gcc", "clang")
_LEAST_LIMIT, _LIMIT_OF_LETTER, _ANSWER_LIMIT = 60.0, 1e-4, 20.0
"""Most time for a build [s], at least and for each letter of the source, some fifty times what gcc
takes; and for telling the version [s]."""


class CompilationError(Exception):
    """The compiler is unusable or refused the source; the text says in one line why."""


@dataclass(frozen=True)
class Compiler:
    """A compiler that answered: its command, its version and what it builds for.

    ``processor`` distinguishes processors that understand other instructions; empty if unknown.
    """

    command: tuple[str, ...]
    version: str
    machine: str
    processor: str

    @property
    def options(self) -> tuple[str, ...]:
        """The options for this machine."""
        is_gcc = self.version.startswith("gcc ")
        own = (*OPTIONS, *_NO_SEARCH) if is_gcc else OPTIONS
        if not self.processor:
            return own
        return (*own, "-march=native", *((_NO_MOVES,) if is_gcc else ()))

    @property
    def identity(self) -> str:
        """Everything about the compiler and options that may change what it builds."""
        return "\n".join([*self.command, self.version, self.machine, self.processor, *self.options])

    @property
    def description(self) -> str:
        """Short name for people, such as "gcc 12.2.0 -O1"."""
        return f"{self.version} {OPTIONS[1]}"


def find_compiler() -> Compiler:
    """Return the first C compiler that answers.

    The variables VEHICLEDYN_CC and CC name one, in this order; without them cc, gcc and clang
    are tried. ``VEHICLEDYN_CC=none`` means that none shall be used.

    Raises
    ------
    CompilationError
        If there is none.
    """
    named = os.environ.get("VEHICLEDYN_CC") or os.environ.get("CC")
    if named == _DISABLED:
        raise CompilationError("compilation is switched off by VEHICLEDYN_CC=none")
    commands = [_split(named)] if named else [(name,) for name in _CANDIDATES]
    reasons = []
    for command in commands:
        path = shutil.which(command[0])
        if path is None:
            reasons.append(f"'{command[0]}' is not found")
            continue
        answer = _ask_once((path, *command[1:]), Path(path).stat().st_mtime_ns)
        if isinstance(answer, Compiler):
            return answer
        reasons.append(answer)
    raise CompilationError(f"no C compiler: {', '.join(reasons)}")


def suitable_lanes() -> int:
    """Return how many doubles this processor computes at once, as far as lanes know it."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return 1
    line = next((item for item in text.splitlines() if item.startswith("flags")), "")
    flags = set(line.split())
    if {"avx512f", "avx512dq"} <= flags:
        return 8
    return 4 if {"avx2", "fma"} <= flags else 1


def library_suffix() -> str:
    """Return the file ending of a shared library on this system."""
    return ".dll" if sys.platform == "win32" else ".so"


def build_library(
    compiler: Compiler,
    source: str | Iterable[str],
    folder: Path,
    objects: Iterable[Path] = (),
) -> Path:
    """Compile a source text in a folder and return the library's path, ``objects`` linked in.

    ``UNIT_BREAK`` parts the text into units that do not see each other's definitions. Units may
    come one by one too: each is compiled while the next is being made, several at once.

    Raises
    ------
    CompilationError
        If the compiler fails.
    OSError
        If the source cannot be written.
    """
    library = folder / f"kernel{library_suffix()}"
    units = source.split(UNIT_BREAK) if isinstance(source, str) else source
    paths = [*_compiled_units(compiler, units, folder), *objects]
    command = [*compiler.command, *compiler.options, *map(str, paths), "-o", str(library)]
    limit = _LEAST_LIMIT + (_LIMIT_OF_LETTER * len(source) if isinstance(source, str) else 0.0)
    _run([*command, "-lm"] if sys.platform != "win32" else command, limit)
    if not library.is_file():
        raise CompilationError(f"{compiler.command[0]} wrote no library")
    return library


def build_object(compiler: Compiler, units: Iterable[str], folder: Path) -> Path:
    """Compile units in a folder and return the path of one object file that holds them.

    Raises
    ------
    CompilationError
        If the compiler fails.
    OSError
        If a source cannot be written.
    """
    made = folder / "object.o"
    paths = _compiled_units(compiler, iter(units), folder)
    _run([*compiler.command, "-r", "-nostdlib", *map(str, paths), "-o", str(made)], _LEAST_LIMIT)
    return made


def _compiled_units(compiler: Compiler, units: Iterable[str], folder: Path) -> list[Path]:
    """Return the object files of units, or the file of a single one, which needs none."""
    if isinstance(units, list) and len(units) == 1:
        path = folder / "kernel.c"
        path.write_text(units[0], encoding="utf-8")
        return [path]
    with ThreadPoolExecutor(cores()) as at_once:
        objects = [
            at_once.submit(compile_unit, compiler, unit, folder / f"kernel_{k}.c")
            for k, unit in enumerate(units)
        ]
        return [item.result() for item in objects]


def compile_unit(compiler: Compiler, unit: str, path: Path) -> Path:
    """Write a unit to a path, compile it and return the path of its object file.

    Raises
    ------
    CompilationError
        If the compiler fails.
    OSError
        If the source cannot be written.
    """
    path.write_text(unit, encoding="utf-8")
    made = path.with_suffix(".o")
    limit = _LEAST_LIMIT + _LIMIT_OF_LETTER * len(unit)
    _run([*compiler.command, *compiler.options, "-c", str(path), "-o", str(made)], limit)
    return made


def _split(named: str) -> tuple[str, ...]:
    try:
        command = tuple(shlex.split(named))
    except ValueError as error:
        raise CompilationError(f"VEHICLEDYN_CC or CC is '{named}': {error}") from None
    if not command:
        raise CompilationError("VEHICLEDYN_CC or CC is blank")
    return command


@lru_cache(maxsize=16)
def _ask_once(command: tuple[str, ...], _changed: int) -> Compiler | str:
    """Return the compiler of a command, or why there is none; a program is asked only once."""
    try:
        return _ask_version(command)
    except CompilationError as error:
        return str(error)


def _ask_version(command: tuple[str, ...]) -> Compiler:
    lines = _run([*command, "--version"], _ANSWER_LIMIT).splitlines()
    words = lines[0].split() if lines else []
    numbers = [word for word in words if word[0].isdigit() and "." in word]
    name = "clang" if "clang" in words else "gcc" if words and "cc" in words[0] else command[0]
    number = numbers[-1] if numbers else " ".join(words)
    machine = f"{platform.machine()} {sys.platform}"
    return Compiler(command, f"{name} {number}".strip(), machine, _processor())


def _processor() -> str:
    """Return a digest of the instructions this processor knows, or "" where it is unknown."""
    if platform.machine() != "x86_64":
        return ""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return ""
    facts = sorted({line for line in lines if line.startswith(("flags", "model name"))})
    return hashlib.sha256("\n".join(facts).encode()).hexdigest()[:16] if facts else ""


def _run(command: list[str], limit: float) -> str:
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit, check=False)
    except subprocess.TimeoutExpired:
        raise CompilationError(f"{command[0]} does not end within {limit:g} s") from None
    except OSError as error:
        raise CompilationError(f"{command[0]} does not run: {error}") from None
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if line.strip()]
        relevant = [line for line in lines if not line.startswith("collect2:")] or lines
        errors = (
            [line for line in relevant if "error" in line.lower()] or relevant or ["no message"]
        )
        raise CompilationError(f"{command[0]} failed: {errors[0].strip()}")
    return done.stdout
