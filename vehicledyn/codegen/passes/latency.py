"""How long values take to compute: until the next can use them, and until all are there."""

from __future__ import annotations

from collections.abc import Iterable

from vehicledyn.codegen.ir.instructions import CONST, INPUT
from vehicledyn.codegen.passes.scheduling import CALLED

_NOTHING = frozenset({INPUT, CONST})
_SLOW = {"DIV": 6, "SQRT": 8}
_CALL = 16


def latency(operation: str) -> int:
    """Return how long a value takes once its operands are there, a sum or product being one."""
    if operation in _NOTHING:
        return 0
    return _CALL if operation in CALLED else _SLOW.get(operation, 1)


def depth(operation: str, operands: Iterable[int]) -> int:
    """Return when a value is there, given when its operands are."""
    return latency(operation) + max(operands, default=0)
