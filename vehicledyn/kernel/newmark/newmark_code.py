"""The compiled steps of Newmark's family, one library for all models; see record.h."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from enum import IntEnum
from pathlib import Path
from typing import TypeVar

from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.codegen.printers.kernel_source import shared_source
from vehicledyn.codegen.toolchain import cache
from vehicledyn.codegen.toolchain.compiler import build_library, find_compiler

T = TypeVar("T")

_QUICK = """\
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("O3")
#endif"""

_D, _L, _P = ctypes.c_double, ctypes.c_longlong, ctypes.c_void_p


class Outcome(IntEnum):
    """How a call ended; the numbers are those of record.h."""

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


MOST_LANES = 8
"""Lanes that a record has room for."""


class PlaceRecord(ctypes.Structure):
    """A ``struct place`` of record.h."""

    _fields_ = [
        ("time", _D * MOST_LANES),
        ("size", _D * MOST_LANES),
        *((name, _P) for name in ("x", "z", "rates", "auxiliary", "change", "drift", "forces")),
    ]


class ConstrainedRecord(ctypes.Structure):
    """A ``struct constrained`` of record.h."""

    _fields_ = [
        *((name, _P) for name in ("residual", "output", "spread", "given")),
        *((name, _P) for name in ("l_values", "u_values", "lightness", "back", "arms")),
        *((name, _P) for name in ("l_starts", "l_rows", "u_starts", "u_rows")),
        *((name, _P) for name in ("row_place", "column_place", "arm_starts", "arm_columns")),
        *((name, _L) for name in ("n_multipliers", "n_others", "is_stabilised")),
        *((name, _D) for name in ("lead", "scale", "lever")),
        *((name, _D) for name in ("first_order_mass", "first_order_gamma")),
        *((name, _D) for name in ("close_states", "close_forces", "back_from")),
    ]


class TriangleRecord(ctypes.Structure):
    """A ``struct triangle`` of record.h."""

    _fields_ = [
        *((name, _P) for name in ("starts", "rows", "run_starts", "run_firsts", "run_counts")),
    ]


class PatternRecord(ctypes.Structure):
    """A ``struct pattern`` of record.h."""

    _fields_ = [
        *((name, _P) for name in ("starts", "rows", "places", "levers")),
        *((name, _P) for name in ("colour_starts", "colour_columns", "order")),
        ("below", TriangleRecord),
        ("above", TriangleRecord),
        *((name, _L) for name in ("n_colours", "n_entries")),
    ]


class MatrixRecord(ctypes.Structure):
    """A ``struct matrix`` of record.h."""

    _fields_ = [
        ("size", _D),
        *((name, _L) for name in ("is_stale", "has_jacobian", "is_full", "halvings")),
        *((name, _L) for name in ("fewest", "wasted")),
    ]


class RunRecord(ctypes.Structure):
    """A ``struct run`` of record.h."""

    _fields_ = [
        *((name, _P) for name in ("solve", "rates_at", "outputs", "events", "survey")),
        *((name, _P) for name in ("lane_rates", "lane_sample", "constants", "tolerances")),
        *((name, _P) for name in ("new_mass", "gamma", "rows", "positions", "velocities")),
        *((name, _P) for name in ("pairs", "rising", "falling", "channels", "sides", "from_rows")),
        *((name, _P) for name in ("lane_status", "lane_where", "jacobian", "dense", "base")),
        *((name, _P) for name in ("lane_residual", "lane_samples", "lower", "upper", "inverse")),
        *((name, _P) for name in ("work", "given", "watched", "xs", "zs", "ys", "figures")),
        *((name, _P) for name in ("counts", "good")),
        ("at", PlaceRecord),
        ("found", PlaceRecord),
        *((name, _L) for name in ("n_states", "n_unknowns", "n_outputs", "n_blocks")),
        *((name, _L) for name in ("n_events", "n_rows", "n_pairs", "n_constants", "n_channels")),
        *((name, _L) for name in ("stride", "halvings", "is_within", "step", "last")),
        *((name, _L) for name in ("per_interval", "budget", "room", "status")),
        *((name, _D) for name in ("alpha_m", "alpha_f", "beta", "second_order_gamma")),
        *((name, _D) for name in ("tolerance", "shortest", "blind_until", "start", "interval")),
        *((name, _D) for name in ("end", "whole", "to", "error", "least", "most", "wanted")),
        *((name, _D) for name in ("weak", "first_order_gamma", "share")),
        *((name, _L) for name in ("n_rates", "n_watched")),
        ("pattern", PatternRecord),
        ("constrained", ConstrainedRecord),
        ("matrix", MatrixRecord * MOST_LANES),
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


class NewmarkLanes:
    """Machine code that takes steps in all lanes of any lane engine."""

    def __init__(self, path: Path) -> None:
        """Load the library.

        Raises
        ------
        OSError, AttributeError
            If the file is none.
        """
        library = ctypes.CDLL(str(path))
        self._begin, self._advance = library.vd_newmark_begin, library.vd_newmark_advance
        for function in (self._begin, self._advance):
            function.restype, function.argtypes = ctypes.c_int, [_P]

    def begin(self, run: RunRecord) -> bool:
        """Find the rates at ``run.at``; return whether any lane goes on."""
        return bool(self._begin(ctypes.addressof(run)))

    def advance(self, run: RunRecord) -> bool:
        """Take steps up to ``run.last``; return whether any lane goes on."""
        return bool(self._advance(ctypes.addressof(run)))


_LOADED: BoundedCache[str, NewmarkCode] = BoundedCache(2)
_LANES: BoundedCache[str, NewmarkLanes] = BoundedCache(4)
"""By key: one for each number of lanes, and others after a change of compiler."""


def newmark_code() -> NewmarkCode:
    """Return the machine code for one case, from the cache if it is there.

    Raises
    ------
    CompilationError
        If there is no compiler, or it fails.
    """
    return _loaded(_LOADED, NewmarkCode, 1, ("run.c", "constrained.c"))


def newmark_lanes(lanes: int) -> NewmarkLanes:
    """Return the machine code for so many cases side by side, from the cache if it is there.

    Raises
    ------
    CompilationError
        If there is no compiler, or it fails.
    """
    return _loaded(_LANES, NewmarkLanes, lanes, ("lanes.c",))


def _loaded(
    known: BoundedCache[str, T], kind: Callable[[Path], T], lanes: int, files: tuple[str, ...]
) -> T:
    compiler = find_compiler()
    own = [Path(__file__).with_name(name) for name in ("record.h", "matrix.c", "step.c", *files)]
    texts = [file.read_text(encoding="utf-8") for file in own]
    head = [_QUICK, f"#define VD_LANES {lanes}", shared_source("real.h")]
    source = "\n".join([*head, *texts])
    key = cache.key_of("newmark", source, compiler.identity)

    def build(folder: Path) -> Path:
        return build_library(compiler, source, folder)

    return known.get(key, lambda: cache.load(key, build, kind)[0])
