"""The functions of a kernel as the equations have them, for models too large to be worked over.

Nothing is moved apart from the parameters, so that a model must have none. The virtual machine
takes as long for these functions as for those of :mod:`vehicledyn.codegen.passes.kernel_functions`,
which are a compiler's.
"""

from __future__ import annotations

from typing import Any

from vehicledyn.codegen.passes.kernel_functions import (
    KernelFunctions,
    block_expressions,
    event_expressions,
)
from vehicledyn.symbolic.equations import Equations


def plain_functions(equations: Equations) -> KernelFunctions:
    """Return the functions of a kernel for equations without parameters.

    Raises
    ------
    ValueError
        If there are parameters.
    """
    import casadi

    e = equations
    if e.parameters:
        raise ValueError(f"model '{e.name}' has parameters")
    given = [e.time, e.state, e.algebraic, e.parameter]
    found = [e.rate, e.output, *event_expressions(e), *block_expressions(e)]
    rate, output, events, resets, *blocks = casadi.cse(
        [casadi.densify(casadi.SX(item)) for item in found]
    )

    def function(name: str, *results: Any) -> Any:
        return casadi.Function(name, given, list(results))

    return KernelFunctions(
        prepare=casadi.Function("prepare", [e.parameter], [casadi.SX(e.parameter)]),
        rates=function("rates", rate),
        outputs=function("outputs", output),
        blocks=tuple(
            function(f"block_{k}", *blocks[2 * k : 2 * k + 2]) for k in range(len(e.blocks))
        ),
        events=function("events", events),
        resets=function("resets", resets),
        waves=(),
        wave_starts=(),
    )
