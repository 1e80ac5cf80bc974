"""Equations with known periodic orbits, for the tests of continuation."""

import casadi as ca
import numpy as np
from solve_examples import build, symbols

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.basis import basis
from vehicledyn.analyse.periodic.branch import follow_cycles
from vehicledyn.analyse.periodic.critical import find_hopf, follow_balance
from vehicledyn.analyse.periodic.cycle_points import Limits
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.symbolic.equations import Block


def field(equations, parameter):
    return AutonomousField(equations, parameter, [p.value for p in equations.parameters])


def van_der_pol(mu=0.1):
    t, x, v, m = symbols("t", "x", "v", "mu")
    return build(
        "van_der_pol", time=t, states=[(x, 2.0), (v, 0.0)], rates=[v, m * (1 - x**2) * v - x],
        parameters=[(m, mu)], outputs=[("x", x)], positions=(0,), velocities=(1,),
    )  # fmt: skip


def normal_form(cubic, quintic=0.0):
    """r' = r (μ + a r² + b r⁴), θ' = 2 + 0.3 r²: circles; with a state that decays beside."""
    t, x, y, w, m = symbols("t", "x", "y", "w", "mu")
    r2 = x * x + y * y
    growth, turn = m + cubic * r2 + quintic * r2**2, 2.0 + 0.3 * r2
    return build(
        "normal_form", time=t, states=[(x, 0.0), (y, 0.0), (w, 0.0)],
        rates=[x * growth - y * turn, y * growth + x * turn, -0.7 * w + x * y],
        parameters=[(m, 0.0)], outputs=[("x", x)],
    )  # fmt: skip


def looped_normal_form():
    """The same supercritical circles, with r² as the unknown of a block, and an angle's path."""
    t, x, y, path, m, s = symbols("t", "x", "y", "path", "mu", "squared")
    return build(
        "looped", time=t, states=[(x, 0.0), (y, 0.0), (path, 0.0)],
        rates=[x * (m - s) - 2.0 * y, y * (m - s) + 2.0 * x, 3.0 + x],
        parameters=[(m, 0.0)], outputs=[("x", x)], unknowns=[(s, 0.0)],
        residuals=[s + 0.1 * s**3 - (x * x + y * y) - 0.1 * (x * x + y * y) ** 3],
        blocks=(Block("square", 0, 1, 1e-12),),
    )  # fmt: skip


def duffing():
    """x'' + d x' + x + x³ = 0: closed orbits of every amplitude at d = 0."""
    t, x, v, d = symbols("t", "x", "v", "d")
    return build(
        "duffing", time=t, states=[(x, 0.0), (v, 0.0)], rates=[v, -d * v - x - x**3],
        parameters=[(d, 0.0)], outputs=[("x", x)], positions=(0,), velocities=(1,),
    )  # fmt: skip


def gap_oscillator():
    """Rotation with a stiff one-sided spring at both sides, and negative damping inside it."""
    t, x, v, m = symbols("t", "x", "v", "mu")
    beyond = ca.fmax(x - 1.0, 0.0) + ca.fmin(x + 1.0, 0.0)
    return build(
        "gap", time=t, states=[(x, 0.0), (v, 0.0)],
        rates=[v, -x - 400.0 * beyond + m * v - 0.02 * v**3],
        parameters=[(m, 0.0)], outputs=[("x", x)], positions=(0,), velocities=(1,),
    )  # fmt: skip


def grazing_oscillator():
    """An oscillation that grows by itself the more the larger it is, up to a stop at x = 1.

    The stop is a spring 4000 times as stiff that takes energy. Averaged, free cycles of the
    amplitude a lie at μ = -0.075 a², and the branch folds where they graze the stop.
    """
    t, x, v, m = symbols("t", "x", "v", "mu")
    beyond = ca.fmax(x - 1.0, 0.0)
    return build(
        "grazing", time=t, states=[(x, 0.0), (v, 0.0)],
        rates=[v, -x - 4000.0 * beyond * (1.0 + 4.0 * v) + (m + 0.3 * x * x) * v],
        parameters=[(m, 0.0)], outputs=[("x", x)], positions=(0,), velocities=(1,),
    )  # fmt: skip


def circle_beside(kind):
    """The circle r = 1 run through in 2π, and beside it a motion that begins to grow at μ = 0.

    "torus" is an oscillation at 0.3 rad/s, "branch_point" a deviation to one side.
    """
    t, x, y, u, w, m = symbols("t", "x", "y", "u", "w", "mu")
    r2, s2 = x * x + y * y, u * u + w * w
    if kind == "torus":
        beside = [u * (m - s2) - 0.3 * w, w * (m - s2) + 0.3 * u]
    else:
        beside = [u * (m - u * u), -w]
    return build(
        "circle", time=t, states=[(x, 1.0), (y, 0.0), (u, 0.0), (w, 0.0)],
        rates=[x * (1 - r2) - y, y * (1 - r2) + x, *beside],
        parameters=[(m, -0.5)], outputs=[("x", x)],
    )  # fmt: skip


def rossler(c=2.0):
    """Rössler's equations, a = b = 0.2: the period doubles near c = 2.83."""
    t, x, y, z, p = symbols("t", "x", "y", "z", "c")
    return build(
        "rossler", time=t, states=[(x, -2.0), (y, 0.0), (z, 0.1)],
        rates=[-y - z, x + 0.2 * y, 0.2 + z * (x - p)],
        parameters=[(p, c)], outputs=[("x", x)],
    )  # fmt: skip


def from_hopf(model, low, high, *, amplitude=1e-4, points=30, start=None, intervals=20):
    """The Hopf bifurcation in a range and the branch that begins there."""
    state = np.zeros(model.size) if start is None else start
    balances = follow_balance(model, np.linspace(low, high, 14), state, np.zeros(model.n_unknowns))
    (hopf,) = find_hopf(model, balances)
    first = hopf.orbit(amplitude, 0, intervals=intervals, degree=4)
    limits = Limits(low, high, (high - low) / points)
    return hopf, follow_cycles(model, first, hopf.growing(first), limits)


def sampled_orbit(period, value, motion, *, intervals=40, n_unknowns=0):
    """A guess of an orbit from a function of the part of the period."""
    mesh = np.linspace(0.0, 1.0, intervals + 1)
    empty = np.zeros((intervals * 4, n_unknowns))
    bare = Orbit(basis(4), mesh, empty, empty, period, value)
    own, _ = bare.times_of(mesh)
    return Orbit(bare.basis, mesh, motion(own), empty, period, value)


def cornered_circles(back, rate=1.0):
    """Circles with μ = r up to r = 1 and μ = 1 - back (r - 1) beyond: a fold that is a corner.

    Their larger multiplier is exp(-π rate r), then exp(π rate back r).
    """
    t, x, y, m = symbols("t", "x", "y", "mu")
    r = ca.sqrt(x * x + y * y + 1e-12)
    growth = rate * (m - r + (1.0 + back) * ca.fmax(r - 1.0, 0.0))
    return build(
        "cornered", time=t, states=[(x, 0.5), (y, 0.0)],
        rates=[x * growth - 2.0 * y, y * growth + 2.0 * x],
        parameters=[(m, 0.5)], outputs=[("x", x)],
    )  # fmt: skip
