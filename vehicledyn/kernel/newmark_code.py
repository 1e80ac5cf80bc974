"""The compiled steps of Newmark's family, one library for all models; see newmark.c.

Those with multipliers are in constrained.c.
"""

from __future__ import annotations

import ctypes
from enum import IntEnum
from pathlib import Path

from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.codegen.toolchain import cache
from vehicledyn.codegen.toolchain.compiler import build_library, find_compiler

_D, _L, _P = ctypes.c_double, ctypes.c_longlong, ctypes.c_void_p


class Outcome(IntEnum):
    """How a call ended; the numbers are those of newmark.c."""

    TAKEN = 0
    REFUSED = 1
    NEEDS_JACOBIAN = 2
    CROSSED = 3
    STUCK = 4
    INEXACT = 5
    UNSOLVED = 6
    INACCURATE = 7
    PAUSED = 8


NO_JACOBIAN, KEPT_JACOBIAN, FRESH_JACOBIAN = 0, 1, 2
"""Values of ``has_jacobian``: none is there, one of an earlier step, one of the step to come."""


class PlaceRecord(ctypes.Structure):
    """A ``struct place`` of newmark.c."""

    _fields_ = [
        *((name, _D) for name in ("time", "size")),
        *((name, _P) for name in ("x", "z", "rates", "auxiliary", "change", "forces")),
    ]


class ConstrainedRecord(ctypes.Structure):
    """A ``struct constrained`` of newmark.c."""

    _fields_ = [
        *((name, _P) for name in ("residual", "given", "l_values", "u_values", "arms")),
        *((name, _P) for name in ("l_starts", "l_rows", "u_starts", "u_rows")),
        *((name, _P) for name in ("row_place", "column_place", "arm_starts", "arm_columns")),
        *((name, _L) for name in ("n_multipliers", "n_others", "is_stabilised")),
        *((name, _D) for name in ("lead", "scale", "lever")),
        *((name, _D) for name in ("first_order_mass", "first_order_gamma")),
    ]


class RunRecord(ctypes.Structure):
    """A ``struct run`` of newmark.c."""

    _fields_ = [
        *((name, _P) for name in ("solve", "rates", "outputs", "events", "survey")),
        *((name, _P) for name in ("constants", "tolerances", "new_mass", "gamma")),
        *((name, _P) for name in ("rows", "positions", "velocities", "pairs")),
        *((name, _P) for name in ("rising", "falling", "sides", "pivots", "jacobian", "matrix")),
        *((name, _P) for name in ("work", "xs", "zs", "ys", "figures", "counts")),
        ("at", PlaceRecord),
        ("found", PlaceRecord),
        *((name, _L) for name in ("n_states", "n_unknowns", "n_outputs", "n_blocks")),
        *((name, _L) for name in ("n_events", "n_rows", "n_pairs")),
        *((name, _L) for name in ("is_stale", "has_jacobian", "halvings", "is_within")),
        *((name, _L) for name in ("step", "last", "per_interval", "budget", "room", "status")),
        *((name, _D) for name in ("alpha_m", "alpha_f", "beta", "second_order_gamma")),
        *((name, _D) for name in ("tolerance", "shortest", "blind_until", "start", "interval")),
        *((name, _D) for name in ("end", "whole", "to", "factored", "error", "least", "most")),
        ("wanted", _D),
        *((name, _L) for name in ("n_rates", "n_watched")),
        ("constrained", ConstrainedRecord),
    ]


class NewmarkCode:
    """Machine code that takes steps on the functions of any compiled kernel."""

    def __init__(self, path: Path) -> None:
        """Load the library.

        Raises
        ------
        OSError, AttributeError
            If the file is none.
        """
        library = ctypes.CDLL(str(path))
        self._step, self._advance = library.vd_newmark_step, library.vd_newmark_advance
        self._step.restype = self._advance.restype = ctypes.c_int
        self._step.argtypes, self._advance.argtypes = [_P, _D], [_P]

    def step(self, run: RunRecord, end: float) -> Outcome:
        """Try a step from ``run.at`` to ``run.found``."""
        return Outcome(self._step(ctypes.addressof(run), end))

    def advance(self, run: RunRecord) -> Outcome:
        """Take steps until the run ends or something must be done."""
        return Outcome(self._advance(ctypes.addressof(run)))


_LOADED: BoundedCache[str, NewmarkCode] = BoundedCache(2)
"""By key: one, and another after a change of compiler."""


def newmark_code() -> NewmarkCode:
    """Return the machine code, from the cache if it is there.

    Raises
    ------
    CompilationError
        If there is no compiler, or it fails.
    """
    compiler = find_compiler()
    files = [Path(__file__).with_name(name) for name in ("newmark.c", "constrained.c")]
    source = "\n".join(file.read_text(encoding="utf-8") for file in files)
    key = cache.key_of("newmark", source, compiler.identity)

    def build(folder: Path) -> Path:
        return build_library(compiler, source, folder)

    return _LOADED.get(key, lambda: cache.load(key, build, NewmarkCode)[0])
