"""CasADi columns and matrices that carry the label of their axes, see ``frames``."""

from __future__ import annotations

from typing import Any

import casadi

from vehicledyn.symbolic.frames import FrameError, axes_label, common_axes


class LabelledVector(casadi.SX):
    """A column of three with the axes it is expressed in."""

    def __init__(self, value: Any, axes: str) -> None:
        """Label a column."""
        super().__init__(value)
        self.axes = axes

    def __add__(self, other: Any) -> Any:
        return _sum(self, other, casadi.plus(self, other))

    def __radd__(self, other: Any) -> Any:
        return _sum(other, self, casadi.plus(other, self))

    def __sub__(self, other: Any) -> Any:
        return _sum(self, other, casadi.minus(self, other), "subtracted from each other")

    def __rsub__(self, other: Any) -> Any:
        return _sum(other, self, casadi.minus(other, self), "subtracted from each other")

    def __neg__(self) -> Any:
        return LabelledVector(casadi.SX.__neg__(self), self.axes)

    def __mul__(self, other: Any) -> Any:
        return _scaled(self, other, casadi.times(self, other))

    def __rmul__(self, other: Any) -> Any:
        return _scaled(self, other, casadi.times(other, self))

    def __truediv__(self, other: Any) -> Any:
        return _scaled(self, other, casadi.rdivide(self, other))


class LabelledRotation(casadi.SX):
    """A rotation matrix with the axes it turns to and from."""

    def __init__(self, value: Any, to: str, of: str) -> None:
        """Label a matrix."""
        super().__init__(value)
        self.to, self.of = to, of

    @property
    def T(self) -> Any:  # noqa: N802
        """The rotation back."""
        return LabelledRotation(casadi.transpose(self), self.of, self.to)

    def __matmul__(self, other: Any) -> Any:
        found = casadi.mtimes(self, other)
        given = other.to if isinstance(other, LabelledRotation) else axes_label(other)
        if given is not None and given != self.of:
            raise FrameError(
                f"a rotation from the axes of {self.of} to those of {self.to} is applied to what "
                f"is given in the axes of {given}; take the rotation of that frame, or the "
                "transpose"
            )
        if isinstance(other, LabelledRotation):
            return LabelledRotation(found, self.to, other.of)
        return LabelledVector(found, self.to) if found.shape == (3, 1) else found

    def __getitem__(self, place: Any) -> Any:
        """Return entries; a column is an axis of the frame that is turned from."""
        found = casadi.SX.__getitem__(self, place)
        return LabelledVector(found, self.to) if found.shape == (3, 1) else found


def _sum(one: Any, other: Any, found: Any, verb: str = "added") -> Any:
    axes = common_axes(one, other, verb)
    return found if axes is None else LabelledVector(found, axes)


def _scaled(vector: LabelledVector, factor: Any, found: Any) -> Any:
    is_scalar = isinstance(factor, int | float) or getattr(factor, "shape", None) in ((), (1, 1))
    return LabelledVector(found, vector.axes) if is_scalar else found
