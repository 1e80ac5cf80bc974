"""Initial assembly: coordinates near the given ones that close every loop."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.base.numbers.levenberg import least_squares

Array = NDArray[np.float64]
_CLOSED = 1e-12
_ASIDE = 1e-3
"""Step away from a start where the residuals are not finite [m, rad]."""


class NotAssembledError(NumericalError):
    """The loops stay open: ``point`` is the best fit, ``gap`` the residuals that remain there."""

    def __init__(self, text: str, point: Array, gap: Array) -> None:
        super().__init__(text)
        self.point, self.gap = point, gap


def assemble(
    residual: Callable[[Array], Array],
    jacobian: Callable[[Array], Array],
    start: Array,
    names: Sequence[str],
) -> Array:
    """Return the coordinates near ``start`` that make the residuals zero.

    Steps are the shortest where the loops leave freedom, see
    :func:`vehicledyn.base.numbers.levenberg.least_squares`.

    Parameters
    ----------
    residual, jacobian
        Functions of the free coordinates, shapes (n_residuals,) and (n_residuals, n_free).
    start
        Coordinates to begin from, shape (n_free,) [m, rad].
    names
        Name of the cut each residual belongs to.

    Raises
    ------
    NotAssembledError
        If the loops cannot be closed; the message names the cut and the gap that remains.
    NumericalError
        If the residuals at the start, or their slopes where they vanish, are no finite numbers.
    """
    q, h = least_squares(
        residual,
        jacobian,
        _away_from_poles(residual, jacobian, start),
        is_solved=lambda h: float(np.abs(h).max()) < _CLOSED,
    )
    found = _accept_or_raise(q, h, names)
    _refuse_pole(jacobian(found), names)
    return found


def _away_from_poles(
    residual: Callable[[Array], Array], jacobian: Callable[[Array], Array], start: Array
) -> Array:
    """Return the start, or a point beside it where a residual there is not finite.

    Such is the pseudo-rotation of a frame that is exactly half a turn away.
    """
    aside = np.cos(np.arange(start.size) + 1.0)
    for step in (0.0, _ASIDE, -_ASIDE):
        q = start + step * aside
        if np.isfinite(residual(q)).all() and np.isfinite(jacobian(q)).all():
            return np.asarray(q)
    raise NumericalError(
        "the loops cannot be assembled: their residuals are no finite numbers at the start; "
        "start the coordinates elsewhere"
    )


def _refuse_pole(slopes: Array, names: Sequence[str]) -> None:
    """Refuse a point where a residual vanishes because its slope is infinite.

    Such is a cam's follower on the axis of the cam.
    """
    bad: NDArray[np.bool_] = np.logical_not(np.isfinite(slopes).all(axis=1))
    if bad.any():
        listed = ", ".join(dict.fromkeys(f"'{n}'" for n, b in zip(names, bad, strict=True) if b))
        raise NumericalError(
            f"the loops cannot be assembled: from this start they lead to a place where {listed} "
            "has no direction; start the coordinates elsewhere, see 'initial'"
        )


def _accept_or_raise(q: Array, h: Array, names: Sequence[str]) -> Array:
    gap = np.abs(h)
    if float(gap.max(initial=0.0)) < 1e3 * _CLOSED:
        return q
    open_cuts: dict[str, float] = {}
    for name, size in zip(names, gap, strict=True):
        open_cuts[name] = max(open_cuts.get(name, 0.0), float(size))
    worst = sorted(open_cuts.items(), key=lambda item: -item[1])[:4]
    listed = ", ".join(f"'{name}' by {size:.3g} m" for name, size in worst)
    raise NotAssembledError(
        f"the loops cannot be assembled: {listed} stay open after the best fit; "
        "check the hardpoints and lengths of these parts",
        q,
        h,
    )
