"""Print a kernel that is cut at its seam: the model by itself, and what surrounds it.

The model's units are compiled once for all surroundings, the loop once for all kernels of the same
sizes; the unit of the surroundings calls the model by the names below, and the loop calls that
unit. In c the constants of the surroundings come first, so that the model finds its own with the
rows of tables and the copies behind them at the pointer it gets.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from vehicledyn.codegen.ir.instructions import read_function
from vehicledyn.codegen.ir.table_rows import ROW
from vehicledyn.codegen.passes.seam_cut import SeamCut
from vehicledyn.codegen.passes.signed_constants import mirrored_constants
from vehicledyn.codegen.passes.slp_rows import PLACES
from vehicledyn.codegen.printers.c_printer import print_function
from vehicledyn.codegen.printers.kernel_source import (
    KernelSizes,
    kernel_counts,
    kernel_tables,
    lane_head,
    listed,
    loop_source,
    shared_source,
    wide_units,
)
from vehicledyn.codegen.printers.row_printer import Copies
from vehicledyn.codegen.printers.wide_functions import WideFunctions
from vehicledyn.codegen.toolchain.compiler import suitable_lanes

_MODEL = ("t", "x", "z", "u", "c")
_OWN = ("t", "x", "z", "c")
_BITS = "unsigned long long pieces, "


@dataclass(frozen=True)
class ModelFacts:
    """What those who call a compiled model know of it: constants and operations."""

    constants: int
    operations: dict[str, int]


def facts_of_model(cut: SeamCut) -> ModelFacts:
    """Return the facts of the model of a cut, which is derived for them."""
    return ModelFacts(cut.model.prepare.numel_out(0), cut.model.operations)


def model_units(cut: SeamCut, lanes: int | None) -> Iterator[str]:
    """Yield the units of the model one by one, for cases in lanes or, with None, for one alone."""
    half, tables = cut.model, cut.equations.tables
    alone = lanes is None
    wide = WideFunctions(suitable_lanes()) if alone else None
    in_rows = alone and suitable_lanes() >= PLACES
    copies = Copies(half.prepare.numel_out(0) + ROW * len(tables)) if in_rows else None
    mirrored = None if alone else mirrored_constants(read_function(half.prepare, tables))
    head = lane_head(lanes or 1) + ([shared_source("fours.h")] if in_rows else [])
    small = [print_function(half.prepare, "prepare", ["p"], tables=tables)]
    small.append("void vd_model_prepare(const real *p, real *c) {\n  prepare(p, c);\n}\n")
    # The outputs, which take the compiler longest, come first.
    for name in sorted(half.functions, key=lambda name: name != "outputs"):
        function = half.functions[name]
        chosen = name == "outputs" and not alone
        is_large = name in ("rates", "outputs")
        text = print_function(
            function,
            name,
            _MODEL,
            tables=tables,
            wide=wide if is_large else None,
            copies=copies if name not in ("events", "resets") else None,
            mirrored=mirrored if name not in ("events", "resets") else None,
            selectable=chosen,
        )
        text += _entry(name, chosen)
        if is_large:
            yield "\n".join([*head, text])
        else:
            small.append(text)
    yield from [] if wide is None else wide_units(wide)
    if alone:
        small.append((copies or Copies(0)).text)
        small.append("void vd_model_lay_out(real *c) {\n  lay_out(c);\n}\n")
    yield "\n".join([*head, *small])


def _given(chosen: bool) -> str:
    arrays = ", ".join(f"const real *{name}" for name in _MODEL)
    return f"{_BITS if chosen else ''}{arrays}, real *r"


def _entry(name: str, chosen: bool) -> str:
    """Return what others call a function of the model by."""
    own, bits = (f"{name}_selected", "pieces, ") if chosen else (name, "")
    text = (
        f"void vd_model_{name}({_given(chosen)}) {{\n  {own}({bits}{', '.join(_MODEL)}, r);\n}}\n"
    )
    if chosen:
        text += f"unsigned long long vd_model_{name}_need(int k) {{\n  return {name}_need(k);\n}}\n"
    return text


def surroundings_source(cut: SeamCut, facts: ModelFacts, lanes: int | None) -> str:
    """Return the source of the surroundings, joined with the model, see :func:`model_units`."""
    half, tables = cut.surroundings(facts.constants), cut.equations.tables
    first = half.prepare.numel_out(0)
    texts = [
        print_function(half.prepare, "prepare_own", ["p"], tables=tables),
        "void vd_model_prepare(const real *p, real *c);\n"
        "void vd_kernel_prepare(const real *p, real *c) {\n"
        f"  prepare_own(p, c);\n  vd_model_prepare(p, c + {first});\n}}\n",
    ]
    for name, function in half.functions.items():
        texts.append(print_function(function, f"{name}_own", _OWN, tables=tables))
        texts.append(_joined(cut, name, first, chosen=name == "outputs" and lanes is not None))
    counts = {key: count + half.operations[key] for key, count in facts.operations.items()}
    texts.append(
        kernel_counts(replace(_sizes(cut), constants=first + facts.constants, operations=counts))
    )
    if lanes is None:
        texts.append(
            "void vd_model_lay_out(real *c);\n"
            f"void vd_kernel_lay_out(real *c) {{\n  vd_model_lay_out(c + {first});\n}}\n"
        )
    return "\n".join([*lane_head(lanes or 1), *texts])


def loop_unit(cut: SeamCut, lanes: int | None) -> str:
    """Return the source of the loop, equal for all kernels of the same sizes, see `model_units`."""
    chosen = lanes is not None
    texts = [
        "void vd_kernel_prepare(const real *p, real *c);\n#define prepare vd_kernel_prepare\n",
        *(_called(name, chosen=chosen and name == "outputs") for name in cut.model_places),
    ]
    if not chosen:
        texts.append("void vd_kernel_lay_out(real *c);\n#define lay_out vd_kernel_lay_out\n")
    texts += [kernel_tables(cut.equations, _sizes(cut)), shared_source("steps.c")]
    return "\n".join(
        [*lane_head(lanes or 1), *texts, shared_source("batch.c") if chosen else loop_source()]
    )


def _sizes(cut: SeamCut) -> KernelSizes:
    """Return the sizes of a kernel but those that are known when all of it is printed."""
    waves = [f"wave_{k}" for k in range(len(cut.wave_starts))]
    sizes = tuple(_size(cut, name) for name in waves)
    return KernelSizes(cut.wave_starts, sizes, 0, _size(cut, "resets"), {})


def _called(name: str, *, chosen: bool) -> str:
    """Return how the loop calls a function of the kernel."""
    arrays = ", ".join(f"const real *{item}" for item in _OWN)
    function = f"{name}_selected" if chosen else name
    lines = [
        f"void vd_kernel_{name}({_BITS if chosen else ''}{arrays}, real *r);",
        f"#define {function} vd_kernel_{name}",
    ]
    if chosen:
        lines += [
            f"unsigned long long vd_kernel_{name}_need(int place);",
            f"#define {name}_need vd_kernel_{name}_need",
        ]
    return "\n".join([*lines, ""])


def _size(cut: SeamCut, name: str) -> int:
    """Return how many numbers a function of the kernel finds."""
    return len(cut.model_places[name]) + len(cut.own_places[name])


def _joined(cut: SeamCut, name: str, first: int, *, chosen: bool) -> str:
    """Return a function of the kernel: what its two sides find, each in its places."""
    model, own = cut.model_places[name], cut.own_places[name]
    there = model == list(range(len(model)))
    bits = "pieces, " if chosen else ""
    room = {"u": len(cut.handed), "own": len(own)} | ({} if there else {"found": len(model)})
    lines = [
        f"void vd_model_{name}({_given(chosen)});",
        listed("static const int", f"{name}_model_places", model),
        f"void vd_kernel_{name}({_BITS if chosen else ''}const real *t, const real *x, "
        "const real *z, const real *c, real *r) {",
        *(f"  real {array}[{max(1, size)}];" for array, size in room.items()),
        f"  {name}_own(t, x, z, c, u, own);",
        f"  vd_model_{name}({bits}t, x, z, u, c + {first}, {'r' if there else 'found'});",
    ]
    if not there:
        lines.append(
            f"  for (int k = 0; k < {len(model)}; k++) r[{name}_model_places[k]] = found[k];"
        )
    lines += [*(f"  r[{place}] = own[{k}];" for k, place in enumerate(own)), "}"]
    if chosen:
        lines += [
            f"unsigned long long vd_model_{name}_need(int k);",
            f"unsigned long long vd_kernel_{name}_need(int place) {{",
            f"  for (int k = 0; k < {len(model)}; k++)",
            f"    if ({name}_model_places[k] == place) return vd_model_{name}_need(k);",
            "  return 0;",
            "}",
        ]
    return "\n".join([*lines, ""])
