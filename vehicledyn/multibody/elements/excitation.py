"""Parts through which small signals enter a system: moved coordinates, forces, wrenches.

A signal is three symbols, u, u̇ and ü, that are parameters of value zero. Derivatives by them
are those by an input and its rates, so that a moved coordinate brings the terms s and s² of its
transfer function with it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from vehicledyn.base.shapes import Shape
from vehicledyn.multibody.model.bodies import Body
from vehicledyn.multibody.model.constraints import Constraint
from vehicledyn.multibody.model.cuts import Cut
from vehicledyn.multibody.model.parts import (
    BasePart,
    Clock,
    DrivenMotion,
    Loads,
    Output,
    Part,
    PartEvent,
    Situation,
)
from vehicledyn.symbolic.equations import Variable
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.parameters import ParameterTable


@dataclass(frozen=True)
class SmallInput:
    """A small input u with its rates, and the names of the parameters that stand for them."""

    names: tuple[str, str, str]
    value: Scalar
    rate: Scalar
    acceleration: Scalar

    @classmethod
    def enter(cls, table: ParameterTable, name: str, unit: str) -> SmallInput:
        """Return a signal whose three symbols are new parameters, zero at the start."""
        names = (name, f"{name}.rate", f"{name}.acceleration")
        units = (unit, f"{unit}/s", f"{unit}/s^2")
        symbols = [
            table.add(n, 0.0, u, "Small input of a linearisation")
            for n, u in zip(names, units, strict=True)
        ]
        return cls(names, *symbols)


@dataclass(frozen=True)
class HeldDrive(BasePart):
    """Hold a driven coordinate at a position and move it by a signal."""

    coordinate: str
    position: Scalar
    signal: SmallInput

    def motions(self, clock: Clock) -> dict[str, DrivenMotion]:
        """Return position and rate."""
        return {self.coordinate: DrivenMotion(self.position + self.signal.value, self.signal.rate)}

    def loads(self, situation: Situation) -> Loads:
        """Return the acceleration."""
        return Loads(accelerations={self.coordinate: self.signal.acceleration})


@dataclass(frozen=True)
class MovedDrive:
    """A part that drives a coordinate, with a signal added to what it does."""

    inner: Part
    coordinate: str
    signal: SmallInput

    @property
    def name(self) -> str:
        """Name of the part."""
        return self.inner.name

    def added_bodies(self) -> tuple[Body, ...]:
        """Return the bodies of the part."""
        return self.inner.added_bodies()

    def added_cuts(self) -> tuple[Cut, ...]:
        """Return the cuts of the part."""
        return self.inner.added_cuts()

    def added_constraints(self) -> tuple[Constraint, ...]:
        """Return the constraints of the part."""
        return self.inner.added_constraints()

    def states(self) -> tuple[Variable, ...]:
        """Return the states of the part."""
        return self.inner.states()

    def unknowns(self) -> tuple[Variable, ...]:
        """Return the unknowns of the part."""
        return self.inner.unknowns()

    def reactions(self) -> tuple[Variable, ...]:
        """Return the reactions of the part."""
        return self.inner.reactions()

    def found_reactions(self, situation: Situation) -> tuple[Scalar, ...]:
        """Return what the part finds for them."""
        return self.inner.found_reactions(situation)

    def motions(self, clock: Clock) -> dict[str, DrivenMotion]:
        """Return the motions of the part, the coordinate's with the signal."""
        motions = dict(self.inner.motions(clock))
        own, signal = motions[self.coordinate], self.signal
        motions[self.coordinate] = DrivenMotion(
            own.position + signal.value, own.velocity + signal.rate
        )
        return motions

    def loads(self, situation: Situation) -> Loads:
        """Return the loads of the part, the coordinate's acceleration with the signal's."""
        loads = self.inner.loads(situation)
        own = loads.accelerations.get(self.coordinate, 0.0) + self.signal.acceleration
        return replace(loads, accelerations={**loads.accelerations, self.coordinate: own})

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the outputs of the part."""
        return self.inner.outputs(situation)

    def events(self, situation: Situation) -> tuple[PartEvent, ...]:
        """Return the events of the part."""
        return self.inner.events(situation)

    def shapes(self) -> tuple[Shape, ...]:
        """Return the shapes of the part."""
        return self.inner.shapes()


@dataclass(frozen=True)
class SmallLoad(BasePart):
    """A force or wrench that a signal stands for; it shows no channels of its own."""

    inner: Part

    def loads(self, situation: Situation) -> Loads:
        """Return the loads of the part within."""
        return self.inner.loads(situation)
