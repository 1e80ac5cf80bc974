"""System files of the project at given coordinates: matrices of the equations, channels."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

import vehicledyn.catalogue  # noqa: F401
from reference_cases.motions import Recorded, quiet
from vehicledyn.analyses.preparation.prepare import prepare, start_point
from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.files.scenario import load_model, load_scenario
from vehicledyn.multibody.equations.equation_terms import derive_ingredients
from vehicledyn.symbolic import ops

ROOT = Path(__file__).parents[3]
FOLDER = ROOT / "systems"
TIGHT = ("solver.relative_tolerance=1e-12", "solver.absolute_tolerance=1e-12")
"""Tolerances for comparisons at 1e-9 of scenarios that use dop853."""


@lru_cache(maxsize=32)
def ready(name, *overrides):
    """Return a system file of the project, derived; ``overrides`` change its numbers."""
    target = load_model(str(FOLDER / f"{name}.yaml"), overrides)
    return prepare(target, backend="interpreted", progress=quiet)


def parameters(prepared):
    """Return the parameters by name."""
    return {q.name: q.value for q in prepared.equations.parameters}


@lru_cache(maxsize=32)
def motion(name, *overrides):
    """Return the samples of a scenario of a system, run as the command line does."""
    loaded = load_scenario(ROOT / "scenarios" / "systems" / f"{name}.yaml", overrides)
    prepared = prepare(loaded, backend="auto", progress=quiet)
    s = loaded.scenario
    start = start_point(prepared, s.speed or 0.0, s.start)
    samples = []
    simulate_monitored(
        prepared.subject.system,
        prepared.kernel,
        s.solver,
        start=0.0,
        stop=s.duration,
        state=start.state,
        unknowns=start.unknowns,
        interval=s.output.interval,
        sink=lambda t, x, z, y: samples.append((t.copy(), y.copy())),
        progress=quiet,
        happened=quiet,
    )
    values = np.vstack([y for _, y in samples])
    names = [channel.name for channel in prepared.equations.channels]
    columns = {n: values[:, k] for k, n in enumerate(names)}
    return Recorded(prepared, np.concatenate([t for t, _ in samples]), columns)


def values_at_start(equations):
    """Return rates of the states and channels by name where a system is assembled."""
    inputs = [equations.time, equations.state, equations.algebraic, equations.parameter]
    x, z, p = (
        np.array([v.start for v in equations.states]),
        np.array([v.start for v in equations.unknowns]),
        [v.value for v in equations.parameters],
    )
    rates = ops.numeric(inputs, equations.rate)(0.0, x, z, p)[:, 0]
    outputs = ops.numeric(inputs, equations.output)(0.0, x, z, p)[:, 0]
    return (
        dict(zip((v.name for v in equations.states), rates, strict=True)),
        dict(zip((c.name for c in equations.channels), outputs, strict=True)),
    )


class Matrices:
    """M, c, J and γ of a system as functions of time, coordinates and rates."""

    def __init__(self, name, *overrides):
        self.prepared = ready(name, *overrides)
        g = derive_ingredients(self.prepared.subject.system)
        self.names = [v.name for v in g.variables]
        self.start = np.array([v.start for v in g.variables])
        self.holonomic = len(g.constraints)
        n, m = len(self.names), len(g.constraint_names)
        self._inputs = [g.equations.time, g.coordinates, g.rates, g.equations.parameter]
        self._values = [p.value for p in g.equations.parameters]
        self._mass = self._function(_full(g.mass, n, n), (n, n))
        self._bias = self._function(g.bias, (n,))
        self._jacobian = self._function(_full(g.jacobian, m, n), (m, n))
        self._quadratic = self._function(g.quadratic, (m,))
        self._gap = self._function([*g.constraints, *g.constraint_rate], (-1,))

    def at(self, time, coordinates, rates):
        """Return M, c, J and γ as arrays."""
        functions = (self._mass, self._bias, self._jacobian, self._quadratic)
        return tuple(f(time, coordinates, rates) for f in functions)

    def consistent(self, seed, time, *, spread=0.25):
        """Return random coordinates and rates that fulfil the constraints at a time."""
        random = np.random.default_rng(seed)
        q = self.start + spread * random.uniform(-1.0, 1.0, len(self.names))
        for _ in range(50):
            gap = self._gap(time, q, 0.0 * q)[: self.holonomic]
            if np.abs(gap).max(initial=0.0) < 1e-15:
                break
            q = q - np.linalg.pinv(self._slopes(time, q)[: self.holonomic], rcond=1e-9) @ gap
        rates = random.normal(size=len(self.names))
        drift = self._gap(time, q, rates)[self.holonomic :]
        slopes = self._slopes(time, q)
        if len(slopes):
            rates = rates - np.linalg.pinv(slopes, rcond=1e-9) @ (slopes @ rates + drift)
        return q, rates

    def solved(self, time, coordinates, rates):
        """Return accelerations and channels by name, from the compiled equations."""
        e, kernel = self.prepared.equations, self.prepared.kernel
        all_values = dict(zip(self.names, coordinates, strict=True))
        all_values |= {f"{n}_rate": v for n, v in zip(self.names, rates, strict=True)}
        state = np.array([all_values[s.name] for s in e.states])
        guess = np.array([all_values[u.name] for u in e.unknowns])
        unknowns = kernel.solve_unknowns(time, state, guess)
        found = dict(
            zip((s.name for s in e.states), kernel.rates(time, state, unknowns), strict=True)
        )
        outputs = kernel.outputs(time, state, unknowns)
        channels = dict(zip((c.name for c in e.channels), outputs, strict=True))
        return {k: v for k, v in found.items() if k.endswith("_rate")}, channels

    def _slopes(self, time, q):
        return self._jacobian(time, q, 0.0 * q)

    def _function(self, items, shape):
        items = [ops.scalar(item) for item in items]
        if not items:
            return lambda *_: np.zeros([max(k, 0) for k in shape])
        evaluate = ops.numeric(self._inputs, ops.column(items))
        return lambda t, q, v: evaluate(t, q, v, self._values)[:, 0].reshape(shape)


def _full(entries, rows, columns):
    return [entries.get((i, j), 0.0) for i in range(rows) for j in range(columns)]
