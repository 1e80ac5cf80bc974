"""What the expressions of a system file are worth, in symbols and in numbers."""

from __future__ import annotations

from collections import ChainMap
from functools import cached_property
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.files.building.road_choice import RoadChoice
from vehicledyn.files.expressions.algebra import NUMBERS, SYMBOLS
from vehicledyn.files.expressions.expressions import Expression
from vehicledyn.files.expressions.parameters import ParameterEntry
from vehicledyn.files.system.checks.variables import Variables
from vehicledyn.files.system.read import SystemModel
from vehicledyn.rail.track.track import Track
from vehicledyn.rail.track.track_set import TrackChoice
from vehicledyn.symbolic.parameters import ParameterTable


class Values:
    """A file's expressions with its parameters, and the scenario's choice of further ones.

    ``table`` holds the parameters of the equations as they are entered, ``numbers`` their values
    and ``symbols`` their symbols, both by the names of the file; ``variables`` are the further
    names of expressions.
    """

    def __init__(self, model: SystemModel, choice: RoadChoice) -> None:
        self.model, self.choice = model, choice
        self.variables = Variables(model.coordinates)
        self.table = ParameterTable()
        self.numbers = model.parameters.values
        self.symbols: dict[str, Any] = {}
        for entry in model.parameters.entries:
            self.symbols[entry.name] = self._enter(entry)

    def value(self, expression: Expression, **names: Any) -> Any:
        """Return what an expression is worth, in symbols; ``names`` are further quantities."""
        return expression.value(ChainMap(names, self.symbols), SYMBOLS)

    def setting(self, item: Any) -> Any:
        """Return a setting of a part: what an expression is worth, anything else as it is."""
        return self.value(item) if isinstance(item, Expression) else item

    def number(self, expression: Expression) -> Any:
        """Return what an expression is worth with the present parameters."""
        return expression.value(self.numbers, NUMBERS)

    def at_time(self, expression: Expression, time: Any) -> Any:
        """Return what an expression of time is worth, in symbols."""
        return self.value(expression, time=time)

    @cached_property
    def track(self) -> Track:
        """Return the railway track, the scenario's before that of the file.

        Raises
        ------
        InputError
            If neither has one.
        """
        if self.choice.track is not None:
            return self.choice.track
        if isinstance(self.model.file.track, TrackChoice):
            return self.model.file.track.track(self.model.path.parent)
        raise InputError(
            f"{self.model.path}: track: missing: the system runs on rails, give it a track, or "
            "give one to the scenario"
        )

    def _enter(self, entry: ParameterEntry) -> Any:
        """Return the symbols of a parameter; what is calculated from others stays so."""
        entered = [
            self.table.add(name, number, measure.unit, entry.description)
            if expression.root.quantity is not None
            else None
            for name, expression, measure, number in entry.components
        ]
        if all(symbol is None for symbol in entered):
            return self.value(entry.expression)
        if len(entered) == 1:
            return entered[0]
        return tuple(
            self.value(expression) if symbol is None else symbol
            for symbol, (_, expression, _, _) in zip(entered, entry.components, strict=True)
        )
