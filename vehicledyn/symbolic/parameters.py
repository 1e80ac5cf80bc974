"""Parameter table: the symbols that stand for a model's parameters, with their values."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, TypeVar, cast

from vehicledyn.base.parameters import ParameterSet, field_unit
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

S = TypeVar("S", bound=ParameterSet)
_COMPONENTS = ("x", "y", "z")


@dataclass(frozen=True)
class Parameter:
    """One scalar parameter: dotted name, SI value, unit, meaning and its symbol."""

    name: str
    value: float
    unit: str
    description: str
    symbol: Scalar


@dataclass
class ParameterTable:
    """Collects parameters while a system is built; every one of them stays symbolic."""

    entries: list[Parameter] = field(default_factory=list)

    def add(self, name: str, value: float, unit: str, description: str) -> Scalar:
        """Enter one scalar and return its symbol."""
        if any(entry.name == name for entry in self.entries):
            raise ValueError(f"parameter '{name}' is declared twice")
        symbol = ops.symbol(name)
        self.entries.append(Parameter(name, float(value), unit, description, symbol))
        return symbol

    def add_set(self, prefix: str, parameters: S) -> S:
        """Enter every quantity of a set and return a copy of the set that holds the symbols.

        Nested sets are entered under ``prefix.field``, lists of them with a number behind it;
        vectors become three parameters ``prefix.field.x``, ``.y``, ``.z`` and a tuple of
        symbols; other fields are kept. A set whose quantities are numbers in the equations is
        kept as it is.
        """
        if parameters.in_equations:
            return parameters
        symbols: dict[str, Any] = {}
        for name, declared in type(parameters).model_fields.items():
            value = getattr(parameters, name)
            path = f"{prefix}.{name}" if prefix else name
            unit = field_unit(type(parameters), name)
            meaning = declared.description or name
            if isinstance(value, ParameterSet):
                symbols[name] = self.add_set(path, value)
            elif isinstance(value, list) and all(isinstance(v, ParameterSet) for v in value):
                symbols[name] = [self.add_set(f"{path}.{k}", v) for k, v in enumerate(value)]
            elif unit is None or value is None:
                symbols[name] = value
            elif isinstance(value, tuple):
                labels = _COMPONENTS if len(value) <= len(_COMPONENTS) else map(str, range(99))
                pairs = zip(labels, value, strict=False)
                symbols[name] = tuple(self.add(f"{path}.{k}", v, unit, meaning) for k, v in pairs)
            else:
                symbols[name] = self.add(path, value, unit, meaning)
        # The pydantic plugin of mypy reads model_construct as that of the bound.
        return cast("S", type(parameters).model_construct(**symbols))
