"""The steps that an expression is made of, and their text."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.files.expressions.algebra import WrittenNumber


@dataclass(frozen=True)
class Node:
    """One step of an expression: a number, a name, or a function of other nodes."""

    quantity: WrittenNumber | None = None
    name: str = ""
    function: str = ""
    arguments: tuple[Node, ...] = ()

    def __str__(self) -> str:
        """Return the step as text that reads back to the same."""
        if self.quantity is not None:
            return str(self.quantity)
        if self.name:
            return self.name
        inner = [str(node) for node in self.arguments]
        if self.function == "vector":
            return f"[{', '.join(inner)}]"
        if self.function == "negative":
            return f"-{_grouped(self.arguments[0], _TIGHTNESS['negative'])}"
        tightness = _TIGHTNESS.get(self.function)
        if tightness is None:
            return f"{self.function}({', '.join(inner)})"
        to_right = self.function == "**"
        left = _grouped(self.arguments[0], tightness + to_right)
        right = _grouped(self.arguments[1], tightness + (not to_right))
        return f"{left} {self.function} {right}"


_TIGHTNESS = {
    **dict.fromkeys(("<", "<=", ">", ">="), 0),
    **dict.fromkeys(("+", "-"), 1),
    **dict.fromkeys(("*", "/"), 2),
    "negative": 3,
    "**": 4,
}


def _grouped(node: Node, tightness: int) -> str:
    """Return a step as text, in brackets if it binds less tightly than what surrounds it."""
    if node.quantity is not None:
        is_loose = node.quantity.value < 0.0 or " " in node.quantity.unit
    else:
        is_loose = _TIGHTNESS.get(node.function, tightness) < tightness
    return f"({node})" if is_loose else str(node)
