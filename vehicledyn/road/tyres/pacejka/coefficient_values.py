"""Coefficients of a tyre by name, as attributes, so that formulas read as their source does."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


class Coefficients:
    """Numbers by name: ``p.PCX1``; a product with zero is left out of the equations."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self._values = dict(values)

    def __getattr__(self, name: str) -> Any:
        """Return a coefficient.

        Raises
        ------
        AttributeError
            If there is none of the name.
        """
        try:
            return self.__dict__["_values"][name]
        except KeyError:
            raise AttributeError(name) from None

    def has(self, name: str) -> bool:
        """Return whether the coefficient is known."""
        return name in self._values

    def changed(self, **values: Any) -> Coefficients:
        """Return the coefficients with some replaced."""
        return Coefficients({**self._values, **values})


ASYMMETRIC = (
    *("PHY1", "PHY2", "PVY1", "PVY2", "PEY3", "PEX4", "RHX1", "RBY3", "RVY1", "RVY2", "RHY1"),
    *("RHY2", "QBZ4", "QDZ3", "QDZ6", "QDZ7", "QEZ4", "QHZ1", "QHZ2", "QSX1", "SSZ1"),
)
"""Coefficients by which a tyre differs from its mirror image, or from itself turned round."""

MIRRORED = tuple(name for name in ASYMMETRIC if name not in ("PEX4", "RHY1", "RHY2"))
"""Coefficients by which a tyre differs from its mirror image."""
