"""Axes that vectors and rotations are expressed in, checked while equations are written.

What kinematics hand to parts is labelled with its axes. Sums, cross and scalar products of vectors
in different axes are refused, and so are rotations that turn from other axes than a vector has.
Labels cost nothing when a model runs: they are gone from the equations. What has no label, as a
vector that a part makes of numbers, goes with any axes and takes those of its partner. Labels are
given by :mod:`vehicledyn.symbolic.labels`.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from vehicledyn.base.errors import InputError

WORLD = "the world"


class FrameError(InputError):
    """Vectors of different axes were joined."""


@contextmanager
def naming(kind: str, name: str) -> Iterator[None]:
    """Name the part or constraint in errors about axes that arise in it.

    Raises
    ------
    InputError
        If it joins vectors of different axes.
    """
    try:
        yield
    except FrameError as error:
        raise InputError(f"{kind} '{name}': {error}", about=[name]) from None


def axes_of(body: str) -> str:
    """Return the label of the axes of a body."""
    return f"body '{body}'"


def axes_label(vector: Any) -> str | None:
    """Return the axes that a vector is labelled with, None without a label."""
    label: str | None = getattr(vector, "axes", None)
    return label


def common_axes(one: Any, other: Any, verb: str) -> str | None:
    """Return the axes of two vectors that are joined, None if neither is labelled.

    Raises
    ------
    FrameError
        If both are labelled with different axes.
    """
    first, second = axes_label(one), axes_label(other)
    if first is not None and second is not None and first != second:
        raise FrameError(
            f"a vector in the axes of {first} and one in the axes of {second} are {verb}; turn one "
            "of them first: kinematics.rotation(body) turns from a body's axes to the world's, its "
            "transpose back"
        )
    return first if second is None else second


def require_axes(vector: Any, axes: str, what: str) -> None:
    """Refuse a vector labelled with other axes than it must have.

    Raises
    ------
    FrameError
        If it is.
    """
    found = axes_label(vector)
    if found is not None and found != axes:
        raise FrameError(
            f"{what} is given in the axes of {found}, but belongs into those of {axes}; turn it "
            "there first, with kinematics.rotation(body) or its transpose"
        )
