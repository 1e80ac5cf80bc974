"""The path through a slalom: a wave that passes each cone at its crest."""

from __future__ import annotations

import math
from dataclasses import dataclass

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class SlalomPath:
    """y(x) = ±offset at the cones, a cosine between them, raised cosines in and out.

    ``first`` is the x of the first cone, passed on the left (y > 0), ``spacing`` the distance
    between cones, ``count`` their number [m, m, 1]. The path is straight until one spacing
    before the first cone and from one spacing after the last. Its slope is continuous.
    """

    first: Scalar
    spacing: Scalar
    count: int
    offset: Scalar

    def lateral_position(self, x: Scalar) -> Scalar:
        """Return y of the path at x [m]."""
        phase = math.pi * (x - self.first) / self.spacing
        last = (self.count - 1) * math.pi
        wave = self.offset * ops.cos(phase)
        entering = 0.5 * self.offset * (1.0 + ops.cos(phase))
        sign = 1.0 if self.count % 2 == 1 else -1.0
        leaving = 0.5 * sign * self.offset * (1.0 + ops.cos(phase - last))
        inside = ops.where(phase < 0.0, entering, ops.where(phase > last, leaving, wave))
        outside = ops.where(phase < -math.pi, 1.0, ops.where(phase > last + math.pi, 1.0, 0.0))
        return inside * (1.0 - outside)
