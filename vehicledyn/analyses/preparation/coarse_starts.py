"""Refuse starts at numbers so large that neighbouring floating-point numbers lie too far apart."""

from __future__ import annotations

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.base.numbers.start_sizes import COARSEST_START, LARGEST_START
from vehicledyn.kernel.engine import Vector
from vehicledyn.symbolic.equations import Equations


def refuse_coarse_start(equations: Equations, state: Vector) -> None:
    """Raise InputError for coordinates and rates at which numbers lie too far apart.

    Parameters
    ----------
    equations
        The equations.
    state
        The states that a run starts from.
    """
    moving = [*equations.positions, *equations.velocities]
    wrong = [k for k in moving if not np.spacing(abs(state[k])) <= COARSEST_START]
    if not wrong:
        return
    names = [equations.states[k].name for k in wrong]
    value, unit = float(state[wrong[0]]), equations.states[wrong[0]].unit
    raise InputError(
        f"{', '.join(repr(name) for name in names)}: {value:g} {unit} is too large to start from: "
        f"neighbouring numbers of that size are {np.spacing(abs(value)):.2g} {unit} apart; stay "
        f"below {LARGEST_START:.2g} {unit}",
        about=names,
    )
