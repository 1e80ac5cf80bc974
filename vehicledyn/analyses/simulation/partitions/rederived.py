"""Equations derived anew in the middle of a run, and the state of the run in their terms."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.simulation.partitions.singularity_crossing import Sample
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import Backend, compile_kernel
from vehicledyn.symbolic.equations import Equations

if TYPE_CHECKING:
    from vehicledyn.multibody.model.system import ConstraintMethod, System

Vector = NDArray[np.float64]


def derived_at(
    system: System,
    kernel: Kernel,
    sample: Sample,
    *,
    first: Equations,
    method: ConstraintMethod,
    interpreted: bool,
) -> Kernel:
    """Return a kernel of the equations with the configuration of a sample as the start.

    Parameters
    ----------
    system, kernel, sample
        The system, the kernel that runs it, and where it is.
    first
        The equations that the run began with, whose states are further states of parts too.
    method
        How the constraints are treated from now on; the partition is chosen anew.
    interpreted
        Whether the equations are not compiled.

    Raises
    ------
    InputError
        If the constraints cannot be treated in this way.
    """
    from vehicledyn.multibody.equations.derivation import derive
    from vehicledyn.multibody.loops.loop_closure import AssemblyState
    from vehicledyn.multibody.loops.partition_monitor import freed

    values, parameters = values_of(kernel, sample), kernel.parameters
    changed = replace(freed(system, values, parameters), constraint_method=method)
    states = {s.name: values[s.name] for s in first.states if s.name in values}
    equations = derive(changed, moment=AssemblyState(sample.time, states))
    # Multipliers of many entangled constraints are solved sparsely, which cannot be compiled.
    backend: Backend = "interpreted" if interpreted else "auto"
    return compile_kernel(equations, backend=backend, evaluations=math.inf)


def state_in(new: Kernel, old: Kernel, sample: Sample) -> tuple[Vector, Vector]:
    """Return states and a guess of the unknowns of a new kernel at a sample of the old one."""
    pairs: list[Any] = [
        *zip(old.equations.states, sample.state, strict=True),
        *zip(old.equations.unknowns, sample.unknowns, strict=True),
    ]
    known = {**values_of(old, sample), **{item.name: float(value) for item, value in pairs}}
    state = np.array([known[s.name] for s in new.equations.states])
    return state, np.array([known[u.name] for u in new.equations.unknowns])


def values_of(kernel: Kernel, sample: Sample) -> dict[str, float]:
    """Return the channels of a sample by name."""
    names = (c.name for c in kernel.equations.channels)
    return dict(zip(names, map(float, sample.outputs), strict=True))
