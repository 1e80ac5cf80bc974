"""Equations derived anew in the middle of a run, and the state of the run in their terms."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.simulation.partitions.singularity_crossing import Sample
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import Backend, compile_kernel
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.symbolic.equations import Equations

if TYPE_CHECKING:
    from vehicledyn.multibody.model.system import ConstraintMethod, System

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Origin:
    """Where equations are derived anew: the same place leads to the same equations, to the bit.

    ``values`` are those of :func:`names_at_origin` at a ``time`` [s], not a number where there are
    none. ``interpreted`` says whether the equations are not compiled.
    """

    time: float
    values: Vector
    interpreted: bool

    @classmethod
    def at(
        cls, system: System, kernel: Kernel, sample: Sample, first: Equations, *, interpreted: bool
    ) -> Origin:
        """Return it at a sample of a kernel; ``first`` are the equations that the run began with.

        Their states are further states of parts too.
        """
        known = values_of(kernel, sample)
        values = [known.get(name, math.nan) for name in names_at_origin(system, first)]
        return cls(sample.time, np.array(values), interpreted)


def names_at_origin(system: System, first: Equations) -> list[str]:
    """Return the names of what equations are derived anew from: coordinates, rates and states."""
    joints = [j for body in system.bodies for j in body.joints if isinstance(j, Joint)]
    places = [name for joint in joints for name in (joint.name, joint.rate_name)]
    return list(dict.fromkeys([*places, *(s.name for s in first.states)]))


def derived_from(
    origin: Origin,
    system: System,
    parameters: Vector,
    first: Equations,
    method: ConstraintMethod,
) -> Kernel:
    """Return a kernel of the equations with the configuration at an origin as the start.

    Parameters
    ----------
    origin
        Where the system is.
    system, parameters
        The system and the values of its parameters, shape (n_parameters,).
    first
        The equations that the run began with.
    method
        How the constraints are treated from now on; the partition is chosen anew.

    Raises
    ------
    InputError
        If the constraints cannot be treated in this way.
    """
    from vehicledyn.multibody.equations.derivation import derive
    from vehicledyn.multibody.loops.loop_closure import AssemblyState
    from vehicledyn.multibody.loops.partition_monitor import freed

    pairs = zip(names_at_origin(system, first), origin.values.tolist(), strict=True)
    values = {name: value for name, value in pairs if not math.isnan(value)}
    changed = replace(freed(system, values, parameters), constraint_method=method)
    states = {s.name: values[s.name] for s in first.states if s.name in values}
    equations = derive(changed, moment=AssemblyState(origin.time, states))
    # Multipliers of many entangled constraints are solved sparsely, which cannot be compiled.
    backend: Backend = "interpreted" if origin.interpreted else "auto"
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
