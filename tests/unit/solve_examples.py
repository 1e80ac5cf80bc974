"""Small equations written by hand, with known motions, for the tests of the solvers."""

import math

import casadi as ca
import numpy as np

from vehicledyn.integrate.batch import Cases
from vehicledyn.symbolic.equations import Block, Channel, Equations, ParameterValue, Variable


def _column(*items):
    return ca.vertcat(*[ca.SX(item) for item in items]) if items else ca.SX(0, 1)


def build(name, *, time, states, rates, parameters, outputs, unknowns=(), residuals=(), **more):
    """Equations from (symbol, start), (symbol, value) and (name, expression) pairs."""
    return Equations(
        name=name,
        time=time,
        state=_column(*[symbol for symbol, _ in states]),
        algebraic=_column(*[symbol for symbol, _ in unknowns]),
        parameter=_column(*[symbol for symbol, _ in parameters]),
        rate=_column(*rates),
        residual=_column(*residuals),
        output=_column(*[expression for _, expression in outputs]),
        event=ca.SX(0, 1),
        states=tuple(Variable(s.name(), "1", s.name(), start) for s, start in states),
        unknowns=tuple(Variable(s.name(), "1", s.name(), start) for s, start in unknowns),
        parameters=tuple(ParameterValue(s.name(), "1", s.name(), v) for s, v in parameters),
        channels=tuple(Channel(label, "1", label) for label, _ in outputs),
        **more,
    )


def symbols(*names):
    return [ca.SX.sym(name) for name in names]


def oscillator(stiffness=4.0, damping=0.0):
    """Mass on a spring: x = cos(sqrt(k) t) where it is not damped."""
    t, x, v, k, d, m = symbols("t", "position", "velocity", "stiffness", "damping", "mass")
    return build(
        "oscillator",
        time=t,
        states=[(x, 1.0), (v, 0.0)],
        rates=[v, -(k * x + d * v) / m],
        parameters=[(k, stiffness), (d, damping), (m, 1.0)],
        outputs=[("energy", 0.5 * m * v**2 + 0.5 * k * x**2)],
        positions=(0,),
        velocities=(1,),
    )


def decay(rate):
    """A state that follows sin(t) ever more closely the faster it decays."""
    t, x = symbols("t", "position")
    return build(
        "decay",
        time=t,
        states=[(x, 0.01)],
        rates=[-rate * (x - ca.sin(t)) + ca.cos(t)],
        parameters=[],
        outputs=[("position_again", x)],
    )


def forced():
    """Rate that depends on time alone: x = sin(t) + t⁵, with a state that grows with it."""
    t, x, y = symbols("t", "position", "other")
    return build(
        "forced",
        time=t,
        states=[(x, 0.0), (y, 1.0)],
        rates=[ca.cos(t) + 5.0 * t**4, -y * ca.sin(t)],
        parameters=[],
        outputs=[("position", x)],
    )


def slider_crank(rod=2.0, speed=3.0):
    """Crank, massless rod and slider: kinetic energy stays, the loop gives rod and slider."""
    t, angle, rate = symbols("t", "crank.angle", "crank.rate")
    rod_angle, slider = symbols("rod.angle", "slider.position")
    radius, length, inertia, mass = symbols("radius", "rod_length", "inertia", "mass")
    lever = -radius * ca.sin(angle) - radius * ca.cos(angle) * ca.tan(rod_angle)
    turning = radius * ca.cos(angle) / (length * ca.cos(rod_angle))
    slope = (
        -radius * ca.cos(angle)
        + radius * ca.sin(angle) * ca.tan(rod_angle)
        - radius * ca.cos(angle) / ca.cos(rod_angle) ** 2 * turning
    )
    effective = inertia + mass * lever**2
    return build(
        "slider_crank",
        time=t,
        states=[(angle, 0.3), (rate, speed)],
        rates=[rate, -mass * lever * slope * rate**2 / effective],
        parameters=[(radius, 1.0), (length, rod), (inertia, 0.7), (mass, 1.3)],
        unknowns=[(rod_angle, 0.15), (slider, 2.9)],
        residuals=[
            radius * ca.cos(angle) + length * ca.cos(rod_angle) - slider,
            radius * ca.sin(angle) - length * ca.sin(rod_angle),
        ],
        outputs=[
            ("energy", 0.5 * effective * rate**2),
            ("slider.velocity", lever * rate),
            ("rod.angle", rod_angle),
        ],
        blocks=(Block("crank loop", 0, 2, 1e-10),),
        positions=(0,),
        velocities=(1,),
    )


def exact_slider_crank(angle, rod=2.0):
    """Return rod angle and slider position."""
    rod_angle = math.asin(math.sin(angle) / rod)
    return rod_angle, math.cos(angle) + rod * math.cos(rod_angle)


def double_pendulum():
    """Two point masses on massless bars, the tip found through two small blocks."""
    t, a, b, u, v = symbols("t", "upper.angle", "lower.angle", "upper.rate", "lower.rate")
    elbow_x, elbow_y, tip_x, tip_y = symbols("elbow.x", "elbow.y", "tip.x", "tip.y")
    la, lb, ma, mb, g = symbols("upper.length", "lower.length", "upper.mass", "lower.mass", "g")
    c, s = ca.cos(a - b), ca.sin(a - b)
    m11, m12, m22 = (ma + mb) * la**2, mb * la * lb * c, mb * lb**2
    f1 = -mb * la * lb * s * v**2 - (ma + mb) * g * la * ca.sin(a)
    f2 = mb * la * lb * s * u**2 - mb * g * lb * ca.sin(b)
    det = m11 * m22 - m12**2
    kinetic = 0.5 * m11 * u**2 + m12 * u * v + 0.5 * m22 * v**2
    return build(
        "double_pendulum",
        time=t,
        states=[(a, 0.4), (b, 0.7), (u, 0.0), (v, 0.0)],
        rates=[u, v, (m22 * f1 - m12 * f2) / det, (m11 * f2 - m12 * f1) / det],
        parameters=[(la, 1.0), (lb, 0.8), (ma, 1.2), (mb, 0.9), (g, 9.81)],
        unknowns=[(elbow_x, 0.4), (elbow_y, -0.9), (tip_x, 0.9), (tip_y, -1.5)],
        residuals=[
            elbow_x - la * ca.sin(a),
            elbow_y + la * ca.cos(a) + 0.1 * (elbow_x - la * ca.sin(a)) ** 3,
            (tip_x - elbow_x) * ca.exp(tip_x - elbow_x) - lb * ca.sin(b) * ca.exp(lb * ca.sin(b)),
            tip_y - elbow_y + lb * ca.cos(b),
        ],
        outputs=[
            ("energy", kinetic + ma * g * elbow_y + mb * g * tip_y),
            ("tip.x", tip_x),
            ("tip.y", tip_y),
        ],
        blocks=(Block("elbow", 0, 2, 1e-10), Block("tip", 2, 4, 1e-10)),
        positions=(0, 1),
        velocities=(2, 3),
    )


def starts(equations):
    """Return the starting states and unknowns."""
    return [s.start for s in equations.states], [u.start for u in equations.unknowns]


class Samples:
    """A sink that keeps everything."""

    def __init__(self):
        self.chunks = []

    def __call__(self, times, states, unknowns, outputs):
        self.chunks.append((times, states, unknowns, outputs))

    def __getattr__(self, name):
        import numpy as np

        place = {"times": 0, "states": 1, "unknowns": 2, "outputs": 3}[name]
        return np.concatenate([chunk[place] for chunk in self.chunks])


def cases_of(equations, **changes):
    """Cases in which the named parameters take the given values, all of one length."""
    state, unknowns = starts(equations)
    names = [p.name for p in equations.parameters]
    n = len(next(iter(changes.values())))
    parameters = np.tile([p.value for p in equations.parameters], (n, 1))
    for name, values in changes.items():
        parameters[:, names.index(name)] = values
    return Cases(parameters, np.tile(state, (n, 1)), np.tile(unknowns, (n, 1)))
