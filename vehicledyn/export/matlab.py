"""Write a system as one MATLAB (or Octave) function that returns handles of its functions."""

from __future__ import annotations

from vehicledyn.export.document import (
    ExportedSystem,
    head,
    indented,
    parameter_rows,
    result_lines,
    statement_lines,
    text_of,
)
from vehicledyn.export.procedures import Procedure
from vehicledyn.export.statements import PrintedFunction
from vehicledyn.export.tables import matlab_table

_SOLVE = """\
function z = solve_loops(t, x, z, p)
  % The unknowns near a guess z that solve the loops, by Newton's method.
  for iteration = 1:50
    [g, G] = loops(t, x, z, p);
    step = G \\ g;
    z = z - step;
    if all(abs(step) <= 1e-10 * (1.0 + abs(z)))
      return
    end
  end
  error('the loops do not close near these unknowns');
end
"""

_HELPERS = {
    "IF_ELSE_ZERO": """\
function y = if_else_zero(condition, value)
  if condition
    y = value;
  else
    y = 0.0;
  end
end
""",
    "COPYSIGN": """\
function y = copy_sign(value, other)
  y = abs(value);
  if other < 0.0 || 1.0 / other < 0.0
    y = -y;
  end
end
""",
    "REMAINDER": """\
function r = remainder_of(value, divisor)
  n = round(value / divisor);
  if abs(value / divisor - fix(value / divisor)) == 0.5
    n = 2.0 * round(value / divisor / 2.0);
  end
  r = value - n * divisor;
end
""",
}


def matlab_function(document: ExportedSystem) -> str:
    """Return the text of the function file, to be named after the model."""
    name, comment = document.name, document.language.comment
    lines = [
        f"function model = {name}()",
        *(f"{comment} {line}".rstrip() for line in head(document)),
        "",
        *indented(_model(document), 2),
        "end",
    ]
    for procedure, body in document.written:
        lines += ["", *_function(document, procedure, body)]
        if procedure.name == "loops":
            lines += ["", *_SOLVE.splitlines()]
    for named in document.tables:
        lines += ["", *matlab_table(named)]
    for operation in sorted(document.features & set(_HELPERS)):
        lines += ["", *_HELPERS[operation].splitlines()]
    return text_of(lines)


def _model(document: ExportedSystem) -> list[str]:
    rows = [
        f"p.{name} = {document.language.number(value).text};  % {comment}"
        for name, value, comment in parameter_rows(document)
    ]
    names = [procedure.name for procedure, _ in document.written]
    names.insert(names.index("loops") + 1, "solve_loops")
    return [
        "% Parameters; the defaults are those the system was exported with.",
        "p = struct();",
        *rows,
        "model.parameters = p;",
        f"model.x_start = {_column(document.start.state)};",
        f"model.z_start = {_column(document.start.unknowns)};",
        *(f"model.{name} = @{name};" for name in names),
    ]


def _function(document: ExportedSystem, procedure: Procedure, body: PrintedFunction) -> list[str]:
    language = document.language
    results = ", ".join(target.name for target in procedure.targets)
    arguments = ", ".join(argument.name for argument in procedure.arguments)
    left = results if len(procedure.targets) == 1 else f"[{results}]"
    lines = [f"% {procedure.summary}", *statement_lines(body, language, "{} = {};"), ""]
    for target in procedure.targets:
        shape = ", ".join(map(str, (*target.shape, 1)[:2]))
        lines.append(f"{target.name} = zeros({shape});")
    lines += result_lines(procedure, body, language, ";")
    return [f"function {left} = {procedure.name}({arguments})", *indented(lines, 2), "end"]


def _column(values: tuple[float, ...]) -> str:
    return f"[{'; '.join(repr(float(value)) for value in values)}]" if values else "zeros(0, 1)"
