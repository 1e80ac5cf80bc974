"""Small equations with events whose instants are known in closed form."""

from dataclasses import replace

import casadi as ca
import numpy as np
from solve_examples import Samples, build, oscillator, slider_crank, starts, symbols

from vehicledyn.base.registry import find
from vehicledyn.integrate.newmark.weights import Weights
from vehicledyn.integrate.simulate import simulate
from vehicledyn.symbolic.equations import Event

GRAVITY = 9.81
IMPLICIT = ("newmark", "hht", "generalised_alpha")
FIXED = ("rk4", "symplectic_euler", "rkc", *IMPLICIT)


def with_events(equations, *events):
    """Add events from (name, expression, direction, terminal, {state number: new value})."""
    found, new_values = [], []
    for index, (name, _, direction, terminal, resets) in enumerate(events):
        rows = [(state, len(new_values) + k) for k, state in enumerate(resets)]
        new_values += resets.values()
        found.append(Event(name, index, direction, terminal, tuple(rows)))
    return replace(
        equations,
        event=ca.vertcat(*[ca.SX(item[1]) for item in events]),
        reset=ca.vertcat(*[ca.SX(item) for item in new_values]) if new_values else None,
        events=tuple(found),
    )


def bouncing_ball(restitution=0.8):
    """Ball that falls from 1 m and leaves the ground with a part of its speed."""
    t, height, speed = symbols("t", "height", "speed")
    g, e = symbols("gravity", "restitution")
    equations = build(
        "bouncing_ball",
        time=t,
        states=[(height, 1.0), (speed, 0.0)],
        rates=[speed, -g],
        parameters=[(g, GRAVITY), (e, restitution)],
        outputs=[("energy", 0.5 * speed**2 + g * height)],
        positions=(0,),
        velocities=(1,),
    )
    return with_events(equations, ("impact", height, "falling", False, {1: -e * speed}))


def bounces(count, restitution=0.8):
    """Return the instants of the first impacts: t₁ = √(2h/g), then flights of 2 eⁿ t₁."""
    first = np.sqrt(2.0 / GRAVITY)
    return first * (1.0 + 2.0 * np.cumsum(restitution ** np.arange(count)) - 2.0)


def settling_ball(restitution=0.8, slow=0.02):
    """Bouncing ball that stays on the ground once it would leave it slowly."""
    t, height, speed, resting = symbols("t", "height", "speed", "resting")
    rebound = -restitution * speed
    stays = rebound < slow
    equations = build(
        "settling_ball",
        time=t,
        states=[(height, 1.0), (speed, 0.0), (resting, 0.0)],
        rates=[speed, -GRAVITY * (1.0 - resting), ca.SX(0.0)],
        parameters=[],
        outputs=[("height", height)],
        positions=(0,),
        velocities=(1,),
    )
    resets = {1: ca.if_else(stays, 0.0, rebound), 2: stays}
    return with_events(equations, ("impact", height, "falling", False, resets))


def crossing_oscillator(direction="either", *, terminal=False):
    """x = cos 2t with an event where x = 0, at (2 k + 1) π/4."""
    equations = oscillator()
    return with_events(equations, ("zero", equations.state[0], direction, terminal, {}))


def kicked_oscillator():
    """x = cos 2t whose speed is halved where it passes x = 0 downwards."""
    equations = oscillator()
    x, v = equations.state[0], equations.state[1]
    return with_events(equations, ("brake", x, "falling", False, {1: 0.5 * v}))


def jumping_crank():
    """Slider-crank whose crank jumps on by 0.5 rad and halves its rate at 2 m of the slider."""
    equations = slider_crank()
    angle, rate = equations.state[0], equations.state[1]
    resets = {0: angle + 0.5, 1: 0.5 * rate}
    far = equations.algebraic[1] - 2.0
    return with_events(equations, ("far", far, "falling", False, resets))


class Run:
    """A simulation with its samples, events and statistics."""

    def __init__(self, kernel, solver, *, stop, interval, start=0.0, state=None, **settings):
        first, unknowns = starts(kernel.equations)
        self.samples, self.events = Samples(), []
        self.statistics, self.error = None, None
        self._arguments = {
            "start": start,
            "stop": stop,
            "interval": interval,
            "state": first if state is None else state,
            "unknowns": unknowns,
            "sink": self.samples,
            "happened": lambda name, time: self.events.append((name, time)),
        }
        self._method = find("solver", solver)(**settings)
        self._kernel = kernel

    def go(self):
        self.statistics = simulate(self._kernel, self._method, **self._arguments)
        return self

    @property
    def times(self):
        return np.array([time for _, time in self.events])


def settings_of(solver, *, step=1e-3, tolerance=1e-10):
    """Return settings of a method, fixed or adaptive."""
    if solver in FIXED:
        return {"step": step} | ({"stages": 4} if solver == "rkc" else {})
    return {"relative_tolerance": tolerance, "absolute_tolerance": tolerance}


def late_by(kind, phase):
    """Share of time by which a method is late on an oscillation, by its amplification matrix.

    ``phase`` is the angle in a step [rad]; zero for methods that are not of Newmark's family.
    """
    if kind not in IMPLICIT:
        return 0.0
    settings = find("solver", kind)(step=1.0)
    if kind == "newmark":
        w = Weights.newmark(settings.beta, settings.gamma)
    else:
        w = getattr(Weights, kind)(settings.spectral_radius)
    n = phase * phase
    left = [[1.0, 0.0, -w.beta], [0.0, 1.0, -w.gamma], [(1 - w.alpha_f) * n, 0.0, 1 - w.alpha_m]]
    right = [[1.0, 1.0, 0.5 - w.beta], [0.0, 1.0, 1.0 - w.gamma], [-w.alpha_f * n, 0.0, -w.alpha_m]]
    turns = np.abs(np.angle(np.linalg.eigvals(np.linalg.solve(left, right))))
    return phase / turns[np.argmin(np.abs(turns - phase))] - 1.0
