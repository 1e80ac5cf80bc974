"""Find an optimal manoeuvre on finer and finer meshes, and check it by simulation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimal_control.path_curves import PathCurves
from vehicledyn.analyse.optimal_control.rounding import solve_by_rounding
from vehicledyn.analyse.optimal_control.shortened import solve_by_shortening
from vehicledyn.analyse.optimal_control.simulated import (
    ControlledRun,
    relative_errors,
    state_ranges,
)
from vehicledyn.analyse.optimal_control.solve import (
    FEASIBLE,
    KEPT,
    Settings,
    Solution,
    solve_on_mesh,
)
from vehicledyn.analyse.optimal_control.trajectory import DEGREE, Trajectory, radau_points
from vehicledyn.analyse.optimal_control.transcription import PointModel
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.preparation.target_digest import digests_to_keep
from vehicledyn.base.step_memory import Memory
from vehicledyn.base.units import shown
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.manoeuvre_table import ManoeuvreTable
from vehicledyn.studies.manoeuvre_optimisation.advice import slip_advice
from vehicledyn.studies.manoeuvre_optimisation.file import ManoeuvreStudy
from vehicledyn.studies.manoeuvre_optimisation.guess import first_guess, state_scales
from vehicledyn.studies.manoeuvre_optimisation.model import PreparedManoeuvre, prepare_manoeuvre
from vehicledyn.symbolic.equations import Channel

Floats = NDArray[np.float64]

_STEPS, _LONGEST_STEP = 2000, 5e-3
"""Steps of the check's simulation at least, and its longest step [s], where none is given."""

_MOST_PARTS = 4
"""Parts into which a refinement cuts an interval at most."""

_STRAIGHT = 40
"""Iterations of the first search of a model with corners; where these do not do, others help."""

_WARM_BARRIER = 1e-4
"""Parameter of the barrier to begin with where a motion is nearly an optimum already."""

_TOO_FAR = 0.01
"""Part of a state's range by which the simulation may miss the optimum before it is warned of."""


@dataclass(frozen=True)
class ManoeuvreReport:
    """An optimal manoeuvre for people and programs."""

    table: ManoeuvreTable

    @property
    def messages(self) -> tuple[str, ...]:
        """Remarks."""
        return self.table.notes

    def as_text(self) -> str:
        """Return duration, objective, extremes of the controls and how far the check agrees."""
        table = self.table
        lines = [f"{table.title}: {table.message or 'optimal'}"]
        lines.append(f"  duration {shown(table.duration, 's')}, objective {table.objective:.6g}")
        count = f"{len(table.history)} iterations on {len(table.mesh_errors)} meshes"
        lines.append(f"  {count}, the last of {table.n_intervals} intervals")
        for item, values in zip(table.controls, np.asarray(table.control_values).T, strict=True):
            low, high = (shown(float(v), item.unit) for v in (values.min(), values.max()))
            lines.append(f"  {item.name}: {low} to {high}")
        if table.is_checked:
            worst = table.states[int(np.argmax(table.state_errors))].name if table.states else ""
            lines.append(f"  simulated under these controls it {table.check} ({worst})")
        return "\n".join([*lines, *table.notes])

    def as_dict(self) -> dict[str, Any]:
        """Return everything but the curves as plain data, in SI."""
        table = self.table
        ends = zip(table.states, table.state_values[-1], strict=True)
        return {
            "title": table.title,
            "status": table.status,
            "message": table.message,
            "duration": table.duration,
            "objective": table.objective,
            "violation": table.violation,
            "iterations": len(table.history),
            "intervals": table.n_intervals,
            "simulation_error": table.simulation_error,
            "mesh_errors": np.asarray(table.mesh_errors).tolist(),
            "final": {item.name: float(value) for item, value in ends},
            "notes": list(table.notes),
        }


def run_manoeuvre(study: ManoeuvreStudy, *, kept: KeptWork, progress: Progress) -> ManoeuvreReport:
    """Return the optimal manoeuvre of a study; its status is "failed" where none was found.

    Parameters
    ----------
    study
        The validated study.
    kept
        What is kept while it is searched for: where each search on a mesh ended.
    progress
        Called with what is going on.

    Raises
    ------
    InputError
        If the study means nothing in its model, or what was kept is of another study.
    NumericalError
        If the model has no start.
    """
    manoeuvre = prepare_manoeuvre(study, progress)
    facts = "optimise-manoeuvre", study.text, study.track, digests_to_keep(kept, [study.target])
    memory = kept.memory(*facts, kinds=KEPT)
    start, trouble = memory.recall("guess", None, lambda: first_guess(manoeuvre))
    search = _Search(manoeuvre, state_scales(start), memory, progress)
    notes = [trouble] if trouble else []
    solution = search.run(start)
    return ManoeuvreReport(search.table(solution, [*notes, *search.notes]))


def _parts(errors: Floats, accuracy: float) -> NDArray[np.int64]:
    """Return into how many parts to cut intervals with errors, so that each is accurate.

    As for errors of second order in the length, which is what they are where a law has a corner.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        counts = np.ceil(np.sqrt(errors / accuracy))
    counts = np.where(np.isfinite(counts), counts, np.inf)
    return np.clip(counts, 1.0, _MOST_PARTS).astype(np.int64)


class _Search:
    """A search over meshes, with what is recorded of it."""

    def __init__(
        self,
        manoeuvre: PreparedManoeuvre,
        scales: Floats,
        memory: Memory,
        progress: Progress,
    ) -> None:
        self.manoeuvre, self.scales = manoeuvre, scales
        self.memory, self.progress = memory, progress
        self.history: list[tuple[float, float]] = []
        self.mesh_errors: list[float] = []
        self.notes: list[str] = []
        self.best: Solution | None = None
        self.is_rounding = False
        self.units = [s.unit for s in manoeuvre.problem.equations.states]

    def run(self, guess: Trajectory) -> Solution:
        """Return the solution on the last mesh, or the first that failed."""
        study, problem = self.manoeuvre.study, self.manoeuvre.problem
        self.progress("deriving the functions of a point", None)
        model = PointModel(problem)
        for level in range(study.refinements + 1):
            self.progress(f"optimising on {guess.n_intervals} intervals", None)
            settings = Settings(
                self.scales,
                study.tolerance,
                study.most_iterations,
                self._watch,
                _WARM_BARRIER if level else None,
                memory=self.memory,
            )
            known, self.best = self.best, None
            solution = self._solved(model, guess, settings)
            if solution.failure:
                return self._kept(solution, known)
            self.best = solution
            if solution.gap is not None:
                self.notes.append(
                    f"on {guess.n_intervals} intervals the search circled with its objective still "
                    "to 1e-6, as where friction sticks and slips by turns; by bounds that do not "
                    f"act yet it may be {solution.gap / abs(solution.objective):.1g} of itself "
                    "from its least"
                )
            if solution.width:
                self.notes.append(
                    f"on {guess.n_intervals} intervals the corners of the model's laws, as of dry "
                    f"friction that breaks away, are rounded by {solution.width:g} of what meets "
                    "there: with sharp ones the search did not end; the simulation has sharp ones"
                )
            errors = self._interval_errors(solution.trajectory)
            self.mesh_errors.append(float(errors.max(initial=0.0)))
            if (errors <= study.accuracy).all() or level == study.refinements:
                break
            counts = _parts(errors, study.accuracy)
            guess = solution.trajectory.refined(problem.controls, counts)
        return solution

    def _kept(self, solution: Solution, known: Solution | None) -> Solution:
        """Return what is best where a search failed: the optimum of the mesh before, if any.

        Else the best motion that keeps all conditions, as failed as the search.
        """
        if known is not None:
            self.notes.append(
                f"warning: on {solution.trajectory.n_intervals} intervals no optimum was found "
                f"({solution.failure}); this is that on {known.trajectory.n_intervals} intervals"
            )
            return known
        if self.best is None:
            return solution
        return replace(self.best, failure=solution.failure, iterations=solution.iterations)

    def _solved(self, model: PointModel, guess: Trajectory, settings: Settings) -> Solution:
        """Return the optimum on a mesh; where the search fails, other ways to it are tried.

        Rounded corners are made sharp; a quickest motion is approached from slow ones.
        """
        if self.is_rounding:
            return self._rounded(model, guess, settings, is_near=True)
        straight = settings
        if model.has_corners:
            straight = replace(settings, most_iterations=min(_STRAIGHT, settings.most_iterations))
        solution = solve_on_mesh(model, guess, straight)
        if not solution.failure:
            return solution
        failed = f"on {guess.n_intervals} intervals the search from the first motion failed"
        failed += f" ({solution.failure})"
        if model.has_corners:
            self.notes.append(f"{failed}; corners were rounded at first and then made sharp again")
            rounded = self._rounded(model, guess, settings, is_near=settings.barrier is not None)
            if not rounded.failure:
                return rounded
            failed = f"the search with rounded corners failed ({rounded.failure})"
        if model.is_quickest:
            self.notes.append(f"{failed}; it went on from that by shortening it little by little")
            self.progress("shortening the motion little by little", None)
            return solve_by_shortening(model, solution.trajectory, guess, settings)
        if straight is not settings:
            self.notes.append(f"{failed}; the search from the first motion went on")
            return solve_on_mesh(model, solution.trajectory, settings)
        return solution

    def _rounded(
        self, model: PointModel, guess: Trajectory, settings: Settings, *, is_near: bool
    ) -> Solution:
        """Return the optimum found with rounded corners."""
        self.progress("rounding corners of the model's laws", None)
        on_the_way = replace(settings, watch=self._look)
        found = solve_by_rounding(model, guess, settings, on_the_way, is_near=is_near)
        self.is_rounding = self.is_rounding or not found.failure
        return found

    def _watch(self, number: int, objective: float, violation: float, at: Any) -> None:
        """Look at an iteration, and keep the best motion that keeps all conditions."""
        self._look(number, objective, violation)
        if violation <= FEASIBLE and (self.best is None or objective < self.best.objective):
            self.best = Solution(at(), objective, number, violation, "")

    def _look(self, number: int, objective: float, violation: float, _: Any = None) -> None:
        self.history.append((objective, violation))
        self.progress(
            f"iteration {number}: objective {objective:.6g}, off by {violation:.1e}", None
        )

    def _run_of(self, trajectory: Trajectory) -> ControlledRun:
        kernel, step = self.manoeuvre.prepared.kernel, self._step(trajectory)
        return ControlledRun(self.manoeuvre.problem, kernel, trajectory, step)

    def _step(self, trajectory: Trajectory) -> float:
        """Return the step of simulations: given, that of the scenario, or a small part [s]."""
        if self.manoeuvre.study.step is not None:
            return self.manoeuvre.study.step
        choices = self.manoeuvre.study.target.choices
        own = None if choices is None else getattr(choices.solver, "step", None)
        return float(own or min(trajectory.duration / _STEPS, _LONGEST_STEP))

    def _interval_errors(self, trajectory: Trajectory) -> Floats:
        """Return the error of each interval over the range of the states, shape (n,)."""
        run = self._run_of(trajectory)
        defects = np.abs(self.memory.recall("defects", trajectory, run.defects))
        ranges = state_ranges(trajectory.all_states, self.units)
        return np.asarray((defects / ranges).max(axis=1, initial=0.0))

    def table(self, solution: Solution, notes: list[str]) -> ManoeuvreTable:
        """Return all that was found, with the check by simulation."""
        trajectory, problem = solution.trajectory, self.manoeuvre.problem
        states, e = trajectory.all_states, problem.equations
        simulated = np.full_like(states, np.nan)
        is_kept = solution.violation <= FEASIBLE
        if is_kept:
            self.progress("simulating the controls", None)
            simulated = self.memory.recall("free", trajectory, self._run_of(trajectory).free)
        errors = relative_errors(states, simulated, self.units)
        error = float(errors.max(initial=0.0))
        if not np.isfinite(error) and is_kept:
            notes.append("warning: the simulation under the optimal controls failed")
        elif error > _TOO_FAR and is_kept:
            notes.append(
                f"warning: the simulation under the optimal controls misses the motion by "
                f"{100.0 * error:.2g} % of a state's range; refine the mesh, or the motion is "
                "unstable without feedback"
            )
        study, shown_channels = self.manoeuvre.study, self._channels(trajectory)
        if solution.failure:
            error_now = self.mesh_errors[-1] if self.mesh_errors else np.nan
            self.mesh_errors.append(error_now)
            notes += slip_advice(*shown_channels, study.limits)
        elif self.mesh_errors and self.mesh_errors[-1] > study.accuracy:
            notes.append(
                f"warning: an interval misses its end by {self.mesh_errors[-1]:.2g} of a state's "
                f"range where {study.accuracy:g} is asked for; allow more refinements or intervals"
            )
        return ManoeuvreTable(
            study.title,
            e.name,
            "failed" if solution.failure else "ok",
            solution.failure,
            solution.objective,
            trajectory.duration,
            solution.violation,
            error,
            trajectory.n_intervals,
            trajectory.times,
            tuple(_about(item) for item in e.states),
            states,
            simulated,
            errors,
            tuple(Quantity(c.name, c.unit, "Control") for c in problem.controls),
            self._controls(trajectory),
            *shown_channels,
            self._path(trajectory),
            np.array(self.history).reshape(-1, 2),
            np.array(self.mesh_errors),
            tuple(notes),
        )

    def _controls(self, trajectory: Trajectory) -> Floats:
        controls = self.manoeuvre.problem.controls
        rows = [trajectory.control(controls, 0, 0.0)[0]]
        rows += [
            trajectory.control(controls, k, part)[0]
            for k in range(trajectory.n_intervals)
            for part in radau_points()
        ]
        return np.array(rows).reshape(len(rows), len(controls))

    def _channels(self, trajectory: Trajectory) -> tuple[tuple[Quantity, ...], Floats]:
        """Return the channels of the motion that are finite, over time."""
        problem = self.manoeuvre.problem
        kernel = self.manoeuvre.prepared.kernel.with_parameters(problem.parameters)
        states, rows = trajectory.all_states, []
        unknowns = (
            trajectory.unknowns.reshape(trajectory.n_intervals * DEGREE, -1)
            if trajectory.unknowns.size
            else np.zeros((len(states) - 1, 0))
        )
        first = [(0, 0.0)]
        places = first + [(k, p) for k in range(trajectory.n_intervals) for p in radau_points()]
        for row, ((k, part), time) in enumerate(zip(places, trajectory.times, strict=True)):
            values = trajectory.control(problem.controls, k, part)
            kernel.set_parameters(problem.parameters_with(values))
            rows.append(kernel.outputs(time, states[row], unknowns[max(row - 1, 0)]))
        table = np.array(rows).reshape(len(rows), -1)
        channels: tuple[Channel, ...] = problem.equations.channels
        states_of = {s.name for s in problem.equations.states}
        kept = [
            k
            for k, c in enumerate(channels)
            if c.name not in states_of and np.isfinite(table[:, k]).all()
        ]
        return tuple(_about(channels[k]) for k in kept), table[:, kept]

    def _path(self, trajectory: Trajectory) -> Floats:
        path = self.manoeuvre.problem.path
        if path is None:
            return np.zeros((1 + trajectory.n_intervals * DEGREE, 0))
        curves, s = PathCurves(path), trajectory.all_distances
        _, offset = curves.seen(s, *(trajectory.all_states[:, k] for k in path.place))
        right, left = curves.sides(s)
        return np.column_stack([s, offset, -right, left])


def _about(item: Any) -> Quantity:
    return Quantity(item.name, item.unit, item.description)
