"""Optimisation with exact gradients and without: how many simulations each takes.

    python benchmarks/optimisation.py [STUDY ...] [--without]

Studies are those of the folder of this name, or paths of others; they begin at poor starts. With
gradients a study runs as ``vehicledyn optimise`` does. Without them (``--without``) scipy's COBYQA,
COBYLA and SLSQP, which takes its gradients by differences, see the same scaled variables, objective
and constraints, and count simulations until they are within parts of what the gradients gained, or
have taken thirty times their number. One simulation with gradients counts as one.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyse.variable_box import VariableBox
from vehicledyn.base.step_memory import Memory
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.studies.optimisation.file import load_optimisation
from vehicledyn.studies.optimisation.problem import Problem
from vehicledyn.studies.optimisation.run import run_optimisation

FOLDER = Path(__file__).parent / "optimisation"
ALL = ("hardpoints", "clearance", "yaw_damping")
PARTS, MOST, KEPT = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6), 30, 1e-5
"""Parts of the gain that may be missing, runs in those with gradients, scaled violation allowed."""

METHODS: dict[str, tuple[str, dict[str, Any]]] = {
    "COBYQA": ("COBYQA", {"initial_tr_radius": 0.25, "final_tr_radius": 1e-7, "maxfev": 10**5}),
    "COBYQA, small steps": (
        "COBYQA",
        {"initial_tr_radius": 0.1, "final_tr_radius": 1e-7, "maxfev": 10**5},
    ),
    "COBYLA": ("COBYLA", {"rhobeg": 0.2, "tol": 1e-8, "maxiter": 10**5}),
    "SLSQP by differences": ("SLSQP", {"ftol": 1e-10, "eps": 1e-6, "maxiter": 1000}),
}


class EnoughError(Exception):
    """Ends a search."""


def quiet(*_: object) -> None:
    """Report nothing."""


def place(name: str) -> Path:
    """Return the path of a study."""
    return Path(name) if name.endswith(".yaml") else FOLDER / f"{name}.yaml"


class Plain:
    """Objective and constraints of a study by runs without derivatives, which are counted."""

    def __init__(self, name: str, best: float, most: int) -> None:
        study = load_optimisation(place(name))
        self.problem = Problem(study, Memory(), quiet)
        self.box = VariableBox(self.problem.low, self.problem.high)
        first = self.problem.values(self.problem.start)
        scaled = self.box.by_shares(first, self.problem.start)
        self.size = max(abs(first.objective), float(np.max(np.abs(scaled.gradient))))
        slopes = np.max(np.abs(scaled.jacobian), axis=1, initial=0.0)
        self.scales = np.maximum(np.abs(first.constraints), slopes)
        self.first, self.best, self.most = first.objective, best, most
        self.begin = self.box.shares(self.problem.start)
        self.forget()

    def forget(self) -> None:
        """Count from zero again."""
        self.known: dict[bytes, tuple[float, np.ndarray]] = {}
        self.reached: dict[float, int] = {}

    def at(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        """Return scaled objective and constraints; stop where all is reached."""
        x = np.clip(x, 0.0, 1.0)
        if x.tobytes() not in self.known:
            if len(self.known) >= self.most:
                raise EnoughError
            self.known[x.tobytes()] = self._new(x)
            objective, constraints = self.known[x.tobytes()]
            if np.min(constraints, initial=0.0) >= -KEPT:
                for part in PARTS:
                    if objective * self.size <= self.best + part * (self.first - self.best):
                        self.reached.setdefault(part, len(self.known))
            if PARTS[-1] in self.reached:
                raise EnoughError
        return self.known[x.tobytes()]

    def _new(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        p = self.problem
        found = p._values(p._figures(self.box.point(x), follows=False), len(x))
        return found.objective / self.size, found.constraints / self.scales


def with_gradients(name: str) -> tuple[int, float]:
    """Run a study, print what it came to, and return its runs and objective."""
    begun = time.perf_counter()
    report = run_optimisation(load_optimisation(place(name)), kept=KeptWork(), progress=quiet)
    table = report.table
    kept = np.asarray(table.violation) <= KEPT
    best, first = float(np.min(table.objective[kept])), table.objective[0]
    counts = {}
    for part in PARTS:
        is_near = kept & (table.objective <= best + part * (first - best))
        counts[part] = int(np.argmax(is_near)) + 1
    print(
        f"{name}: {table.n_runs} runs with gradients, {table.message}, optimality "
        f"{table.optimality:.1e}, {time.perf_counter() - begun:.0f} s; objective {first:.6g} -> "
        f"{best:.9g}; {words(counts)}",
        flush=True,
    )
    return table.n_runs, best


def words(counts: dict[float, int]) -> str:
    """Return after how many runs which part of the gain was missing."""
    return "up to " + ", ".join(f"{part:g} of the gain {counts.get(part, '-')}" for part in PARTS)


def without(plain: Plain, name: str, label: str) -> None:
    """Count the simulations of a search without gradients."""
    method, options = METHODS[label]
    plain.forget()
    limit: Callable[[np.ndarray], np.ndarray] = lambda x: plain.at(x)[1]  # noqa: E731
    limits = [{"type": "ineq", "fun": limit}] if plain.scales.size else []
    end = "stopped"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            minimize(
                lambda x: plain.at(x)[0], plain.begin, method=method, constraints=limits,
                bounds=[(0.0, 1.0)] * len(plain.begin), options=options,
            )  # fmt: skip
        end = "ended"
    except EnoughError:
        pass
    least = min(
        (o for o, c in plain.known.values() if np.min(c, initial=0.0) >= -KEPT), default=np.nan
    )
    print(
        f"{name}: {label} {end} after {len(plain.known)} runs without gradients at "
        f"{least * plain.size:.9g}; {words(plain.reached)}",
        flush=True,
    )


def main() -> None:
    """Run the studies that are asked for."""
    names = [item for item in sys.argv[1:] if not item.startswith("-")] or list(ALL)
    for name in names:
        runs, best = with_gradients(name)
        if "--without" in sys.argv:
            plain = Plain(name, best, MOST * runs)
            for label in METHODS:
                without(plain, name, label)


if __name__ == "__main__":
    main()
