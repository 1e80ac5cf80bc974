"""Elementary operations on scalars that may be numbers or CasADi expressions.

CasADi is loaded at the first operation, not at import, so that reading and validating
files stays quick.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any, TypeAlias

from vehicledyn.base.numbers import quarter_turns
from vehicledyn.symbolic.frames import common_axes
from vehicledyn.symbolic.number_operations import OF_NUMBER, OF_NUMBERS

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Scalar: TypeAlias = Any
"""A float or a 1-by-1 ``casadi.SX`` expression."""

Vec: TypeAlias = Any
"""A 3-by-1 ``casadi.SX`` (or ``casadi.DM``) column."""

Mat: TypeAlias = Any
"""A 3-by-3 ``casadi.SX`` (or ``casadi.DM``) matrix."""


def sin(x: Scalar) -> Scalar:
    """Return the sine of an angle [rad]; of a number exact at whole quarter turns."""
    return _turned("sin", quarter_turns.sine, x)


def cos(x: Scalar) -> Scalar:
    """Return the cosine of an angle [rad]; of a number exact at whole quarter turns."""
    return _turned("cos", quarter_turns.cosine, x)


def _turned(name: str, of_number: Callable[[float], float], x: Scalar) -> Scalar:
    """Return a function of an angle: of a number or a constant expression by ``of_number``."""
    if isinstance(x, int | float):
        return of_number(float(x))
    import casadi

    if type(x) is casadi.SX and x.is_scalar() and x.is_constant():
        return casadi.SX(of_number(float(x)))
    return _unary(name, x)


def _unary(name: str, x: Scalar) -> Scalar:
    """Return an operation of CasADi; of expressions without its search for a fitting overload."""
    if type(x) is float and name in OF_NUMBER:
        with suppress(ValueError, OverflowError):  # not a number or infinite: CasADi knows which
            return OF_NUMBER[name](x)
    import casadi

    if type(x) is casadi.SX:
        return casadi.SX.unary(getattr(casadi, f"OP_{name.upper()}"), x)
    return getattr(casadi, name)(x)


def _binary(name: str, x: Scalar, y: Scalar) -> Scalar:
    """Return an operation of CasADi on two operands, as :func:`_unary` does on one."""
    if type(x) is float and type(y) is float and name in OF_NUMBERS:
        return OF_NUMBERS[name](x, y)
    import casadi

    if casadi.SX in (type(x), type(y)) and {type(x), type(y)} <= {casadi.SX, float, int}:
        return casadi.SX.binary(getattr(casadi, f"OP_{name.upper()}"), x, y)
    return getattr(casadi, name)(x, y)


def tan(x: Scalar) -> Scalar:
    """Return the tangent of an angle [rad]."""
    return _unary("tan", x)


def atan(x: Scalar) -> Scalar:
    """Return the inverse tangent [rad]."""
    return _unary("atan", x)


def atan2(y: Scalar, x: Scalar) -> Scalar:
    """Return the angle of the point (x, y) [rad]."""
    import casadi

    return casadi.atan2(y, x)


def asin(x: Scalar) -> Scalar:
    """Return the inverse sine [rad]."""
    return _unary("asin", x)


def exp(x: Scalar) -> Scalar:
    """Return e to the power of x."""
    return _unary("exp", x)


def log(x: Scalar) -> Scalar:
    """Return the natural logarithm; x must be positive."""
    return _unary("log", x)


def tanh(x: Scalar) -> Scalar:
    """Return the hyperbolic tangent."""
    return _unary("tanh", x)


def sqrt(x: Scalar) -> Scalar:
    """Return the square root; keep x away from zero where it is differentiated."""
    return _unary("sqrt", x)


def absolute(x: Scalar) -> Scalar:
    """Return the magnitude of x."""
    return _unary("fabs", x)


def floor(x: Scalar) -> Scalar:
    """Return the greatest whole number not above x; its derivative is zero."""
    return _unary("floor", x)


def sign(x: Scalar) -> Scalar:
    """Return -1, 0 or 1."""
    return _unary("sign", x)


def minimum(x: Scalar, y: Scalar) -> Scalar:
    """Return the smaller of two scalars."""
    return _binary("fmin", x, y)


def maximum(x: Scalar, y: Scalar) -> Scalar:
    """Return the larger of two scalars."""
    return _binary("fmax", x, y)


def where(condition: Scalar, yes: Scalar, no: Scalar) -> Scalar:
    """Return ``yes`` where the condition holds, else ``no``; both sides are evaluated."""
    if type(condition) in (bool, float) and type(yes) is float and type(no) is float:
        return (yes if condition else no) + 0.0  # as CasADi's sum of both sides, without sign
    import casadi

    if (
        type(condition) is casadi.SX
        and {type(yes), type(no)} <= {casadi.SX, float, int}
        and condition.is_scalar()
    ):
        first = _binary("if_else_zero", condition, yes)
        other = _binary("if_else_zero", _unary("not", condition), no)
        return _binary("add", first, other)
    chosen = casadi.if_else(condition, yes, no)
    return float(chosen) if isinstance(chosen, casadi.DM) else chosen


def logic_and(x: Scalar, y: Scalar) -> Scalar:
    """Return whether both conditions hold."""
    import casadi

    return casadi.logic_and(x, y)


def smooth_norm(x: Scalar, y: Scalar, floor: Scalar) -> Scalar:
    """Return sqrt(x² + y² + floor²), which never reaches zero; floor has the unit of x."""
    return sqrt(x * x + y * y + floor * floor)


def reciprocals(*values: Scalar) -> list[Scalar]:
    """Return 1 / value of each value, by one division in compiled code, which costs many products.

    The product of the values must neither overflow nor vanish: they are away from zero and of
    moderate size. One that is zero or no number spoils all results.
    """
    free = [k for k, value in enumerate(values) if not isinstance(value, (int, float))]
    found: list[Scalar] = [1.0 if k in free else 1.0 / value for k, value in enumerate(values)]
    if len(free) == 1:
        found[free[0]] = 1.0 / values[free[0]]
    if len(free) < 2:
        return found
    # CasADi would cancel b / (a b), but leaves 2 b / (2 a b); doubling does not round.
    given = [values[free[0]] + values[free[0]], *(values[k] for k in free[1:])]
    before, behind = given[:1], given[-1:]
    for value in given[1:]:
        before.append(before[-1] * value)
    for value in reversed(given[1:-1]):
        behind.insert(0, value * behind[0])
    found[free[0]] = (behind[0] + behind[0]) / before[-1]
    for k, index in enumerate(free[1:-1]):
        found[index] = before[k] * behind[k + 1] / before[-1]
    found[free[-1]] = before[-2] / before[-1]
    return found


def scalar(x: Scalar) -> Scalar:
    """Return a number or expression as an SX scalar."""
    import casadi

    return x if type(x) is casadi.SX else casadi.SX(x)


def vector(x: Scalar, y: Scalar, z: Scalar) -> Vec:
    """Return the column of three components."""
    return filled(3, 1, (x, y, z))


_SET_ONE_BY_ONE = 9
"""Entries up to which setting each takes less time than CasADi's search for a fitting overload."""


def filled(rows: int, columns: int, entries: Sequence[Scalar]) -> Any:
    """Return the dense SX matrix of entries, column after column."""
    import casadi

    if len(entries) > _SET_ONE_BY_ONE or not entries:
        column = casadi.vertcat(*[scalar(item) for item in entries]) if entries else casadi.SX(0, 1)
        return casadi.reshape(column, rows, columns)
    found = casadi.SX.zeros(rows, columns)
    for place, item in enumerate(entries):
        if type(item) is float or type(item) is int:
            if item != 0 or str(item) == "-0.0":
                found.set_nz(casadi.SX(item), False, place)
        else:
            found.set_nz(item, False, place)
    return found


def entries_of(matrix: Any) -> list[Scalar]:
    """Return the entries of a matrix, column after column."""
    import casadi

    if type(matrix) is casadi.SX and matrix.is_dense():
        found: list[Scalar] = matrix.nonzeros()
        return found
    return [matrix[k] for k in range(matrix.numel())]


def column(items: Sequence[Scalar]) -> Any:
    """Return the SX column of any number of scalars, shape (n, 1)."""
    import casadi

    return casadi.vertcat(*[scalar(item) for item in items]) if items else casadi.SX(0, 1)


def cross(a: Vec, b: Vec) -> Vec:
    """Return the cross product of two columns."""
    import casadi

    product, axes = casadi.cross(a, b), common_axes(a, b, "multiplied by a cross product")
    if axes is None:
        return product
    from vehicledyn.symbolic.labelled import LabelledVector

    return LabelledVector(product, axes)


def dot(a: Vec, b: Vec) -> Scalar:
    """Return the scalar product of two columns."""
    import casadi

    common_axes(a, b, "multiplied")
    return casadi.dot(a, b)


def plus_cross(a: Vec, b: Vec, c: Vec) -> Vec:
    """Return a + b × c of columns, each component summed from a on, as fused sums take it."""
    a, b, c = (entries_of(item) for item in (a, b, c))
    pairs = ((1, 2), (2, 0), (0, 1))
    return vector(*(a[k] + b[i] * c[j] - b[j] * c[i] for k, (i, j) in enumerate(pairs)))


def tilde(v: Vec) -> Mat:
    """Return the skew-symmetric matrix with tilde(v) w = v × w."""
    import casadi

    return casadi.skew(v)


def norm(v: Vec) -> Scalar:
    """Return the length of a column that is never zero."""
    return sqrt(dot(v, v))


def unit(v: Vec) -> Vec:
    """Return a column that is never zero, scaled to length one."""
    return v / norm(v)


def symbol(name: str) -> Scalar:
    """Return a new scalar symbol."""
    import casadi

    return casadi.SX.sym(name)


def derivative(expression: Any, variables: Any, direction: Any) -> Any:
    """Return the directional derivative (∂expression/∂variables) direction."""
    import casadi

    from vehicledyn.symbolic.table_calls import settled

    return settled(casadi.jtimes(expression, variables, direction))


def jacobian(expression: Any, variables: Any) -> Any:
    """Return ∂expression/∂variables, shape (n_expression, n_variables), sparse."""
    import casadi

    from vehicledyn.symbolic.table_calls import settled

    return settled(casadi.jacobian(expression, variables))


def is_structurally_zero(expression: Any) -> bool:
    """Return whether an expression is zero whatever the values of its symbols."""
    if isinstance(expression, int | float):
        return expression == 0.0
    return bool(expression.is_zero())


def symbols(name: str, count: int) -> Any:
    """Return a column of new symbols, shape (count, 1)."""
    import casadi

    return casadi.SX.sym(name, count)


def substitute(expression: Any, symbols: Any, values: Any) -> Any:
    """Return the expression with symbols (a column) replaced by values (a column)."""
    import casadi

    return casadi.substitute(expression, symbols, values)


def stacked(*parts: Any) -> Any:
    """Return columns or matrices of equal width, one above the other."""
    import casadi

    return casadi.vertcat(*parts)


def depends_on(expression: Any, symbols: Any) -> bool:
    """Return whether any of the symbols (a column) occurs in an expression."""
    import casadi

    return bool(casadi.depends_on(expression, symbols))


def free_symbols(expression: Any, known: Any) -> list[str]:
    """Return the names of the symbols of an expression that are not in the known column."""
    import casadi

    held = {known[k].element_hash() for k in range(known.shape[0])}
    return [s.name() for s in casadi.symvar(expression) if s.element_hash() not in held]


def flat(matrix: Any) -> Any:
    """Return the entries of a matrix as a column, column after column."""
    import casadi

    return casadi.vec(matrix)


def unflat(entries: Any, rows: int) -> Any:
    """Return the matrix with that many rows whose columns follow one another in a column."""
    import casadi

    return casadi.reshape(entries, rows, -1)


def dense(matrix: Any) -> Any:
    """Return a matrix whose structural zeros are entries like others."""
    import casadi

    return casadi.densify(matrix)


def numeric(inputs: list[Any], output: Any) -> Callable[..., NDArray[np.float64]]:
    """Return a function of plain arrays that evaluates an SX matrix.

    ``inputs`` are columns of symbols, none at all for an expression of numbers; the result is
    a float array of the shape of ``output``. Where arrays hold several columns for the one of an
    input, the output of each stands beside that of the one before.
    """
    import casadi
    import numpy

    function = casadi.Function("f", inputs, [casadi.densify(output)])

    def evaluate(*values: Any) -> NDArray[np.float64]:
        return numpy.asarray(casadi.DM(function.call(list(values))[0]).full())

    return evaluate
