"""A system with its equations and kernel; what analyses further need of it is made on demand."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.error_locations import errors_with_locations
from vehicledyn.analyses.preparation.runnable import Subject, index_of
from vehicledyn.base.errors import InputError
from vehicledyn.base.interrupts import undisturbed
from vehicledyn.files.scenario.target import Target
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import Backend, compile_kernel
from vehicledyn.symbolic.equations import Equations

if TYPE_CHECKING:
    from vehicledyn.kernel.derivatives import Derivatives, Slopes
    from vehicledyn.multibody.equations.derivation import Derivation
    from vehicledyn.multibody.equations.singular_mass import Resistance
    from vehicledyn.multibody.loops.partition_monitor import PartitionMonitor

Vector = NDArray[np.float64]
Progress = Callable[[str, float | None], None]


@dataclass
class Derived:
    """The derivation of a target, made when it is first asked for.

    ``key`` names the model among those that are remembered, empty where it is not;
    ``remembered`` are its equations from there.
    """

    target: Target
    subject: Subject
    key: str = ""
    remembered: Equations | None = None

    @cached_property
    def derivation(self) -> Derivation:
        """The system solved for its accelerations."""
        from vehicledyn.multibody.equations.derivation import solve_motion

        with undisturbed(), errors_with_locations(self.target):
            return solve_motion(self.subject.system, apart=True)

    @cached_property
    def equations(self) -> Equations:
        """Its equations, as they are remembered or derived."""
        return self.remembered or self.derived_equations

    @cached_property
    def derived_equations(self) -> Equations:
        """Its equations, derived."""
        from vehicledyn.multibody.equations.derivation import equations_of

        with undisturbed(), errors_with_locations(self.target):
            return equations_of(self.derivation)


Check = Callable[[Derived], object]
"""Refuses what cannot be done with something derived; asking for its equations derives them."""


@dataclass
class Prepared:
    """A subject with its equations and kernel; the rest is made when first needed.

    ``look`` is what pictures show, see
    :func:`vehicledyn.multibody.equations.system_shapes.appearance`.
    """

    subject: Subject
    equations: Equations
    kernel: Kernel
    derived: Derived
    _derivatives: list[Derivatives] = field(default_factory=list)
    _slopes: list[Derivatives] = field(default_factory=list)
    _partitioned: list[Prepared] = field(default_factory=list)
    look: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def watch(self) -> PartitionMonitor:
        """Compares partitions of the coordinates."""
        from vehicledyn.multibody.loops.partition_monitor import PartitionMonitor, bound_to

        derivation = self.derived.derivation
        joints = derivation.symbols.joints
        return PartitionMonitor(joints, derivation.loops.gaps, bound_to(derivation.system))

    @property
    def resistance(self) -> Resistance:
        """Says which motions have inertia."""
        return self.derived.derivation.resistance

    @property
    def derivatives(self) -> Derivatives:
        """Exact Jacobians of the equations."""
        from vehicledyn.kernel.derivatives import Derivatives

        refuse_multipliers(self.equations)
        if not self._derivatives:
            self._derivatives.append(Derivatives(self.equations))
        return self._derivatives[0]

    @property
    def slopes(self) -> Slopes:
        """Exact Jacobians of rates and unknowns; those of the outputs too where they are made."""
        from vehicledyn.kernel.derivatives import Derivatives

        refuse_multipliers(self.equations)
        found = self._derivatives or self._slopes
        if not found:
            found.append(Derivatives(self.equations, outputs=False))
        return found[0]

    def with_derivatives(self, derivatives: Derivatives) -> Prepared:
        """Return the same with Jacobians that were made before."""
        return replace(self, _derivatives=[derivatives])

    @property
    def has_multipliers(self) -> bool:
        """Whether all coordinates are states, which are not independent of each other."""
        return self.equations.structure.get("constraint_method") == "multipliers"

    @property
    def partitioned(self) -> Prepared:
        """The same system with independent coordinates as states."""
        if not self.has_multipliers:
            return self
        if not self._partitioned:
            derived = Derived(self.derived.target, by_partitioning(self.subject))
            backend: Backend = "compiled" if self.kernel.backend == "compiled" else "interpreted"
            kernel = compile_kernel(derived.equations, backend=backend)
            self._partitioned.append(Prepared(derived.subject, derived.equations, kernel, derived))
        found = self._partitioned[0]
        values = dict(named(self.equations.parameters, self.kernel.parameters))
        known = named(found.equations.parameters, found.kernel.parameters)
        parameters = np.array([values.get(name, value) for name, value in known])
        kernel = found.kernel.with_parameters(parameters)
        return replace(found, subject=by_partitioning(self.subject), kernel=kernel)

    def index(self, state: str) -> int:
        """Return the index of a state by name."""
        return index_of(self.equations, state)


def refuse_multipliers(equations: Equations) -> None:
    """Raise InputError where all coordinates are states, which are not free to be varied."""
    if equations.structure.get("constraint_method") == "multipliers":
        raise InputError(
            f"the constraints of '{equations.name}' are treated with multipliers, which serve runs "
            "only; linear analyses need independent coordinates: give the system "
            "'constraint_method: partitioning'"
        )


def by_partitioning(subject: Subject) -> Subject:
    """Return a subject whose constraints are treated by partitioning its coordinates."""
    return subject.with_system(replace(subject.system, constraint_method="partitioning"))


def named(items: Iterable[Any], values: Vector) -> list[tuple[str, float]]:
    """Return values with the names of what they belong to."""
    return [(item.name, float(value)) for item, value in zip(items, values, strict=True)]
