"""Wear of wheels: the wear number Tγ over the distance run.

Tγ = |T_x ξ| + |T_y η| + |M φ| is the energy that creep takes per metre of track, in N = J/m.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.results.assessment.signal import Floats, Signal, signal_of
from vehicledyn.results.assessment.sliding import integrals

PARTS = 10
"""Equal parts of the distance for which a mean is reported."""


@dataclass(frozen=True)
class WheelWear:
    """Wear number of one wheel: mean over the distance, largest, means of equal parts [N]."""

    name: str
    mean: float
    largest: float
    parts: Floats
    work: float


def assess_wear(name: str, distance: Signal, wear_number: Signal) -> WheelWear:
    """Return the wear of a wheel; ``work`` is the integral of Tγ over the distance [J].

    Parameters
    ----------
    name
        Wheel, such as "front.left".
    distance
        Way along the track, not falling, shape (n,) [m].
    wear_number
        Tγ there, shape (n,) [N].
    """
    begin, end = distance.at(0), distance.at(-1)
    edges = signal_of(np.linspace(begin, end, PARTS + 1))
    work = np.concatenate(list(integrals(distance, wear_number, edges)))
    way = end - begin
    return WheelWear(
        name=name,
        mean=float(work[-1]) / way,
        largest=wear_number.highest()[1],
        parts=np.diff(work) * PARTS / way,
        work=float(work[-1]),
    )
