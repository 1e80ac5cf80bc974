"""Operations on numbers alone, equal to CasADi's, which takes a while to load."""

from __future__ import annotations

import math
from collections.abc import Callable


def _smaller(x: float, y: float) -> float:
    return y if y < x or math.isnan(x) else x


def _larger(x: float, y: float) -> float:
    return y if y > x or math.isnan(x) else x


def _sign(x: float) -> float:
    return x if x == 0.0 or math.isnan(x) else math.copysign(1.0, x)


OF_NUMBER: dict[str, Callable[[float], float]] = {
    "tan": math.tan,
    "atan": math.atan,
    "asin": math.asin,
    "exp": math.exp,
    "log": math.log,
    "tanh": math.tanh,
    "sqrt": math.sqrt,
    "fabs": math.fabs,
    "sign": _sign,
}
OF_NUMBERS = {"fmin": _smaller, "fmax": _larger}
