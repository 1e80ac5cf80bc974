"""Parts of a motion that is followed with its tangents, and where they begin and end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.motion_slopes import CornerPassed, EventSlope
from vehicledyn.kernel.engine import Sides, Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.tangent_code import TangentCode

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class PartitionPiece:
    """Equations that hold from a time on [s], with other dependent coordinates than before.

    ``code`` observes the same channels, in the same order, as that of the piece before; behind
    these it may observe others, which the next change needs.
    """

    time: float
    kernel: Kernel
    code: TangentCode


@dataclass(frozen=True)
class Where:
    """Where a motion stands: the next step, and what the following ones go on from."""

    step: int
    state: Vector
    unknowns: Vector
    memory: Vector
    sides: Sides
    crossed: Vector
    tangents: Matrix
    corners: Vector
    ended_by: str


@dataclass(frozen=True)
class Stretch:
    """Samples of a part of a motion, what is looked at, events, corners, and where it ends.

    ``n_later`` is the number of changes of the dependent coordinates that are still to come,
    ``left_whole`` says whether steps with corners were not divided.
    """

    times: Vector
    values: Matrix
    slopes: Matrix
    looks: tuple[tuple[Vector, Matrix, Matrix], ...]
    events: tuple[EventSlope, ...]
    corners: tuple[CornerPassed, ...]
    end: Where
    n_later: int
    left_whole: bool


KINDS = (Where, Stretch, EventSlope, CornerPassed)
"""Results of a memory of stretches."""
