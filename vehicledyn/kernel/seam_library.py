"""Build a kernel that is cut at its seam: its model from the cache, only its surroundings anew."""

from __future__ import annotations

import json
import shutil
from dataclasses import asdict
from pathlib import Path

from vehicledyn.codegen.passes.seam_cut import SeamCut
from vehicledyn.codegen.printers.seam_source import (
    ModelFacts,
    facts_of_model,
    model_units,
    surroundings_source,
)
from vehicledyn.codegen.toolchain import cache
from vehicledyn.codegen.toolchain.compiler import (
    Compiler,
    build_library,
    build_object,
    compiled_meanwhile,
)
from vehicledyn.codegen.toolchain.fingerprint import generator_fingerprint


def seam_library(cut: SeamCut, compiler: Compiler, folder: Path, lanes: int | None = None) -> Path:
    """Return the library of a kernel, built in a folder; its model is kept for other surroundings.

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

    def told(place: Path) -> Path:
        file = place / "facts.json"
        file.write_text(json.dumps(asdict(facts_of_model(cut))), encoding="utf-8")
        return file

    def taken(path: Path) -> Path:
        return Path(shutil.copy(path, folder / "model.o"))

    facts, _ = cache.load(cache.key_of(of_model, "facts"), told, _facts)
    with compiled_meanwhile(compiler, surroundings_source(cut, facts, lanes), folder) as own:
        model, _ = cache.load(cache.key_of(of_model, f"{lanes} lanes"), compiled, taken)
    return build_library(compiler, [], folder, [own.result(), model])


def _facts(path: Path) -> ModelFacts:
    return ModelFacts(**json.loads(path.read_text(encoding="utf-8")))
