"""Optimisation with exact gradients and without: how many simulations each takes.

    python benchmarks/optimisation.py [hardpoints clearance yaw_damping] [--without]

The studies in the folder of this name begin at poor starts. With gradients a study runs as
``vehicledyn optimise`` does. Without them (``--without``) scipy's COBYLA sees the same scaled
objective and constraints, and counts simulations until it is within a thousandth of what the
gradients gained, or has taken thirty times their number; and SLSQP, which takes its gradients by
differences, searches until it has converged.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
from scipy.optimize import minimize

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.step_memory import Memory
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.studies.optimisation.file import load_optimisation
from vehicledyn.studies.optimisation.problem import Problem
from vehicledyn.studies.optimisation.run import run_optimisation

FOLDER = Path(__file__).parent / "optimisation"
ALL = ("hardpoints", "clearance", "yaw_damping")
GAIN, MOST, KEPT = 1e-3, 30, 1e-3


class EnoughError(Exception):
    """Ends a search."""


def quiet(*_: object) -> None:
    """Report nothing."""


class Plain:
    """Objective and constraints of a study by runs without derivatives."""

    def __init__(self, name: str, goal: float, most: int) -> None:
        study = load_optimisation(FOLDER / f"{name}.yaml")
        self.problem = Problem(study, Memory(), quiet)
        first = self.problem.values(self.problem.start)
        self.weights, self.start = study.weights, first.objective
        slopes = np.abs(first.jacobian * (self.problem.high - self.problem.low))
        self.scales = np.maximum(np.abs(first.constraints), slopes.max(axis=1, initial=0.0))
        self.goal, self.most, self.count = goal, most, 0
        self.known: dict[bytes, tuple[float, np.ndarray]] = {}

    def at(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        """Return scaled objective and constraints; stop where the goal is reached."""
        x = np.clip(x, 0.0, 1.0)
        if x.tobytes() not in self.known:
            self.known[x.tobytes()] = self._new(x)
            objective, constraints = self.known[x.tobytes()]
            kept = np.min(constraints, initial=0.0) >= -KEPT
            if (kept and objective * self.start <= self.goal) or self.count >= self.most:
                raise EnoughError
        return self.known[x.tobytes()]

    def _new(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        p = self.problem
        self.count += 1
        figures = p._figures(p.low + (p.high - p.low) * x, follows=False).values
        objective = sum(w * figures[n] for n, w in self.weights.items())
        limits = [sign * (figures[name] - value) for name, sign, value in p.limits()]
        return objective / self.start, np.array(limits) / self.scales


def with_gradients(name: str) -> tuple[int, float]:
    """Run a study, print what it came to, and return its runs and objective."""
    begun = time.perf_counter()
    study = load_optimisation(FOLDER / f"{name}.yaml")
    report = run_optimisation(study, kept=KeptWork(), progress=quiet)
    table = report.table
    best = float(np.min(table.objective[np.asarray(table.violation) <= 1e-5]))
    seconds = time.perf_counter() - begun
    goal = best + GAIN * (table.objective[0] - best)
    near = (table.objective <= goal) & (table.violation <= KEPT)
    print(
        f"{name}: {table.n_runs} runs with gradients, {int(np.argmax(near)) + 1} of them up to "
        f"{GAIN:.1%} of the gain; objective {table.objective[0]:.6g} -> "
        f"{best:.6g}, optimality {table.optimality:.1e}, {seconds:.0f} s",
        flush=True,
    )
    return table.n_runs, best


def without(name: str, runs: int, best: float) -> None:
    """Count the simulations of a search without gradients."""
    first = Plain(name, -np.inf, 1)
    goal = best + GAIN * abs(first.start - best)
    plain = Plain(name, goal, MOST * runs)
    p = plain.problem
    start = (p.start - p.low) / (p.high - p.low)
    limits = [{"type": "ineq", "fun": lambda x: plain.at(x)[1]}] if plain.scales.size else []
    limits += [{"type": "ineq", "fun": lambda x: x}, {"type": "ineq", "fun": lambda x: 1.0 - x}]
    end = "reached"
    try:
        minimize(
            lambda x: plain.at(x)[0], start, method="COBYLA", constraints=limits,
            options={"rhobeg": 0.2, "tol": 1e-8, "maxiter": 10 * plain.most},
        )  # fmt: skip
        end = "ended before"
    except EnoughError:
        end = "reached" if plain.count < plain.most else "not reached"
    least = min((o for o, c in plain.known.values() if np.min(c, initial=0.0) >= -KEPT), default=1)
    print(
        f"{name}: {plain.count} runs without gradients, objective {least * plain.start:.6g}; "
        f"{GAIN:.1%} of the gain {end}",
        flush=True,
    )


def by_differences(name: str) -> None:
    """Count the simulations of a search whose gradients are differences."""
    plain = Plain(name, -np.inf, 10**6)
    p = plain.problem
    start = (p.start - p.low) / (p.high - p.low)
    limits = [{"type": "ineq", "fun": lambda x: plain.at(x)[1]}] if plain.scales.size else []
    found = minimize(
        lambda x: plain.at(x)[0], start, method="SLSQP", bounds=[(0.0, 1.0)] * len(start),
        constraints=limits, options={"ftol": 1e-8, "maxiter": 200},
    )  # fmt: skip
    print(
        f"{name}: {plain.count} runs by differences, objective {found.fun * plain.start:.6g}; "
        f"{found.message}",
        flush=True,
    )


def main() -> None:
    """Run the studies that are asked for."""
    names = [item for item in sys.argv[1:] if not item.startswith("-")] or list(ALL)
    for name in names:
        found = with_gradients(name)
        if "--without" in sys.argv:
            without(name, *found)
            by_differences(name)


if __name__ == "__main__":
    main()
