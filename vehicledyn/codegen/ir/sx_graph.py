"""Take SX functions apart into nodes, and build expressions again from these."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from vehicledyn.symbolic.table_calls import call_with, calls_at

Node = tuple[int, tuple[int, ...], float]
"""Operation, operands and constant: of a call its instruction, of a result which one it is."""

RESULT = -1
"""Operation that takes a result of a call."""


class Rebuild:
    """Builds expressions again from the nodes of a function."""

    def __init__(self, function: Any, inputs: list[Any], nodes: list[Node]) -> None:
        """Take the function apart; ``nodes`` are its nodes."""
        import casadi

        self._function = function
        self.calls = calls_of(function, nodes)
        self._elements = [casadi.vertsplit(item) if item.numel() else [] for item in inputs]
        self._codes = casadi.OP_INPUT, casadi.OP_CONST, casadi.OP_CALL
        self._makers = casadi.SX, casadi.SX.unary, casadi.SX.binary

    def value(self, node: Node, values: list[Any] | dict[int, Any]) -> Any:
        """Return what a node stands for, from the values of the nodes before it."""
        code, operands, detail = node
        given, constant, call = self._codes
        number, unary, binary = self._makers
        if code == given:
            return self._elements[operands[0]][operands[1]]
        if code == constant:
            return number(detail)
        if code == call:
            return call_with(self.calls[int(detail)], [values[item] for item in operands])
        if code == RESULT:
            return values[operands[0]][int(detail)]
        if len(operands) == 2:
            return binary(code, values[operands[0]], values[operands[1]])
        return unary(code, values[operands[0]])

    def results(self, results: list[list[tuple[int, int]]], values: list[Any]) -> list[Any]:
        """Return the function's results from (element, value) pairs."""
        import casadi

        outputs = []
        for k in range(self._function.n_out()):
            column = [values[value] for _, value in sorted(results[k])]
            outputs.append(casadi.reshape(casadi.vertcat(*column), self._function.size_out(k)))
        return outputs


def calls_of(function: Any, nodes: list[Node]) -> dict[int, Any]:
    """Return what a function calls, by the number of the instruction, given its nodes."""
    import casadi

    call = casadi.OP_CALL
    return calls_at(function, [int(detail) for code, _, detail in nodes if code == call])


def read_nodes(function: Any) -> tuple[list[Node], list[list[tuple[int, int]]]]:
    """Return operation, operands and constant of each value, and (element, value) pairs."""
    import casadi

    output, source, constant, called = (
        casadi.OP_OUTPUT,
        casadi.OP_INPUT,
        casadi.OP_CONST,
        casadi.OP_CALL,
    )
    code_of, inputs_of = function.instruction_id, function.instruction_input
    outputs_of = function.instruction_output
    nodes: list[Node] = []
    results: list[list[tuple[int, int]]] = [[] for _ in range(function.n_out())]
    slot: dict[int, int] = {}
    for k in range(function.n_instructions()):
        code, given, target = code_of(k), inputs_of(k), outputs_of(k)
        if code == output:
            results[target[0]].append((target[1], slot[given[0]]))
            continue
        if code == source:
            nodes.append((code, (given[0], given[1]), 0.0))
        elif code == constant:
            nodes.append((code, (), function.instruction_constant(k)))
        elif code == called:
            call = len(nodes)
            nodes.append((code, tuple(slot[item] for item in given), float(k)))
            for number, place in enumerate(target):
                if place >= 0:
                    slot[place] = len(nodes)
                    nodes.append((RESULT, (call,), float(number)))
            continue
        else:
            nodes.append((code, tuple(slot[item] for item in given), 0.0))
        slot[target[0]] = len(nodes) - 1
    return nodes, results


def fixed_from(nodes: list[Node], is_fixed: Callable[[tuple[int, ...]], bool]) -> list[bool]:
    """Return for each value whether it depends on nothing but numbers and fixed inputs.

    ``is_fixed`` is asked for input and element of each input.
    """
    import casadi

    source = casadi.OP_INPUT
    fixed: list[bool] = []
    for code, operands, _ in nodes:
        if code == source:
            fixed.append(is_fixed(operands))
        else:
            fixed.append(all(fixed[item] for item in operands))
    return fixed
