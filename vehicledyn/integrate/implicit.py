"""Rates and residuals as CasADi's integrators take them, with their exact Jacobian.

Compiled where the kernel is: one function of one lane, and slopes along many columns of the
Jacobian at once, a lane for each colour. Columns that share no row have the same colour. The
integrators of CasADi find the functions in the library and ask them for all they need.
"""

from __future__ import annotations

import ctypes
import logging
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.codegen.ir.table_rows import TableRows
from vehicledyn.codegen.toolchain import cache
from vehicledyn.codegen.toolchain.compiler import (
    CompilationError,
    build_library,
    find_compiler,
    suitable_lanes,
)
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import Progress
from vehicledyn.symbolic.equations import Equations

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class ImplicitEquations:
    """What an integrator of CasADi is made from.

    ``function`` is (t, x, z, c) -> (rates, residuals), a ``casadi.Function`` to be called with
    symbols of the type ``symbols``; ``constants`` returns c, shape (n_constants,), from the
    values of the parameters. ``sizes`` are the numbers of states and unknowns, ``library`` is the
    machine code, None where the equations are interpreted.
    """

    function: Any
    symbols: Any
    sizes: tuple[int, int]
    n_constants: int
    constants: Callable[[Vector], Vector]
    library: Any = None


def implicit_equations(kernel: Kernel, progress: Progress) -> ImplicitEquations:
    """Return the equations of a kernel, compiled where the kernel is.

    They are made once for all parameter sets of a kernel. Where the compiler fails the
    equations are interpreted, and a warning says so.
    """
    found = kernel.made.get("implicit")
    if found is None:
        found = kernel.made["implicit"] = _make(kernel, progress)
    return found


def _key(kernel: Kernel) -> str:
    return cache.key_of(kernel.key, "implicit", f"{suitable_lanes()} lanes")


def _make(kernel: Kernel, progress: Progress) -> ImplicitEquations:
    if not kernel.key:
        return _interpreted(kernel.equations)
    try:
        return _compiled(kernel, progress)
    except CompilationError as error:
        _log.warning("%s; the Jacobian of the run is interpreted, which is slower", error)
        return _interpreted(kernel.equations)


def _interpreted(equations: Equations) -> ImplicitEquations:
    import casadi

    e = equations
    inputs = [e.time, e.state, e.algebraic, e.parameter]
    results = [casadi.densify(e.rate), casadi.densify(e.residual)]
    function = casadi.Function("dae", inputs, results)
    sizes = len(e.states), len(e.unknowns)
    return ImplicitEquations(function, casadi.SX, sizes, len(e.parameters), lambda values: values)


def _compiled(kernel: Kernel, progress: Progress) -> ImplicitEquations:
    import casadi

    equations = kernel.equations
    compiler, lanes = find_compiler(), suitable_lanes()

    def build(folder: Path) -> Path:
        from vehicledyn.codegen.printers.implicit_source import implicit_source

        progress("deriving the Jacobian", None)
        source = implicit_source(equations, lanes)
        progress(f"compiling the Jacobian with {compiler.description}", None)
        return build_library(compiler, source, folder)

    (library, n_constants, function), entry = cache.load(_key(kernel), build, _open)
    if entry.remark and not kernel.report.remark:
        _log.warning(entry.remark)
    tables = TableRows(equations.tables)

    def constants(values: Vector) -> Vector:
        given, found = tables.after(values), tables.after(np.zeros(n_constants))
        library.vd_dae_prepare(given.ctypes.data, found.ctypes.data)
        return found

    sizes = len(equations.states), len(equations.unknowns)
    return ImplicitEquations(function, casadi.MX, sizes, function.numel_in(3), constants, library)


def _open(path: Path) -> tuple[Any, int, Any]:
    """Return the library, the number of constants, and the function of CasADi."""
    import casadi

    library = ctypes.CDLL(str(path))
    prepare = library.vd_dae_prepare
    prepare.restype, prepare.argtypes = None, [ctypes.c_void_p, ctypes.c_void_p]
    n_constants = int(ctypes.c_int.in_dll(library, "vd_dae_constants").value)
    return library, n_constants, casadi.external("vd_dae", str(path))
