"""A system at the level of positions, as numbers: closed loops, channels at rest, their slopes."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.loops.configuration import LoopAssembly
from vehicledyn.multibody.loops.constraint_equations import Gaps, rows_of_system
from vehicledyn.multibody.loops.loop_closure import AssemblyState, guesses, start_values
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import ForcesUnknownError, Output, outputs_of
from vehicledyn.multibody.model.symbols import Symbols, declare, locked, motions
from vehicledyn.multibody.model.system import System, refuse_quaternions
from vehicledyn.multibody.model.tree import Tree, unfold
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CoordinateFacts:
    """A coordinate: name, unit, meaning, and whether it is "auto", "independent" and so on."""

    name: str
    unit: str
    description: str
    role: str


class Positions:
    """Loops and channels of a system as functions of all its coordinates, at time zero.

    Attributes
    ----------
    coordinates
        All coordinates, in the order of every array of them.
    written, start
        The start as it is written and as it is assembled, each of shape (n_coordinates,).
    channels
        Coordinates, and the channels of parts that depend on positions; what depends on rates
        too is shown at rest.
    speeds
        Channels that are linear in the rates: velocities of points and bodies.
    without_channels
        Names of the sensors that have no channels here, since they show forces.
    parameters
        Parameters of the system, in the order of derivatives by them.
    """

    def __init__(self, system: System, *, kept: Collection[str] = ()) -> None:
        """Assemble the loops of a system and prepare its channels.

        Parameters
        ----------
        system
            Bodies, joints and parts.
        kept
            Names of channels of parts that are wanted even if nothing moves them.

        Raises
        ------
        InputError
            If the system is not well formed.
        NumericalError
            If its loops cannot be assembled.
        """
        system.check()
        refuse_quaternions(
            system,
            "kinematics",
            "it follows paths of coordinates that may change one by one, and the four components "
            "are bound to each other",
        )
        tree, symbols = unfold(system.bodies), declare(system)
        motion = motions(system, symbols)
        self._gaps = Gaps(
            system, symbols, rows_of_system(system, symbols.kinematics(tree), symbols.time)
        )
        place = LoopAssembly(symbols.joints, self._gaps, 0.0, locked(system, symbols))
        moment = AssemblyState()
        self.written = start_values(system, symbols, motion, moment)
        self.start = place.assembled_by(self.written, guesses(system, symbols, moment.time))
        self.coordinates = tuple(
            CoordinateFacts(j.name, j.unit, j.description or j.name, j.role) for j in symbols.joints
        )
        seen = _Seen.of(system, tree, symbols, kept)
        self.channels, self.speeds = seen.channels, seen.speeds
        self.without_channels = seen.without_channels
        q = symbols.coordinate_column
        self._values = ops.numeric([q], seen.values)
        self._slopes = ops.numeric([q], ops.jacobian(seen.values, q))
        self._speed_slopes = ops.numeric([q], seen.speed_slopes)
        self._free, self._free_speeds = seen.free, seen.free_speeds
        self._known, self._coordinate_column = seen.known, q
        self.parameters = tuple(system.table.entries)
        self._moments = system, symbols, motion

    @property
    def cuts(self) -> list[str]:
        """Name of the cut or constraint of each row of the residual."""
        return self._gaps.cuts

    def residual(self, q: Array) -> Array:
        """Return the gaps of all loops, shape (n_gaps,)."""
        return self._gaps.residual(0.0, q)

    def jacobian(self, q: Array) -> Array:
        """Return the derivative of the gaps, shape (n_gaps, n_coordinates)."""
        return self._gaps.jacobian(0.0, q)[: self._gaps.holonomic]

    def values(self, q: Array) -> Array:
        """Return all channels, shape (n_channels,)."""
        return self._values(q)[:, 0]

    def slopes(self, q: Array) -> Array:
        """Return the derivatives of the channels, shape (n_channels, n_coordinates)."""
        return self._slopes(q)

    def residual_by_parameter(self, q: Array) -> Array:
        """Return the derivatives of the gaps by all parameters, (n_gaps, n_parameters)."""
        return self._gaps.by_parameter(0.0, q)

    def values_by_parameter(self, q: Array) -> Array:
        """Return the derivatives of the channels by all parameters, (n_channels, n_parameters)."""
        return self._parameter_slopes(q)

    @cached_property
    def _parameter_slopes(self) -> Callable[..., Array]:
        symbols = ops.column([entry.symbol for entry in self.parameters])
        slopes = ops.jacobian(self._free, symbols)
        return ops.numeric([self._coordinate_column], ops.substitute(slopes, *self._known))

    def slopes_along(self, q: Array, tangent: Array) -> tuple[Array, Array]:
        """Return how gaps, channels and speeds change along a tangent, differentiated once more.

        By all coordinates, shape (n_gaps + n_channels + n_speeds, n_coordinates), and by all
        parameters. The speeds are those where the tangent is the rates.

        Parameters
        ----------
        q, tangent
            All coordinates, and a direction of theirs, shape (n_coordinates,).
        """
        by_coordinate, by_parameter = self._along
        return by_coordinate(q, tangent), by_parameter(q, tangent)

    @cached_property
    def _along(self) -> tuple[Callable[..., Array], Callable[..., Array]]:
        q, symbols = self._coordinate_column, ops.column([e.symbol for e in self.parameters])
        tangent = ops.symbols("tangent", q.shape[0])
        rows = ops.stacked(self._gaps.expressions, self._free)
        moved = ops.stacked(ops.derivative(rows, q, tangent), self._free_speeds @ tangent)
        found = (ops.jacobian(moved, by) for by in (q, symbols))
        first, second = (
            ops.numeric([q, tangent], ops.substitute(item, *self._known)) for item in found
        )
        return first, second

    @cached_property
    def start_by_parameter(self) -> Array:
        """Derivatives of the start as it is written, before the loops are closed.

        Shape (n_coordinates, n_parameters). Coordinates written as expressions follow those,
        driven ones their motion at time zero, all others stay.
        """
        system, symbols, motion = self._moments
        written: dict[str, Scalar] = {
            joint.name: system.starts.get(joint.name, 0.0) for joint in symbols.joints
        }
        written |= {name: item.position for name, item in motion.items()}
        pairs = [(p, v) for p in system.parts for v in p.states()]
        given = [symbols.time, *(symbols.states[p.name][v.name] for p, v in pairs)]
        entries = [entry.symbol for entry in self.parameters]
        slopes = ops.jacobian(ops.column([*written.values()]), ops.column(entries))
        starts = [0.0, *(v.start for _, v in pairs)]
        return ops.numeric([ops.column(given), ops.column(entries)], slopes)(
            starts, [entry.value for entry in self.parameters]
        )

    def speed_slopes(self, q: Array) -> Array:
        """Return the derivatives of ``speeds`` by the rates, (n_speeds, n_coordinates)."""
        return self._speed_slopes(q)


@dataclass(frozen=True)
class _Seen:
    """Channels at rest and those linear in the rates, with expressions of the coordinates.

    ``free`` are the channels with parameters as symbols, ``free_speeds`` the slopes of the speeds,
    ``known`` these symbols and their numbers.
    """

    channels: tuple[Channel, ...]
    values: Scalar
    speeds: tuple[Channel, ...]
    speed_slopes: Scalar
    without_channels: tuple[str, ...]
    free: Scalar
    free_speeds: Scalar
    known: tuple[Scalar, Scalar]

    @classmethod
    def of(cls, system: System, tree: Tree, symbols: Symbols, kept: Collection[str]) -> _Seen:
        joints = symbols.joints
        accelerations = {j.name: ops.symbol(f"{j.name}_acceleration") for j in joints}
        q, rates = symbols.coordinate_column, symbols.rate_column
        unsteady = ops.column([accelerations[j.name] for j in joints])
        known, numbers = _given(system, symbols)
        kinematics = Kinematics(tree, symbols.coordinates, symbols.rates, accelerations)
        found = [
            Output(Channel(j.name, j.unit, j.description or j.name, "joint"), q[k])
            for k, j in enumerate(joints)
        ]
        free = [output.expression for output in found]
        speeds: list[Channel] = []
        speed_slopes, free_speeds = [], []
        moving = ops.stacked(rates, unsteady)
        still = ops.column([0.0] * moving.shape[0])
        outputs, without = _outputs(system, symbols, kinematics)
        for channel, expression in outputs:
            given = ops.substitute(expression, known, numbers)
            at_rest = ops.substitute(given, moving, still)
            if ops.depends_on(at_rest, q) or channel.name in kept:
                found.append(Output(channel, at_rest))
                free.append(ops.substitute(expression, moving, still))
            elif (
                channel.unit.endswith("/s")
                and ops.depends_on(given, rates)
                and not ops.depends_on(given, unsteady)
            ):
                speeds.append(channel)
                speed_slopes.append(ops.substitute(ops.jacobian(given, rates), moving, still))
                free_speeds.append(ops.substitute(ops.jacobian(expression, rates), moving, still))
        return cls(
            tuple(output.channel for output in found),
            ops.column([output.expression for output in found]),
            tuple(speeds),
            ops.stacked(ops.jacobian(ops.column([]), q), *speed_slopes),
            tuple(without),
            ops.column(free),
            ops.stacked(ops.jacobian(ops.column([]), q), *free_speeds),
            (known, numbers),
        )


def _outputs(
    system: System, symbols: Symbols, kinematics: Kinematics
) -> tuple[list[tuple[Channel, Scalar]], list[str]]:
    """Return the channels of all parts, and the names of those that show forces.

    Left out are these, which a motion without forces cannot have, and parts with unknowns.
    """
    found, without = [], []
    for part in system.parts:
        if part.unknowns() or part.reactions():
            continue
        try:
            outputs = outputs_of(part, symbols.situation(part, kinematics))
        except ForcesUnknownError:
            without.append(part.name)
            continue
        found += [(output.channel, ops.scalar(output.expression)) for output in outputs]
    return found, without


def _given(system: System, symbols: Symbols) -> tuple[Scalar, Scalar]:
    """Return symbols that stay as they are, and their numbers: time, parameters, states."""
    entries = system.table.entries
    pairs = [(p.name, v) for p in system.parts for v in p.states()]
    known = [symbols.time, *(e.symbol for e in entries)]
    known += [symbols.states[part][v.name] for part, v in pairs]
    numbers = [0.0, *(e.value for e in entries), *(v.start for _, v in pairs)]
    return ops.column(known), ops.column(numbers)
