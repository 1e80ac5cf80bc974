"""The cubic by which Vermeulen and Johnson bend a linear force towards friction."""

from __future__ import annotations

from vehicledyn.rail.creep.creep_law import RELATIVE_FLOOR, floored_limit
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


def cubic_part(longitudinal: Scalar, lateral: Scalar, limit: Scalar) -> Scalar:
    """Return the part of a linear force that is left, 1 at zero and limit/force beyond ρ = 3.

    (1 - (1 - ρ/3)³)/ρ = 1 - ρ/3 + ρ²/27,    ρ = |F_linear| / (μ N)

    Parameters
    ----------
    longitudinal, lateral
        Components of the linear force [N].
    limit
        Friction force μ N; without it nothing is left [N].
    """
    floor = floored_limit(limit)
    relative = ops.smooth_norm(longitudinal / floor, lateral / floor, RELATIVE_FLOOR)
    bent = ops.minimum(relative, 3.0)
    return (bent - bent * bent / 3.0 + bent * bent * bent / 27.0) / relative * (limit / floor)
