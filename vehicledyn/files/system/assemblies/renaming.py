"""New names for bodies, coordinates, parameters and parts in the sets of system files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from vehicledyn.files.expressions.expressions import Expression, named
from vehicledyn.files.expressions.fields import SystemSet, fact
from vehicledyn.files.system.events import EventSet
from vehicledyn.files.system.joints import JointSet

_RATE = "_rate"


@dataclass(frozen=True)
class Renaming:
    """Names that get a prefix, and bodies and coordinates that others stand for."""

    prefix: str
    bodies: Mapping[str, str]
    coordinates: Mapping[str, str]
    parameters: frozenset[str]
    switches: frozenset[str] = frozenset()

    def under(self, name: str) -> str:
        """Return a name with the prefix."""
        return f"{self.prefix}.{name}"

    def quantity(self, name: str) -> str | None:
        """Return the new name of a quantity in an expression, None if it keeps its own."""
        if name in self.coordinates:
            return self.coordinates[name]
        if name.endswith(_RATE) and name.removesuffix(_RATE) in self.coordinates:
            return self.coordinates[name.removesuffix(_RATE)] + _RATE
        whole = name.rpartition(".")[0]
        known = self.parameters | self.switches
        return self.under(name) if name in known or whole in self.parameters else None

    def expression(self, expression: Expression) -> Expression:
        """Return an expression of the new names."""
        new = {name: self.quantity(name) for name in expression.names}
        return expression.replaced({old: named(name) for old, name in new.items() if name})

    def item(self, item: Any) -> Any:
        """Return a part, several, or a value inside one, with the new names."""
        if isinstance(item, Expression):
            return self.expression(item)
        if isinstance(item, dict):
            return {key: self.item(entry) for key, entry in item.items()}
        if isinstance(item, tuple):
            return tuple(self.item(entry) for entry in item)
        if not isinstance(item, SystemSet):
            return item
        update = {name: self._field(item, name) for name in type(item).model_fields}
        if isinstance(item, JointSet) and "." in getattr(item, "name", ""):
            update["name"] = self.under(update["name"])
        if isinstance(item, EventSet):
            reset = item.reset.items()
            update["reset"] = {self.quantity(k) or k: self.expression(v) for k, v in reset}
        return item.model_copy(update=update)

    def _field(self, item: SystemSet, name: str) -> Any:
        value, what = getattr(item, name), fact(type(item), name, "names")
        if what is None or value is None:
            return self.item(value)
        known = {"body": self.bodies, "coordinate": self.coordinates}.get(str(what), {})
        return known.get(value, self.under(value))
