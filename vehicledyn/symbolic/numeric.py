"""Numbers out of expressions: a numeric function of the symbols an expression contains."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def evaluator(inputs: Sequence[Any], outputs: Sequence[Any]) -> Callable[..., list[Array]]:
    """Return a function from the values of the inputs to the values of the outputs.

    Parameters
    ----------
    inputs
        Symbols or columns of symbols; nothing else may appear in the outputs.
    outputs
        Expressions of any shape.

    Returns
    -------
    Callable
        Takes one number or array per input; returns one array per output with the shape of
        its expression, columns as shape (n,).
    """
    import casadi

    outs = [casadi.SX(expression) for expression in outputs]
    function = casadi.Function("evaluate", [casadi.SX(symbol) for symbol in inputs], outs)

    def evaluate(*values: Any) -> list[Array]:
        results = function.call([casadi.DM(value) for value in values])
        arrays = [np.array(result, dtype=float) for result in results]
        return [array[:, 0] if array.shape[1] == 1 else array for array in arrays]

    return evaluate
