"""Prepare a run: derived, compiled and at its start, or as it was remembered from last time."""

from __future__ import annotations

import math

import numpy as np

from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.error_locations import errors_with_locations
from vehicledyn.analyses.preparation.mass_checks import refuse_idle_start, refuse_rigid_loops
from vehicledyn.analyses.preparation.memory.remembered import recorded_warnings
from vehicledyn.analyses.preparation.memory.run_cache import Memory, key_of_run, recall, remember
from vehicledyn.analyses.preparation.prepare import AssembledPoint, prepare, start_point
from vehicledyn.analyses.preparation.prepared import Check, Derived, Prepared, Progress
from vehicledyn.analyses.simulation.animation_recorder import look_of
from vehicledyn.analyses.simulation.open_contacts import refuse_open_contacts
from vehicledyn.analyses.simulation.sunk_wheels import refuse_sunk_wheels
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.kernel.make_kernel import Backend, known_kernel
from vehicledyn.symbolic.cached_equations import equations_from, facts_of


def prepare_run(
    loaded: LoadedScenario, *, backend: Backend, progress: Progress, check: Check | None = None
) -> tuple[Prepared, AssembledPoint]:
    """Return what a scenario runs and the point it starts from.

    Where both are remembered, nothing is derived until something is asked for that only the
    derivation knows. Compiled runs that gave no warning are remembered. ``check`` is that of
    :func:`~vehicledyn.analyses.preparation.prepare.prepare`, which what is remembered does without.
    """
    key = None if backend == "interpreted" else key_of_run(loaded)
    memory = None if key is None else recall(key)
    found = None if memory is None else _from_memory(loaded, memory)
    if found is not None:
        return found
    with recorded_warnings() as warnings:
        prepared = prepare(
            loaded,
            backend=backend,
            progress=progress,
            check=check,
            evaluations=expected_evaluations(loaded),
        )
        progress("finding the point to start from", None)
        with errors_with_locations(loaded):
            refuse_rigid_loops(prepared)
            start = start_point(prepared, loaded.scenario.speed or 0.0, loaded.scenario.start)
            refuse_idle_start(prepared, 0.0, start.state, start.unknowns)
            refuse_sunk_wheels(prepared, start)
            refuse_open_contacts(prepared, start)
    prepared.look = look_of(prepared)
    if key is not None and prepared.kernel.key and not warnings:
        remember(key, _memory_of(prepared, start))
    return prepared, start


_STAGES = 4
"""Evaluations of a step of a usual method."""


def expected_evaluations(loaded: LoadedScenario) -> float:
    """Return about how many evaluations of the rates a run takes; infinite where nobody knows."""
    duration = loaded.scenario.duration
    step = getattr(loaded.scenario.solver, "step", None)
    if duration is None or step is None:
        return math.inf
    return _STAGES * float(duration) / float(step)


def _from_memory(loaded: LoadedScenario, memory: Memory) -> tuple[Prepared, AssembledPoint] | None:
    derived = Derived(loaded, build_subject(loaded))
    equations = equations_from(memory.facts, lambda: derived.equations)
    kernel = known_kernel(equations, memory.kernel)
    if kernel is None:
        return None
    kernel.set_parameters(memory.parameters)
    vectors = np.array(memory.state), np.array(memory.unknowns)
    start = AssembledPoint(*vectors, memory.residual, memory.remark)
    return Prepared(derived.subject, equations, kernel, derived, look=memory.look), start


def _memory_of(prepared: Prepared, start: AssembledPoint) -> Memory:
    return Memory(
        facts_of(prepared.equations),
        prepared.kernel.key,
        start.state.tolist(),
        start.unknowns.tolist(),
        float(start.residual),
        start.remark,
        prepared.kernel.parameters.tolist(),
        prepared.look,
    )
