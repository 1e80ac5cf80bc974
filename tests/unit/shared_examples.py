"""Equations made of shared functions, for the tests of the code generator and of the methods."""

import numpy as np
from solve_examples import build, symbols

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import with_tables
from vehicledyn.symbolic.shared import shared
from vehicledyn.symbolic.tables import CurveTable

TABLE = CurveTable.through("curve", -4.0, 0.5, np.cos(2.0 * np.arange(17)))


def pull(values):
    """A force of place, rate and stiffness; inside it calls another shared function."""
    place, rate, stiffness = values
    (inner,) = shared("inner", [place * rate], lambda v: [ops.atan(v[0]) + TABLE.value(v[0])])
    lost = ops.exp(-place * place) * 1e3
    return [-stiffness * (place + 0.1 * inner) - 0.3 * ops.tanh(rate), lost, inner]


def masses(share, law=pull):
    """Six masses in a row, each pulled by the same law."""
    t, k = symbols("t", "stiffness")
    places, rates = (symbols(*[f"{n}{i}" for i in range(6)]) for n in "xv")
    call = (lambda values: shared("pull", values, law)) if share else law
    found = [call([x, v, k + 0.01 * i]) for i, (x, v) in enumerate(zip(places, rates, strict=True))]
    rows = [(x, 0.1 * i - 0.3) for i, x in enumerate(places)] + [(v, 0.4) for v in rates]
    accelerations = [item[0] + 0.05 * (places[i - 1] - places[i]) for i, item in enumerate(found)]
    return with_tables(
        build(
            "masses",
            time=t,
            states=rows,
            rates=[*rates, *accelerations],
            parameters=[(k, 4.0)],
            outputs=[(f"inner{i}", item[2]) for i, item in enumerate(found)],
            positions=tuple(range(6)),
            velocities=tuple(range(6, 12)),
        )
    )
