"""The range of a study above its highest value, where nothing oscillates by itself within it.

Where an oscillation begins to grow there, a branch of cycles begins that may lead down into the
range: a stable motion that hunts once it is pushed.
"""

from __future__ import annotations

import numpy as np

from vehicledyn.analyse.periodic.critical import ahead, find_hopf
from vehicledyn.analyse.periodic.outside_range import outer_range
from vehicledyn.analyses.hunting.equilibria import Equilibria
from vehicledyn.analyses.hunting.lower_range import FurtherRange
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.units import shown

_STEPS = 20
"""Equilibria on the way above the range at most."""


def upper_range(equilibria: Equilibria, span: tuple[float, float], unit: str) -> FurtherRange:
    """Return equilibria above a range up to the first one at which an oscillation grows.

    There are none where that lies farther off than cycles are followed outside a range.
    """
    last = equilibria.balances[-1]
    found = [last]
    try:
        for value in np.linspace(span[1], outer_range(*span)[1], _STEPS + 1)[1:]:
            found.append(equilibria.at(value, *ahead(equilibria.model, found[-1], float(value))))
            if found[-1].growing_pairs:
                break
    except NumericalError:
        pass
    hopfs = find_hopf(equilibria.model, found, equilibria.at)
    if not hopfs:
        return FurtherRange([], "")
    where = ", ".join(shown(hopf.balance.value, unit) for hopf in hopfs)
    end = shown(found[-1].value, unit)
    return FurtherRange(
        found[1:],
        f"no oscillation begins to grow in the range asked for; above it they do at {where}, "
        f"and the range is followed up to {end}, as their cycles may lead down into it",
    )
