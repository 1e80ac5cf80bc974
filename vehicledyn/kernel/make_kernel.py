"""Make the kernel of a model: compile its equations, find them compiled, or interpret them.

This is the one place where the backend is chosen.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Literal, TypeAlias

from vehicledyn.base.errors import InputError, MissingPartError
from vehicledyn.base.garbage import without_collection
from vehicledyn.codegen.toolchain import cache
from vehicledyn.codegen.toolchain.compiler import (
    UNIT_BREAK,
    CompilationError,
    Compiler,
    build_library,
    find_compiler,
)
from vehicledyn.codegen.toolchain.fingerprint import fingerprint, generator_fingerprint
from vehicledyn.kernel.compilation_worth import compiling_pays, is_large
from vehicledyn.kernel.compiled import CompiledEngine
from vehicledyn.kernel.kernel import Kernel, KernelReport
from vehicledyn.symbolic.equations import Block, Equations

Backend: TypeAlias = Literal["auto", "compiled", "interpreted"]
Progress: TypeAlias = Callable[[str, float | None], None]
"""Called with what is being done and the done part of it, between 0 and 1, where that is known."""

_log = logging.getLogger(__name__)


def compile_kernel(
    equations: Equations,
    *,
    backend: Backend = "auto",
    progress: Progress | None = None,
    evaluations: float | None = None,
) -> Kernel:
    """Return the kernel of some equations.

    Parameters
    ----------
    equations
        The model; its blocks must cover the unknowns in order.
    backend
        "compiled" needs a C compiler, "interpreted" uses none, "auto" takes the first of the
        two that works; a large model that is not evaluated often is interpreted, since its first
        result comes sooner then.
    progress
        Called with what is going on.
    evaluations
        How many evaluations of the rates are expected; None where few are, or nobody knows.

    Raises
    ------
    MissingPartError
        If compiled code is asked for and no compiler works.
    """
    tell = progress or _silent
    _check_blocks(equations.blocks, len(equations.unknowns))
    if backend == "interpreted":
        return _interpreted(equations, "", tell)
    if equations.structure.get("sparse_solves"):
        if backend == "compiled":
            raise InputError(
                f"model '{equations.name}' has so many entangled constraints that they are solved "
                "by sparse elimination, which is not compiled; take the kernel 'auto'"
            )
        return _interpreted(equations, "", tell)
    if backend == "auto" and not compiling_pays(equations, evaluations):
        return _interpreted(equations, "", tell)
    try:
        return _compiled(equations, find_compiler(), tell)
    except CompilationError as error:
        if backend == "compiled":
            raise MissingPartError(
                f"compiled code is asked for, but {error}; install gcc or clang, or allow the "
                "interpreted kernel"
            ) from None
        return _interpreted(equations, f"{error}; running interpreted, which is slower", tell)


def _compiled(equations: Equations, compiler: Compiler, tell: Progress) -> Kernel:
    seconds = {"generation": 0.0, "compilation": 0.0}

    def build(folder: Path) -> Path:
        from vehicledyn.codegen.passes.kernel_functions import derive_functions, operations_of
        from vehicledyn.codegen.passes.seam_cut import cut_at_seam
        from vehicledyn.codegen.printers.kernel_source import comes_in_units, kernel_units
        from vehicledyn.kernel.seam_library import seam_library

        started = time.perf_counter()
        tell("deriving the equations of the kernel", None)
        cut = cut_at_seam(equations)
        if cut is not None:
            tell(f"compiling with {compiler.description}", None)
            library = seam_library(cut, compiler, folder)
            seconds["compilation"] = time.perf_counter() - started
            return library
        functions = derive_functions(equations)
        total = sum(operations_of(functions).values())
        tell(f"compiling {total} operations with {compiler.description}", None)

        def printed() -> Iterator[str]:
            """Yield the units, and note when the last is there."""
            yield from kernel_units(equations, functions)
            seconds["generation"] = time.perf_counter() - started

        in_units = comes_in_units(functions)
        source = printed() if in_units else UNIT_BREAK.join(printed())
        library = build_library(compiler, source, folder)
        seconds["compilation"] = time.perf_counter() - started - seconds["generation"]
        return library

    key = cache.key_of(fingerprint(equations), generator_fingerprint(), compiler.identity)
    with without_collection():
        engine, entry = cache.load(key, build, lambda path: CompiledEngine(equations, path))
    if entry.remark:
        _log.warning(entry.remark)
    tell("compiled" if not entry.found else "found in the cache", 1.0)
    report = KernelReport(
        engine.operations,
        seconds["generation"],
        seconds["compilation"],
        entry.found,
        entry.remark,
    )
    return Kernel(equations, "compiled", compiler.description, report, engine, key)


def known_kernel(equations: Equations, key: str) -> Kernel | None:
    """Return the compiled kernel of a key, if it is in the cache and can be loaded.

    Parameters
    ----------
    equations
        Those that the kernel was compiled from; only facts are asked of them, no expressions.
    key
        ``Kernel.key`` of the kernel that was compiled.
    """
    path = cache.known(key)
    if path is None:
        return None
    try:
        engine = CompiledEngine(equations, path)
        description = find_compiler().description
    except (OSError, AttributeError, ValueError, CompilationError):
        return None
    report = KernelReport(engine.operations, cached=True)
    return Kernel(equations, "compiled", description, report, engine, key)


def _interpreted(equations: Equations, remark: str, tell: Progress) -> Kernel:
    from vehicledyn.codegen.passes.kernel_functions import derive_functions, operations_of
    from vehicledyn.codegen.passes.plain_functions import plain_functions
    from vehicledyn.kernel.interpreted import InterpretedEngine

    if remark:
        _log.warning(remark)
    tell("deriving the equations of the kernel", None)
    started = time.perf_counter()
    is_plain = not equations.parameters and is_large(equations)
    functions = (plain_functions if is_plain else derive_functions)(equations)
    engine = InterpretedEngine(equations, functions)
    seconds = time.perf_counter() - started
    tell("ready", 1.0)
    report = KernelReport(operations_of(functions), seconds, remark=remark)
    return Kernel(equations, "interpreted", "CasADi virtual machine", report, engine)


def _check_blocks(blocks: tuple[Block, ...], n_unknowns: int) -> None:
    edges = [block.start for block in blocks] + [n_unknowns]
    stops = [0] + [block.stop for block in blocks]
    if edges != stops:
        raise ValueError("the blocks must cover the unknowns one after the other")


def _silent(what: str, part: float | None) -> None:
    """Show nothing."""
