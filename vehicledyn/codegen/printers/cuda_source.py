"""The source of a kernel for CUDA: one case a thread, printed from the same expressions."""

from __future__ import annotations

import re

from vehicledyn.base.errors import InputError
from vehicledyn.codegen.ir.table_rows import ROW
from vehicledyn.codegen.passes.kernel_functions import derive_functions
from vehicledyn.codegen.printers.kernel_source import shared_source, shared_texts
from vehicledyn.symbolic.equations import Equations

_LOCAL = re.compile(r"^((?:VD_APART )?)static ", re.MULTILINE)


def cuda_source(equations: Equations) -> str:
    """Return a complete CUDA source that runs many cases of a model with fixed steps.

    It offers ``vd_prepare_cases`` and ``vd_run_cases``, which its text explains; compile it with
    ``--fmad=false``, since products and sums are fused by name. Methods are 0 for RK4 and 1 for
    symplectic Euler.

    Parameters
    ----------
    equations
        A model without events.

    Raises
    ------
    InputError
        If the model has events, which need a look at every step.
    """
    if equations.events:
        raise InputError(
            f"model '{equations.name}' has events, which runs on a GPU do not watch; "
            "run it on the processor"
        )
    functions = derive_functions(equations)
    n_parameters, n_constants = len(equations.parameters), functions.prepare.numel_out(0)
    sizes = {
        "NP": n_parameters,
        "NC": n_constants,
        "NT": ROW * len(equations.tables),
    }
    texts = [
        _contents(equations),
        shared_source("cuda.h"),
        *(f"#define {name} {size}" for name, size in sizes.items()),
        *(_LOCAL.sub(r"\1VD_DEVICE ", text) for text in shared_texts(equations, functions)),
        shared_source("cuda.cu"),
    ]
    return "\n".join(texts)


def _contents(equations: Equations) -> str:
    """Return a comment that gives the order of all numbers, with units and starts."""
    named: list[tuple[str, list[str]]] = [
        ("parameters p", [f"{p.name} [{p.unit}] = {p.value!r}" for p in equations.parameters]),
        ("states x", [f"{v.name} [{v.unit}] = {v.start!r}" for v in equations.states]),
        ("unknowns z", [f"{v.name} [{v.unit}] = {v.start!r}" for v in equations.unknowns]),
        ("channels", [f"{v.name} [{v.unit}]" for v in equations.channels]),
        ("blocks", [block.name for block in equations.blocks]),
        ("tables", [f"{t.name}: cells of {t.order + 1} numbers" for t in equations.tables]),
    ]
    lines = [f"Model '{equations.name}', the numbers of a case in order."]
    for title, items in named:
        lines += ["", f"{title}:", *(f"  {k} {item}" for k, item in enumerate(items))]
    text = "\n".join(lines).replace("*/", "* /")
    return f"/* {text}\n*/"
