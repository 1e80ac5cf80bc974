"""Equations that look up tables, for the tests of compiled tables."""

import numpy as np
from solve_examples import build, symbols

from vehicledyn.symbolic.equations import Block, with_tables
from vehicledyn.symbolic.tables import CurveTable


def height(seed=1, n=40, start=-3.0, step=0.25):
    values = np.random.default_rng(seed).normal(size=n, scale=0.1)
    return CurveTable.through("height", start, step, values)


def quintic(size=0.3, cells=40, start=-2.0, step=0.1):
    """The Taylor polynomials of size sin x, of order five."""
    knots = start + step * np.arange(cells)[:, None]
    power = np.arange(6)
    factorial = np.cumprod([1.0, 1.0, 2.0, 3.0, 4.0, 5.0])
    slopes = size * np.sin(knots + power * np.pi / 2.0)
    return CurveTable("quintic", start, step, slopes * step**power / factorial)


def rider(ground, other):
    """A mass on a curve, with an unknown w + w³/5 = other(x + w / 2) and a drag by a table of it.

    A table of a parameter alone enters the stiffness.
    """
    t, x, v, w, k, m = symbols("t", "x", "v", "w", "k", "m")
    residual = w + 0.2 * w**3 - other.value(x + 0.5 * w)
    force = -ground.slope(x) - (k + ground.value(k)) * x - 0.1 * other.value(w) * v
    equations = build(
        "rider",
        time=t,
        states=[(x, 0.4), (v, 1.0)],
        rates=[v, force / m],
        parameters=[(k, 0.7), (m, 1.3)],
        outputs=[("height", ground.value(x)), ("bend", ground.curvature(x)), ("w", w)],
        unknowns=[(w, 0.0)],
        residuals=[residual],
        blocks=(Block("w", 0, 1, 1e-9),),
        positions=(0,),
        velocities=(1,),
    )
    return with_tables(equations)
