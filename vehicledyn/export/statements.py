"""Turn a procedure into statements in single-assignment form, grouped into sections.

Values that carry a name, are used more than once or would make a line too long get a
statement of their own; all others are written inside the expression that uses them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

from vehicledyn.codegen.ir.instructions import CONST, INPUT, Instruction, Program, read_expressions
from vehicledyn.codegen.passes.lowering import LOOKED_UP
from vehicledyn.codegen.printers.languages import Language, Term
from vehicledyn.export.identifiers import safe_name
from vehicledyn.export.procedures import Argument, Procedure
from vehicledyn.export.tables import NamedTable
from vehicledyn.multibody.equations.equation_terms import Label
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.tables import CurveTable

LONGEST = 42
"""Characters an expression may have that is written inside another one."""

_FREE = (INPUT, CONST, "ASSIGN")


@dataclass(frozen=True)
class Statement:
    """``name`` = ``text``; one without a name opens a section, which ``text`` calls."""

    name: str
    text: str


@dataclass(frozen=True)
class PrintedFunction:
    """What a printed function does: statements, then the elements of its results.

    ``results`` are (target, index, text); ``arguments`` the names that are used at all,
    ``operations`` the number of operations, and ``features`` what the language must provide.
    """

    statements: list[Statement]
    results: list[tuple[str, tuple[int, ...], str]]
    arguments: set[str]
    operations: int
    features: set[str]


def write_body(
    procedure: Procedure,
    language: Language,
    parameters: Sequence[str],
    tables: Sequence[NamedTable] = (),
) -> PrintedFunction:
    """Return the statements of a procedure; ``parameters`` are identifiers."""
    curves = [named.table for named in tables]
    inputs = [argument.symbols for argument in procedure.arguments]
    goals = [value for target in procedure.targets for value in target.entries.values()]
    labels = _alive(inputs, procedure.labels, goals, curves)
    expressions = [*(label.expression for label in labels), *goals]
    program = read_expressions(inputs, expressions, curves)
    names = [named.name for named in tables]
    return _Writer(procedure, language, parameters, names, labels, program).write()


def _alive(
    inputs: list[Scalar],
    labels: tuple[Label, ...],
    goals: list[Scalar],
    tables: Sequence[CurveTable],
) -> list[Label]:
    """Return the labels of values that the goals need, the first of each name and value."""
    expressions = [*(label.expression for label in labels), *goals]
    program = read_expressions(inputs, expressions, tables)
    needed = _needed(program, len(labels))
    kept: list[Label] = []
    seen: set[int] = set()
    names: set[str] = set()
    for (_, _, value), label in zip(program.results, labels, strict=False):
        computed = program.instructions[value].operation not in _FREE
        if computed and value in needed and value not in seen and label.name not in names:
            kept.append(label)
            seen.add(value)
            names.add(label.name)
    return kept


def _needed(program: Program, n_labels: int) -> set[int]:
    """Return the values that the results after the labels are made from."""
    waiting = [value for _, _, value in program.results[n_labels:]]
    needed: set[int] = set()
    while waiting:
        value = waiting.pop()
        if value not in needed:
            needed.add(value)
            waiting.extend(program.instructions[value].operands)
    return needed


@dataclass
class _Writer:
    """Writes the instructions of one procedure one after the other."""

    procedure: Procedure
    language: Language
    parameters: Sequence[str]
    tables: Sequence[str]
    labels: list[Label]
    program: Program
    terms: dict[int, Term] = field(default_factory=dict)
    statements: list[Statement] = field(default_factory=list)
    used: set[str] = field(default_factory=set)
    features: set[str] = field(default_factory=set)
    names: set[str] = field(default_factory=set)
    count: int = 0
    section: str = ""

    def write(self) -> PrintedFunction:
        program, n = self.program, len(self.labels)
        needed = _needed(program, n)
        uses = self._uses(needed)
        names = {program.results[k][2]: label.name for k, label in enumerate(self.labels)}
        ends = program.done[:n]
        open_label = 0
        operations = 0
        for value, item in enumerate(program.instructions):
            while open_label < n and ends[open_label] <= value:
                open_label += 1
            if value not in needed:
                continue
            operations += item.operation not in _FREE
            section = self.labels[open_label].section if open_label < n else "Result"
            self._place(value, item, names.get(value), uses[value], section)
        return PrintedFunction(
            self.statements, self._results(n), self.used, operations, self.features
        )

    def _uses(self, needed: set[int]) -> Counter[int]:
        uses: Counter[int] = Counter()
        for value in needed:
            item = self.program.instructions[value]
            # A square is printed as a product, so what it is made from must have a name.
            uses.update(item.operands * 2 if item.operation == "SQ" else item.operands)
        uses.update(value for _, _, value in self.program.results[len(self.labels) :])
        return uses

    def _place(
        self, value: int, item: Instruction, name: str | None, uses: int, section: str
    ) -> None:
        term = self._term(item)
        atomic = item.operation in (INPUT, CONST)
        if not atomic and (name or uses > 1 or len(term.text) > LONGEST):
            if section != self.section and section:
                self.section = section
                self.statements.append(Statement("", section))
            name = self._new_name(name)
            self.statements.append(Statement(name, term.text))
            term = self.language.variable(name, is_condition=term.is_condition)
        self.terms[value] = term

    def _new_name(self, label: str | None) -> str:
        if label is None:
            self.count += 1
        name = safe_name(label or f"w{self.count}")
        while name in self.names:
            name = f"{name}_"
        self.names.add(name)
        return name

    def _term(self, item: Instruction) -> Term:
        if item.operation == CONST:
            return self.language.number(item.number)
        if item.operation == INPUT:
            argument = self.procedure.arguments[item.source[0]]
            self.used.add(argument.name)
            return self._element(argument, item.source[1])
        self.features.add(item.operation)
        if item.operation in LOOKED_UP:
            table, power = item.source
            return self.language.look_up(
                item.operation, self.tables[table], self.terms[item.operands[0]], power
            )
        return self.language.apply(item.operation, [self.terms[k] for k in item.operands])

    def _element(self, argument: Argument, index: int) -> Term:
        """Return an element of an argument."""
        if argument.is_scalar:
            return Term(argument.name)
        if argument.name == "p":
            return Term(f"{argument.name}{self.language.member}{self.parameters[index]}")
        return Term(self.language.at(argument.name, (index,)))

    def _results(self, n: int) -> list[tuple[str, tuple[int, ...], str]]:
        places = [
            (target.name, place) for target in self.procedure.targets for place in target.entries
        ]
        return [
            (name, place, self.terms[value].text)
            for (name, place), (_, _, value) in zip(places, self.program.results[n:], strict=True)
        ]
