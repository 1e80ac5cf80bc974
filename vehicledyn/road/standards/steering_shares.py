"""Steering angle that reaches a lateral acceleration, from a slowly increasing steer.

49 CFR 571.126 (FMVSS 126) and UN R140: the steering-wheel angle A at 0.3 g comes from a line
through the points between 0.1 g and 0.375 g.
"""

from __future__ import annotations

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.road.standards.signals import Signals

STANDARD_GRAVITY = 9.80665
"""Acceleration of one g [m/s²]."""

_FITTED = (0.1, 0.375)
_WANTED = 0.3


def angle_at_third_g(signals: Signals) -> float:
    """Return the steering-wheel angle A at 0.3 g, positive [rad].

    Raises
    ------
    InputError
        If the run does not reach 0.375 g.
    """
    share = np.abs(signals.lateral_acceleration) / STANDARD_GRAVITY
    if float(share.max()) < _FITTED[1]:
        raise InputError(
            f"the slowly increasing steer reaches {share.max():.3g} g, less than the "
            f"{_FITTED[1]:g} g its line needs; steer further or drive faster"
        )
    end = int(np.argmax(share >= _FITTED[1]))
    first = int(np.argmax(share >= _FITTED[0]))
    line = np.polyfit(share[first : end + 1], np.abs(signals.steering[first : end + 1]), 1)
    return float(np.polyval(line, _WANTED))
