"""Functions that take steps into the complex plane, so that these differentiate what they give.

Of real numbers they are those of ``math`` and NumPy.
"""

from __future__ import annotations

import cmath
import math
from typing import Any, TypeVar

import numpy as np

from vehicledyn.base.parameters import ParameterSet

Parts = TypeVar("Parts", bound=ParameterSet)


def square_root(x: Any) -> Any:
    """Return √x."""
    return cmath.sqrt(x) if isinstance(x, complex) else math.sqrt(x)


def arc_cosine(x: Any) -> Any:
    """Return the angle of a cosine within -1 to 1 [rad]."""
    return cmath.acos(x) if isinstance(x, complex) else math.acos(x)


def arc_sine(x: Any) -> Any:
    """Return the angle of a sine within -1 to 1 [rad]."""
    return cmath.asin(x) if isinstance(x, complex) else math.asin(x)


def cosine(x: Any) -> Any:
    """Return cos x."""
    return cmath.cos(x) if isinstance(x, complex) else math.cos(x)


def sine(x: Any) -> Any:
    """Return sin x."""
    return cmath.sin(x) if isinstance(x, complex) else math.sin(x)


def length(x: Any, y: Any) -> Any:
    """Return √(x² + y²), element by element."""
    if np.iscomplexobj(x) or np.iscomplexobj(y):
        return np.sqrt(x * x + y * y)
    return np.hypot(x, y)


def direction(y: Any, x: Any) -> Any:
    """Return the angle of (x, y) within -π to π, element by element [rad]."""
    angle = np.arctan2(np.real(y), np.real(x))
    if np.iscomplexobj(x) or np.iscomplexobj(y):
        turned = np.real(x) * np.imag(y) - np.real(y) * np.imag(x)
        return angle + 1j * turned / (np.real(x) ** 2 + np.real(y) ** 2)
    return angle


def is_stepped(part: ParameterSet) -> bool:
    """Return whether a number of a part is a step in the complex plane."""
    return any(np.iscomplexobj(getattr(part, name)) for name in type(part).model_fields)


def real_part(part: Parts) -> Parts:
    """Return a part with real numbers in place of complex ones."""
    stepped: dict[str, Any] = {}
    for name in type(part).model_fields:
        value = getattr(part, name)
        if np.iscomplexobj(value):
            numbers = np.asarray(np.real(value))
            stepped[name] = tuple(numbers.tolist()) if numbers.ndim else float(numbers)
    return part.model_copy(update=stepped)
