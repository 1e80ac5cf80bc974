"""Prescribed motions as functions of the parameters in their laws, with exact derivatives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.mechanism.inverse_report import no_motion
from vehicledyn.analyses.preparation.prescribed_motion import LawMotion, MotionRequest
from vehicledyn.files.scenario.system_models import WrittenModel
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.parameters import Parameter

if TYPE_CHECKING:
    from vehicledyn.files.building.values import Values
    from vehicledyn.files.system.read import SystemModel

Floats = NDArray[np.float64]
Tables: TypeAlias = tuple[Floats, Floats, Floats]


class GivenMotion:
    """Positions, rates and accelerations of prescribed coordinates for any parameters.

    Parameters
    ----------
    motion
        The motion; None where no coordinate is prescribed. A table depends on no parameter.
    model
        The model, whose parameters stand in laws.
    names
        All parameters of the equations, in their order.
    """

    def __init__(
        self, motion: MotionRequest | None, model: WrittenModel, names: Sequence[str]
    ) -> None:
        self._motion, self._model, self._names = motion, model, list(names)

    def at(self, times: Floats, parameters: Floats) -> Tables:
        """Return the motion, each of shape (n_times, n_coordinates)."""
        if self._motion is None:
            return no_motion(len(times))
        if not isinstance(self._motion, LawMotion):
            return self._motion.at(times)
        values = self._evaluated("values", times, parameters)
        return values[0].T, values[1].T, values[2].T

    def slopes(self, times: Floats, parameters: Floats) -> Tables:
        """Return its derivatives, each of shape (n_times, n_coordinates, n_parameters)."""
        count = 0 if self._motion is None else len(self._motion.coordinates)
        found = np.zeros((3, len(times), count, len(self._names)))
        if isinstance(self._motion, LawMotion):
            places = [self._names.index(entry.name) for entry in self._symbols]
            columns = self._evaluated("slopes", times, parameters)
            for table, column in zip(found, columns, strict=True):
                by_parameter = column.reshape(count, len(places), len(times), order="F")
                table[:, :, places] = by_parameter.transpose(2, 0, 1)
        return found[0], found[1], found[2]

    def _evaluated(self, what: str, times: Floats, parameters: Floats) -> list[Floats]:
        """Return "values" or "slopes" of positions, rates and accelerations, a time a column."""
        own = parameters[[self._names.index(entry.name) for entry in self._symbols]]
        given = times[None, :], np.repeat(own[:, None], len(times), axis=1)
        return [function(*given) for function in self._functions[what]]

    @cached_property
    def _built(self) -> Values:
        from vehicledyn.files.building.road_choice import RoadChoice
        from vehicledyn.files.building.values import Values

        return Values(cast("SystemModel", self._model), RoadChoice())

    @property
    def _symbols(self) -> list[Parameter]:
        """The parameters that may stand in laws."""
        return self._built.table.entries

    @cached_property
    def _functions(self) -> dict[str, list[Callable[..., Floats]]]:
        laws, value = cast("LawMotion", self._motion).laws.values(), self._built.value
        time, symbols = ops.symbol("time"), ops.column([entry.symbol for entry in self._symbols])
        position = ops.column([law.at(time, value) for law in laws])
        rate = ops.derivative(position, time, 1.0)
        columns = position, rate, ops.derivative(rate, time, 1.0)
        slopes = [ops.flat(ops.dense(ops.jacobian(item, symbols))) for item in columns]
        return {
            "values": [ops.numeric([time, symbols], item) for item in columns],
            "slopes": [ops.numeric([time, symbols], item) for item in slopes],
        }
