"""How far a channel may be from its reference."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.argument_names import argument

Floats = NDArray[np.float64]

CONSTANT = 1e-12  # range below this share of the largest magnitude is rounding


@dataclass(frozen=True)
class Tolerances:
    """What may differ: |result - reference| <= absolute + relative * scale.

    The scale of a channel is the reference's range (largest less smallest value), or its
    largest magnitude where the reference is constant. ``by_channel`` gives other relative
    tolerances by pattern, such as ``wheel_*.tyre.*``; of several that match the last counts.
    """

    relative: float = 1e-6
    absolute: float = 0.0
    by_channel: Mapping[str, float] = field(default_factory=dict)

    def of(self, name: str, reference: Floats) -> float:
        """Return the tolerance of a channel in its own unit."""
        relative = self.relative
        for pattern, value in self.by_channel.items():
            relative = value if fnmatchcase(name, pattern) else relative
        return self.absolute + relative * _scale(reference)

    def problems(self) -> list[str]:
        """Return what is wrong with the numbers themselves."""
        named = {argument("relative"): self.relative, argument("absolute"): self.absolute}
        named |= {f"{argument('tolerances')} {key}": it for key, it in self.by_channel.items()}
        return [
            f"{name}: {value} is not a number of zero or more"
            for name, value in named.items()
            if not (math.isfinite(value) and value >= 0.0)
        ]


def _scale(reference: Floats) -> float:
    magnitude = float(np.max(np.abs(reference)))
    span = float(np.ptp(reference))
    return span if span > CONSTANT * magnitude else magnitude
