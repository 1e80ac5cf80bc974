"""Write a system as a Python module that needs nothing but numpy."""

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
from vehicledyn.export.tables import python_table

_SOLVE = '''\
def solve_loops(t, x, z, p):
    """Return the unknowns near a guess z that solve the loops, by Newton's method."""
    z = np.array(z, dtype=float)
    for _ in range(50):
        g, G = loops(t, x, z, p)
        step = np.linalg.solve(G, g)
        z -= step
        if np.all(np.abs(step) <= 1e-10 * (1.0 + np.abs(z))):
            return z
    raise ArithmeticError("the loops do not close near these unknowns")
'''


def python_module(document: ExportedSystem) -> str:
    """Return the text of the module."""
    comment = document.language.comment
    features = document.features
    lines = [
        *(f"{comment} {line}".rstrip() for line in head(document)),
        "",
        *(["import math"] if features & {"ERF", "REMAINDER"} else []),
        "from dataclasses import dataclass",
        "",
        "import numpy as np",
        "",
        *_parameters(document),
        "",
        f"x_start = np.array({_numbers(document.start.state)})",
        f"z_start = np.array({_numbers(document.start.unknowns)})",
    ]
    for named in document.tables:
        lines += ["", "", *python_table(named)]
    for procedure, body in document.written:
        lines += ["", "", *_function(document, procedure, body)]
        if procedure.name == "loops":
            lines += ["", "", *_SOLVE.splitlines()]
    return text_of(lines)


def _parameters(document: ExportedSystem) -> list[str]:
    rows = [
        f"{name}: float = {_number(value)}  # {comment}"
        for name, value, comment in parameter_rows(document)
    ]
    text = '"""Parameters of the system; the defaults are those it was exported with."""'
    return ["", "@dataclass", "class Parameters:", *indented([text, "", *rows], 4), ""]


def _function(document: ExportedSystem, procedure: Procedure, body: PrintedFunction) -> list[str]:
    arguments = ", ".join(argument.name for argument in procedure.arguments)
    language = document.language
    lines = [f'"""{procedure.summary}"""', *statement_lines(body, language, "{} = {}"), ""]
    for target in procedure.targets:
        shape = target.shape[0] if len(target.shape) == 1 else target.shape
        lines.append(f"{target.name} = np.zeros({shape})")
    lines += result_lines(procedure, body, language, "")
    lines.append(f"return {', '.join(target.name for target in procedure.targets)}")
    return [f"def {procedure.name}({arguments}):", *indented(lines, 4)]


def _numbers(values: tuple[float, ...]) -> str:
    return f"[{', '.join(_number(value) for value in values)}]"


def _number(value: float) -> str:
    return repr(float(value))
