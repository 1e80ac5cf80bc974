"""Cases that take steps of Newmark's family side by side, of one size or by their error.

Each lane has its own Jacobian, factors and halvings, and iterates until it converges; see
kernel/newmark/lanes.c. Its numbers are those of the case by itself, whatever its neighbours.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.integrate.lane_run import LaneRun
from vehicledyn.integrate.newmark.matrix_pattern import matrix_pattern
from vehicledyn.integrate.newmark.matrix_storage import enter_pattern, matrix_storage
from vehicledyn.integrate.newmark.reduced_steps import ReducedForm
from vehicledyn.integrate.newmark.weights import FIRST_HALVINGS, SHORTEST, TINY, Weights
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.newmark.newmark_code import (
    MOST_LANES,
    PlaceRecord,
    RunRecord,
    newmark_lanes,
)


@dataclass(frozen=True)
class LaneMethod:
    """What all cases of a model have in common: kernel, weights and tolerance of a step.

    The tolerance is that of the local error, None where steps have one size.
    """

    kernel: Kernel
    weights: Weights
    tolerance: float | None = None

    @classmethod
    def of(cls, kernel: Kernel, solver: Any) -> LaneMethod:
        """Return that of the settings of a method, as ``run_newmark`` takes them."""
        weights, tolerance = solver.weights, solver.tolerance
        if tolerance is None:
            weights = weights.settled(len(kernel.equations.states))
        return cls(kernel, weights, tolerance)


@dataclass
class NewmarkLaneRun(LaneRun):
    """Cases of a model, of which ``method`` says how they step."""

    method: LaneMethod = field(kw_only=True)

    def __post_init__(self) -> None:
        """Lay out the run, which has not begun."""
        super().__post_init__()
        self._code = newmark_lanes(self.engine.lanes)
        self._arrays: dict[str, NDArray[Any]] = {}
        self._has_begun = False
        self._record = self._laid_out()

    def advance(self, n_steps: int, samples: Vector) -> bool:
        """Take steps and write samples, see :meth:`LaneRun.advance`."""
        record = self._record
        if not self._has_begun:
            self._arrays["at.x"][:], self._arrays["at.z"][:] = self.state, self.unknowns
            begin = self.start + self.interval * (self.step // self.per_interval)
            record.at.time[:] = [begin] * MOST_LANES
            self._has_begun = True
            self._code.begin(record)
        record.last = self.step + n_steps
        record.lane_samples = samples.ctypes.data
        record.stride = samples.shape[1] * samples.shape[2]
        going = self._code.advance(record)
        self.step = record.last
        self.state[:], self.unknowns[:] = self._arrays["at.x"], self._arrays["at.z"]
        return going

    def window(
        self, start: float, interval: float, per_interval: int, channels: NDArray[np.intc]
    ) -> NewmarkLaneRun:
        """Return a run that begins anew here, see :meth:`LaneRun.window`."""
        times = start, interval, per_interval
        points = self.engine.copied(self.state), self.engine.copied(self.unknowns)
        return NewmarkLaneRun(
            self.engine, *times, channels, self.constants, *points, method=self.method
        )

    def _laid_out(self) -> RunRecord:
        kernel, w = self.method.kernel, self.method.weights
        engine, record, e = self.engine, RunRecord(), kernel.equations
        form, pattern = ReducedForm(kernel, w), matrix_pattern(kernel)
        n, n_states, n_unknowns = len(form.rows), len(e.states), len(e.unknowns)
        record.lane_rates = engine.address("vd_evaluate_lanes")
        record.lane_sample = engine.address("vd_follow_lanes")
        self._arrays = {
            **matrix_storage(pattern, engine.room, engine.lanes),
            "constants": self.constants,
            "given": engine.room(len(self.constants)),
            "work": engine.room(5 * n + 3 * n_states + 2 * n_unknowns),
            "watched": self.watched,
            "good": self.good,
            "channels": self.channels,
            "lane_status": self.fate.status,
            "lane_where": self.fate.where,
            "lane_residual": self.fate.residual,
            "new_mass": form.new_mass,
            "gamma": form.gamma,
            **{
                name: np.array(getattr(form, name), dtype=np.intc)
                for name in ("rows", "positions", "velocities", "pairs")
            },
        }
        for name, array in self._arrays.items():
            setattr(record, name, array.ctypes.data)
        sizes = {"x": n_states, "z": n_unknowns, "rates": n_states, "auxiliary": n}
        for part, size in {**sizes, "change": n, "drift": n_unknowns}.items():
            for name in ("at", "found"):
                place: PlaceRecord = getattr(record, name)
                array = self._arrays[f"{name}.{part}"] = engine.room(size)
                setattr(place, part, array.ctypes.data)
        record.n_states, record.n_unknowns = n_states, n_unknowns
        record.n_rows = record.n_watched = n
        record.n_pairs, record.n_constants = len(form.pairs), len(self.constants)
        record.n_channels, record.weak = len(self.channels), self.weak
        record.alpha_m, record.alpha_f, record.beta = w.alpha_m, w.alpha_f, w.beta
        record.second_order_gamma, record.first_order_gamma = w.gamma, w.first_order_gamma
        record.share = w.share
        record.start, record.interval = self.start, self.interval
        record.per_interval, record.step = self.per_interval, self.step
        record.tolerance = self.method.tolerance or 0.0
        record.shortest = TINY if record.tolerance else SHORTEST
        for own in record.matrix if record.tolerance else ():
            own.halvings = FIRST_HALVINGS
        enter_pattern(record, pattern)
        return record
