"""Write a system as C99: a header and a source that need nothing but math.h."""

from __future__ import annotations

import textwrap

from vehicledyn.export.document import (
    ExportedSystem,
    head,
    indented,
    missing,
    parameter_rows,
    result_lines,
    statement_lines,
    text_of,
)
from vehicledyn.export.procedures import Procedure
from vehicledyn.export.statements import PrintedFunction
from vehicledyn.export.tables import c_table

_SIGN = """\

static double sign_of(double a) { return a < 0.0 ? -1.0 : a > 0.0 ? 1.0 : a; }
"""

_SOLVE = """\
/* Solve A x = b by elimination with pivots; x replaces b. Return 0 if A is singular. */
static int solve_linear(double A[@N@][@N@], double b[@N@]) {
  for (int j = 0; j < @N@; j++) {
    int pivot = j;
    for (int i = j + 1; i < @N@; i++)
      if (fabs(A[i][j]) > fabs(A[pivot][j])) pivot = i;
    if (!(fabs(A[pivot][j]) > 0.0)) return 0;
    for (int k = 0; k < @N@; k++) {
      const double held = A[j][k];
      A[j][k] = A[pivot][k];
      A[pivot][k] = held;
    }
    const double held = b[j];
    b[j] = b[pivot];
    b[pivot] = held;
    for (int i = j + 1; i < @N@; i++) {
      const double factor = A[i][j] / A[j][j];
      for (int k = j; k < @N@; k++) A[i][k] -= factor * A[j][k];
      b[i] -= factor * b[j];
    }
  }
  for (int j = @N@ - 1; j >= 0; j--) {
    for (int k = j + 1; k < @N@; k++) b[j] -= A[j][k] * b[k];
    b[j] /= A[j][j];
  }
  return 1;
}

int @NAME@_solve_loops(double t, const double x[], double z[], const struct @NAME@_parameters *p) {
  for (int iteration = 0; iteration < 50; iteration++) {
    double g[@N@], G[@N@][@N@];
    int small = 1;
    @NAME@_loops(t, x, z, p, g, G);
    if (!solve_linear(G, g)) return -1;
    for (int i = 0; i < @N@; i++) {
      z[i] -= g[i];
      if (!(fabs(g[i]) <= 1e-10 * (1.0 + fabs(z[i])))) small = 0;
    }
    if (small) return iteration + 1;
  }
  return -1;
}
"""

_NOTHING_TO_SOLVE = """\
int @NAME@_solve_loops(double t, const double x[], double z[], const struct @NAME@_parameters *p) {
  (void)t, (void)x, (void)z, (void)p;
  return 0;
}
"""


def c_header(document: ExportedSystem) -> str:
    """Return the text of the header."""
    name = document.name
    guard = f"{name.upper()}_H"
    lines = [
        *(f"// {line}".rstrip() for line in head(document)),
        "",
        f"#ifndef {guard}",
        f"#define {guard}",
        "",
        "// Lengths of the arrays.",
        *(f"#define {name.upper()}_N{k} {n}" for k, n in document.sizes().items()),
        "",
        f"struct {name}_parameters {{",
        *(f"  double {field};  // {text}" for field, _, text in parameter_rows(document)),
        *([] if document.parameters else ["  double none;"]),
        "};",
        "",
        "// What the system was exported with: parameters, states, unknowns that solve the loops.",
        f"extern const struct {name}_parameters {name}_defaults;",
        f"extern const double {name}_x_start[], {name}_z_start[];",
    ]
    for procedure, _ in document.written:
        lines += ["", f"// {procedure.summary}", f"{_signature(document, procedure)};"]
    lines += [
        "",
        "// Solve the loops near a guess z in place; return the iterations, or -1 if it fails.",
        f"int {name}_solve_loops(double t, const double x[], double z[], "
        f"const struct {name}_parameters *p);",
        "",
        "#endif",
    ]
    return text_of(lines)


def c_source(document: ExportedSystem) -> str:
    """Return the text of the source; it includes the header by the model's name."""
    name, n = document.name, document.sizes()["z"]
    lines = [
        f"// {document.equations.name}: see {name}.h for the meaning of everything.",
        "",
        "#include <math.h>",
        "",
        f'#include "{name}.h"',
        *(_SIGN.splitlines() if "SIGN" in document.features else []),
        "",
        f"const struct {name}_parameters {name}_defaults = {{",
        *(
            f"  .{field} = {document.language.number(value).text},"
            for field, value, _ in parameter_rows(document)
        ),
        *([] if document.parameters else ["  .none = 0.0,"]),
        "};",
        _wrapped(f"const double {name}_x_start[] = {_numbers(document.start.state)};"),
        _wrapped(f"const double {name}_z_start[] = {_numbers(document.start.unknowns)};"),
    ]
    for named in document.tables:
        lines += ["", *c_table(named)]
    for procedure, body in document.written:
        lines += ["", *_function(document, procedure, body)]
    solve = (_SOLVE if n else _NOTHING_TO_SOLVE).replace("@NAME@", name).replace("@N@", str(n))
    return text_of([*lines, "", *solve.splitlines()])


def _signature(document: ExportedSystem, procedure: Procedure) -> str:
    arguments = []
    for argument in procedure.arguments:
        if argument.is_scalar:
            arguments.append(f"double {argument.name}")
        elif argument.name == "p":
            arguments.append(f"const struct {document.name}_parameters *p")
        else:
            arguments.append(f"const double {argument.name}[]")
    for target in procedure.targets:
        inner = "".join(f"[{max(1, size)}]" for size in target.shape[1:])
        arguments.append(f"double {target.name}[]{inner}")
    return _wrapped(f"void {document.name}_{procedure.name}({', '.join(arguments)})")


def _function(document: ExportedSystem, procedure: Procedure, body: PrintedFunction) -> list[str]:
    language = document.language
    empty = {target.name for target in procedure.targets if not target.entries}
    unused = [a.name for a in procedure.arguments if a.name not in body.arguments]
    lines = [f"(void){name};" for name in [*unused, *sorted(empty)]]
    lines += statement_lines(body, language, "const double {} = {};")
    lines.append("")
    for k, target in enumerate(procedure.targets):
        if missing(procedure, k):
            lines += _zeros(target.name, target.shape)
    lines += result_lines(procedure, body, language, ";")
    return [f"{_signature(document, procedure)} {{", *indented(lines, 2), "}"]


def _zeros(name: str, shape: tuple[int, ...]) -> list[str]:
    letters = "ij"[: len(shape)]
    loops = [f"for (int {k} = 0; {k} < {n}; {k}++)" for k, n in zip(letters, shape, strict=True)]
    return [f"{' '.join(loops)} {name}{''.join(f'[{k}]' for k in letters)} = 0.0;"]


def _wrapped(text: str) -> str:
    return textwrap.fill(text, 100, subsequent_indent="    ", break_long_words=False)


def _numbers(values: tuple[float, ...]) -> str:
    return f"{{{', '.join(repr(float(value)) for value in values) or '0.0'}}}"
