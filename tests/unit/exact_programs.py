"""Programs of instructions evaluated exactly, where the order of a sum does not matter."""

from fractions import Fraction

from vehicledyn.codegen.ir.instructions import CONST, INPUT

RULES = {
    "ADD": lambda a, b: a + b,
    "SUB": lambda a, b: a - b,
    "MUL": lambda a, b: a * b,
    "SQ": lambda a: a * a,
    "NEG": lambda a: -a,
    "TWICE": lambda a: 2 * a,
    "FMA": lambda a, b, c: a * b + c,
    "FMS": lambda a, b, c: a * b - c,
    "FNMA": lambda a, b, c: -a * b + c,
    "FNMS": lambda a, b, c: -a * b - c,
}


def evaluated(values, results, given):
    """Return the results as fractions; ``given`` are the inputs."""
    found = []
    for item in values:
        if item.operation == INPUT:
            found.append(given[item.source[1]])
        elif item.operation == CONST:
            found.append(Fraction(item.number))
        else:
            found.append(RULES[item.operation](*(found[k] for k in item.operands)))
    return [found[value] for _, _, value in results]
