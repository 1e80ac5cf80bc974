"""Build a kernel that is cut at its seam: its model from the cache, only its surroundings anew."""

from __future__ import annotations

import json
import shutil
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from pathlib import Path

from vehicledyn.codegen.passes.seam_cut import SeamCut
from vehicledyn.codegen.printers.seam_source import (
    ModelFacts,
    facts_of_model,
    loop_unit,
    model_units,
    surroundings_source,
)
from vehicledyn.codegen.toolchain import cache
from vehicledyn.codegen.toolchain.compiler import (
    Compiler,
    build_library,
    build_object,
    compile_unit,
)
from vehicledyn.codegen.toolchain.fingerprint import generator_fingerprint


def seam_library(cut: SeamCut, compiler: Compiler, folder: Path, lanes: int | None = None) -> Path:
    """Return the library of a kernel, built in a folder; its model is kept for other surroundings.

    The loop is kept for all kernels of the same sizes.

    With ``lanes`` it carries so many cases side by side, without it is that of one case.

    Raises
    ------
    CompilationError
        If the compiler fails.
    OSError
        If the folder cannot be written.
    """
    of_model = cache.key_of(cut.model_key, generator_fingerprint(), compiler.identity)

    def compiled(place: Path) -> Path:
        return build_object(compiler, model_units(cut, lanes), place)

    def write_facts(place: Path) -> Path:
        file = place / "facts.json"
        file.write_text(json.dumps(asdict(facts_of_model(cut))), encoding="utf-8")
        return file

    facts, _ = cache.load(cache.key_of(of_model, "facts"), write_facts, _facts)
    own, loop = surroundings_source(cut, facts, lanes), loop_unit(cut, lanes)

    def beside() -> list[Path]:
        """Compile the surroundings, and the loop where it is not known."""
        kept, _ = cache.load(
            cache.key_of("loop", loop, compiler.identity),
            lambda place: compile_unit(compiler, loop, place / "loop.c"),
            lambda path: _copied(path, folder / "loop.o"),
        )
        return [compile_unit(compiler, own, folder / "own.c"), kept]

    with ThreadPoolExecutor(1) as pool:
        others = pool.submit(beside)
        model, _ = cache.load(
            cache.key_of(of_model, f"{lanes} lanes"),
            compiled,
            lambda path: _copied(path, folder / "model.o"),
        )
    return build_library(compiler, [], folder, [*others.result(), model])


def _copied(path: Path, place: Path) -> Path:
    return Path(shutil.copy(path, place))


def _facts(path: Path) -> ModelFacts:
    return ModelFacts(**json.loads(path.read_text(encoding="utf-8")))
