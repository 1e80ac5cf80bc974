"""Doors of packages: names offered at once, their modules loaded when a name is first used."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib import import_module
from typing import Any


def lazy_exports(package: str, homes: Mapping[str, Sequence[str]]) -> Callable[[str], Any]:
    """Return the ``__getattr__`` of a package that offers names of modules.

    Parameters
    ----------
    package
        Full name of the package, for messages.
    homes
        For the full name of each module the names it offers.

    Raises
    ------
    AttributeError
        By the function returned, for a name that no module offers; the nearest one is suggested.
    """
    home_of = {name: home for home, names in homes.items() for name in names}

    def offer(name: str) -> Any:
        if name not in home_of:
            raise AttributeError(
                f"module '{package}' has no attribute '{name}'{_hint(name, home_of)}"
            )
        return getattr(import_module(home_of[name]), name)

    return offer


def _hint(name: str, known: Iterable[str]) -> str:
    """Return a suggestion; dunder names, which Python looks for by itself, get none."""
    if name.startswith("__"):
        return ""
    from vehicledyn.base.errors import nearest_name

    guess = nearest_name(name, known)
    return f"; did you mean '{guess}'?" if guess else ""
