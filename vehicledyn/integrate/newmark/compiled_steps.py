"""Steps of Newmark's family in a compiled loop, on the functions of a compiled kernel."""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from vehicledyn.integrate.course import MethodState
from vehicledyn.integrate.events import ConsistentPoint
from vehicledyn.integrate.newmark.matrix_pattern import matrix_pattern
from vehicledyn.integrate.newmark.matrix_storage import enter_pattern, matrix_storage
from vehicledyn.integrate.newmark.reduced_steps import ReducedForm, ReducedPlace
from vehicledyn.integrate.newmark.weights import Weights
from vehicledyn.integrate.task import Task
from vehicledyn.kernel.compiled import CompiledEngine
from vehicledyn.kernel.engine import Count, Figure, Ledger, SampleRows, Vector
from vehicledyn.kernel.newmark.newmark_code import (
    FRESH_JACOBIAN,
    NO_JACOBIAN,
    NewmarkCode,
    Outcome,
    PlaceRecord,
    RunRecord,
)

P = TypeVar("P")


class StateLayout(NamedTuple):
    """Places of rows, positions and velocities in the state, and of velocities among the rows.

    ``watched`` are the first rows whose error is looked at, ``rates`` the numbers that a place
    keeps of the rates, ``forces`` those of its multipliers and what corrects positions, ``work``
    the room that a step needs.
    """

    rows: NDArray[np.intp]
    positions: list[int]
    velocities: list[int]
    pairs: NDArray[np.intp]
    watched: int
    rates: int
    forces: int
    work: int


class CompiledLoop(ABC, Generic[P]):
    """Takes steps as the interpreted ones do, many of them in one call.

    ``record`` is what the compiled code knows of the run; ``ledger`` keeps account of the steps
    since it was last emptied.
    """

    def __init__(
        self, task: Task, engine: CompiledEngine, weights: Weights, code: NewmarkCode
    ) -> None:
        """Begin a run of the task, whose kernel has this engine."""
        self.task, self._weights, self._code = task, weights, code
        self._arrays: dict[str, Any] = {}
        self.ledger = Ledger()
        self.record = self._laid_out(engine)

    @property
    @abstractmethod
    def _layout(self) -> StateLayout: ...

    @abstractmethod
    def start(self, point: ConsistentPoint) -> P:
        """Return the place from which the motion starts, or starts anew."""

    @abstractmethod
    def resumed(self, point: ConsistentPoint, numbers: Vector) -> P:
        """Return the place from which a run goes on whose piece has ended with these numbers."""

    @abstractmethod
    def carried(self, place: P) -> MethodState:
        """Return what a run goes on with behind a place."""

    @abstractmethod
    def go_to(self, place: P) -> None:
        """Let the run go on from a place."""

    @abstractmethod
    def error(self, before: P, after: P) -> float:
        """Return the largest local error of a step about; the compiled loop finds its own."""

    def outputs(self, place: P) -> Vector | None:
        """Return nothing: the compiled loop finds the channels of its samples."""
        return None

    @abstractmethod
    def find_jacobian(self) -> None:
        """Find the Jacobian, and factors where the compiled code has none of its own."""

    @abstractmethod
    def _place(self, name: str, at: PlaceRecord) -> P: ...

    @property
    def place(self) -> P:
        """Where the run is."""
        return self._place("at", self.record.at)

    def step(self, place: P, end: float) -> P | None:
        """Return the end of a step, or None where Newton's method does not converge."""
        self.go_to(place)
        outcome = self._code.step(self.record, end)
        while outcome is Outcome.NEEDS_JACOBIAN:
            self.find_jacobian()
            outcome = self._code.step(self.record, end)
        self.settle()
        return self._place("found", self.record.found) if outcome is Outcome.TAKEN else None

    def advance(self, rows: SampleRows, budget: int) -> Outcome:
        """Take about so many steps and write samples; find Jacobians as they are needed."""
        record = self.record
        record.xs, record.zs, record.ys = (
            item.ctypes.data for item in (rows.states, rows.unknowns, rows.outputs)
        )
        record.room, record.budget = len(rows.states), budget
        record.blind_until = self.task.watch.blind_until
        outcome = self._code.advance(record)
        while outcome is Outcome.NEEDS_JACOBIAN:
            self.find_jacobian()
            outcome = self._code.advance(record)
        return outcome

    def settle(self) -> None:
        """Add what was counted to the account of the task."""
        counts, task = self.ledger.counts, self.task
        for item in (Count.EVALUATIONS, Count.ITERATIONS):
            task.ledger.counts[item] += counts[item]
        largest = self.ledger.figures[Figure.LARGEST_RESIDUAL]
        figures = task.ledger.figures
        figures[Figure.LARGEST_RESIDUAL] = max(figures[Figure.LARGEST_RESIDUAL], largest)
        if counts[Count.STEPS]:
            task.count_steps(int(counts[Count.STEPS]), self.record.least)
            task.count_steps(0, self.record.most)
        counts[: Count.WHERE] = 0
        self.record.least, self.record.most = np.inf, 0.0

    def _laid_out(self, engine: CompiledEngine) -> RunRecord:
        """Return the record of a run that has not begun."""
        task, layout, w = self.task, self._layout, self._weights
        kernel, record = task.kernel, RunRecord()
        e, n = kernel.equations, len(layout.rows)
        for name in ("solve", "outputs", "events", "survey"):
            setattr(record, name, engine.address(f"vd_{name}"))
        record.rates_at = engine.address("vd_rates")
        n_states, n_blocks = len(e.states), len(e.blocks)
        room = max(layout.work, len(e.events), 2 * n_blocks, 1)
        directions = [event.direction for event in e.events]
        self._hold(
            record,
            constants=kernel.constants,
            tolerances=np.array([block.tolerance for block in e.blocks], dtype=float),
            rows=np.array(layout.rows, dtype=np.intc),
            positions=np.array(layout.positions, dtype=np.intc),
            velocities=np.array(layout.velocities, dtype=np.intc),
            pairs=np.array(layout.pairs, dtype=np.intc),
            rising=np.array([d != "falling" for d in directions], dtype=np.intc),
            falling=np.array([d != "rising" for d in directions], dtype=np.intc),
            sides=task.watch.sides,
            work=np.zeros(room),
            figures=self.ledger.figures,
            counts=self.ledger.counts,
        )
        sizes = {"x": n_states, "z": len(e.unknowns), "rates": layout.rates, "auxiliary": n}
        sizes |= {"change": n, "drift": len(e.unknowns), "forces": layout.forces}
        for name, place in (("at", record.at), ("found", record.found)):
            for part, size in sizes.items():
                array = self._arrays[f"{name}.{part}"] = np.zeros(max(1, size))[:size]
                setattr(place, part, array.ctypes.data)
        record.n_states, record.n_unknowns, record.n_outputs = (
            len(items) for items in (e.states, e.unknowns, e.channels)
        )
        record.n_blocks, record.n_events = n_blocks, len(e.events)
        record.n_rows, record.n_pairs = n, len(layout.pairs)
        record.n_rates, record.n_watched = layout.rates, layout.watched
        record.matrix[0].is_stale, record.matrix[0].has_jacobian = 1, NO_JACOBIAN
        record.alpha_m, record.alpha_f, record.beta = w.alpha_m, w.alpha_f, w.beta
        record.second_order_gamma, record.first_order_gamma = w.gamma, w.first_order_gamma
        record.share = w.share
        record.start, record.interval = task.start, task.interval
        record.least, record.most = np.inf, 0.0
        return record

    def _hold(self, record: ctypes.Structure, **arrays: NDArray[Any]) -> None:
        """Give the record the addresses of arrays, and keep these alive."""
        for name, array in arrays.items():
            self._arrays[name] = array
            setattr(record, name, array.ctypes.data)


class CompiledSteps(CompiledLoop[ReducedPlace]):
    """Takes steps on rates as ``ReducedSteps`` does, many of them in one call.

    The compiled code finds the Jacobian itself, by differences of the rates; where these are no
    finite numbers it asks for exact derivatives.
    """

    def __init__(
        self, task: Task, engine: CompiledEngine, weights: Weights, code: NewmarkCode
    ) -> None:
        """Lay out a run of the task, whose kernel has this engine."""
        self._form = form = ReducedForm(task.kernel, weights)
        super().__init__(task, engine, weights, code)
        pattern = self._pattern = matrix_pattern(task.kernel)
        self._hold(self.record, new_mass=form.new_mass, gamma=form.gamma)
        self._hold(self.record, **matrix_storage(pattern, np.zeros))
        enter_pattern(self.record, pattern)

    @property
    def _layout(self) -> StateLayout:
        form, n = self._form, len(self._form.rows)
        e = self.task.kernel.equations
        places = form.rows, form.positions, form.velocities, form.pairs
        work = 5 * n + 3 * len(e.states) + 2 * len(e.unknowns)
        return StateLayout(*places, n, len(e.states), 0, work)

    def start(self, point: ConsistentPoint) -> ReducedPlace:
        """Return the place from which the motion starts, or starts anew."""
        self.record.matrix[0].is_stale = 1
        return self._form.start(point, self.task.ledger)

    def resumed(self, point: ConsistentPoint, numbers: Vector) -> ReducedPlace:
        """Return the place from which a run goes on, see :meth:`ReducedForm.resumed`."""
        return self._form.resumed(point, numbers, self.task.ledger)

    def carried(self, place: ReducedPlace) -> MethodState:
        """Return what a run goes on with behind a place."""
        return MethodState(self._form.numbers(place))

    def error(self, before: ReducedPlace, after: ReducedPlace) -> float:
        """Return the largest local error of a step about; the compiled loop finds its own."""
        return self._form.error(before, after)

    def go_to(self, place: ReducedPlace) -> None:
        """Let the run go on from a place."""
        at, arrays = self.record.at, self._arrays
        at.time[0], at.size[0] = place.point.time, place.size
        arrays["at.x"][:], arrays["at.z"][:] = place.point.state, place.point.unknowns
        arrays["at.rates"][:], arrays["at.auxiliary"][:] = place.rates, place.auxiliary
        arrays["at.change"][:] = 0.0 if place.change is None else place.change
        arrays["at.drift"][:] = 0.0 if place.drift is None else place.drift

    def find_jacobian(self) -> None:
        """Find exact derivatives at the place that the run has reached."""
        pattern, own = self._pattern, self.record.matrix[0]
        found = self._form.jacobian(self.place.point)
        self._arrays["jacobian"][0] = found[pattern.rows, pattern.columns]
        own.is_stale, own.has_jacobian, own.size = 0, FRESH_JACOBIAN, 0.0
        own.fewest = own.wasted = 0

    def _place(self, name: str, at: PlaceRecord) -> ReducedPlace:
        x, z, rates, auxiliary, change, drift = (
            self._arrays[f"{name}.{part}"].copy()
            for part in ("x", "z", "rates", "auxiliary", "change", "drift")
        )
        known = (change, drift) if at.size[0] else (None, None)
        return ReducedPlace(ConsistentPoint(at.time[0], x, z), rates, auxiliary, at.size[0], *known)
